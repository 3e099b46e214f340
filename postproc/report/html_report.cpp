#include "postproc/report/html_report.h"

#include <string_view>
#include <utility>

#include "postproc/report/page_data.h"
#include "postproc/report/page_files.h"

namespace batten::postproc {
namespace {

// Inside <script> only `<` could end the element or begin a comment; JSON may say it as \u003c.
std::string script_safe(std::string_view json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string html_safe(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '&':
        safe += "&amp;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

// The template with each @NAME@ of `parts` replaced once, in the order in which they stand.
std::string filled(std::string_view page,
                   std::initializer_list<std::pair<std::string_view, std::string_view>> parts) {
  std::string text;
  for (const auto& [mark, part] : parts) {
    const std::size_t place = page.find(mark);
    text += page.substr(0, place);
    text += part;
    page.remove_prefix(place + mark.size());
  }
  text += page;
  return text;
}

}  // namespace

std::string html_report(const SmoothReport& report, const HtmlReportOptions& options) {
  const Json data = page_data(report, options);
  const std::string json = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  return filled(page_template(), {{"@TITLE@", html_safe(report.source.name())},
                                  {"@STYLE@", page_style()},
                                  {"@DATA@", script_safe(json)},
                                  {"@SCRIPT@", page_script()}});
}

}  // namespace batten::postproc
