#include "postproc/proof/common_texts.h"

#include <charconv>
#include <cmath>
#include <system_error>

#include "gcode/klartext/statement.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::postproc {
namespace {

std::optional<double> number_of(std::string_view token) {
  const auto number = gcode::read_number(token);
  return number ? std::optional(number->value) : std::nullopt;
}

// Takes CYCL DEF and the number of the part off the front; false where they do not stand there.
bool takes_cycle_part(gcode::KlartextTokens& tokens, std::string_view part) {
  return gcode::is_same_word(tokens.next(), "CYCL") && gcode::is_same_word(tokens.next(), "DEF") &&
         tokens.next() == part;
}

bool has_digit(std::string_view text) {
  return text.find_first_of("0123456789") != std::string_view::npos;
}

}  // namespace

std::optional<ToolCall> tool_call_in(std::string_view content) {
  gcode::KlartextTokens tokens(content);
  (void)tokens.next();  // TOOL
  (void)tokens.next();  // CALL
  ToolCall call;
  bool along_z = false;
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
    if (token == "Z") {
      along_z = true;
    } else if (token.starts_with('S')) {
      call.speed = number_of(token.substr(1));
      if (!call.speed) return std::nullopt;
    } else if (token.starts_with('F') && number_of(token.substr(1))) {
      continue;  // the feed is not known behind it
    } else if (!along_z && !call.tool) {
      call.tool = number_of(token);
      if (!call.tool) return std::nullopt;
    } else {
      return std::nullopt;
    }
  }
  return along_z ? std::optional(call) : std::nullopt;
}

bool is_dwell_begin(std::string_view content) {
  gcode::KlartextTokens tokens(content);
  return takes_cycle_part(tokens, "9.0");
}

std::optional<std::int32_t> dwell_time_in(std::string_view content) {
  gcode::KlartextTokens tokens(content);
  if (!takes_cycle_part(tokens, "9.1") || has_digit(tokens.next())) return std::nullopt;
  const auto seconds = number_of(tokens.next());
  if (!seconds || !tokens.next().empty()) return std::nullopt;
  const double ms = *seconds * 1000;
  constexpr double kHour = 3'600'000;
  constexpr double kRounding = 1e-6;
  if (!(ms > 0.5 && ms <= kHour) || std::abs(ms - std::round(ms)) > kRounding) return std::nullopt;
  return static_cast<std::int32_t>(std::lround(ms));
}

bool is_work_offset(int code) { return code >= 540 && code <= 590 && code % 10 == 0; }

std::optional<int> datum_in_remark(std::string_view comment) {
  constexpr std::string_view kBegin = "; G";
  if (!comment.starts_with(kBegin)) return std::nullopt;
  int code = 0;
  const char* end = comment.data() + comment.size();
  const auto read = std::from_chars(comment.data() + kBegin.size(), end, code);
  const std::string_view rest(read.ptr, static_cast<std::size_t>(end - read.ptr));
  const bool offset = read.ec == std::errc{} && is_work_offset(code * 10);
  return offset && rest == ": its datum is active" ? std::optional(code) : std::nullopt;
}

std::string capitals_of_comment(std::string_view comment) {
  constexpr std::string_view kAround = "(); \t";
  const std::size_t begin = comment.find_first_not_of(kAround);
  if (begin == std::string_view::npos) return {};
  const std::size_t end = comment.find_last_not_of(kAround) + 1;
  std::string text;
  for (const char c : comment.substr(begin, end - begin)) text.push_back(gcode::upper(c));
  return text;
}

bool is_blank_form(std::string_view capitals) { return capitals.starts_with("BLK FORM "); }

}  // namespace batten::postproc
