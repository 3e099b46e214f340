#include "postproc/text/json_values.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "postproc/text/explain.h"

namespace batten::postproc {

Json as_report(std::string_view kind, Json fields) {
  Json json = {{"schema", kReportSchema}, {"kind", kind}, {"batten", BATTEN_VERSION}};
  for (auto& [name, value] : fields.items()) json[name] = std::move(value);
  return json;
}

// Text to text: a report may be large, and its end is known last.
std::string ended_report(std::string text, int exit_code,
                         const std::vector<std::string>& messages) {
  constexpr std::string_view kBegin = "{\n";
  constexpr std::string_view kEnd = "\n}\n";
  const std::string end = json_text({{"exit_code", exit_code}, {"messages", messages}});
  text.resize(text.size() - kEnd.size());
  return text + ",\n" + end.substr(kBegin.size());
}

Json diagnostics_json(const gcode::Diagnostics& diagnostics, const gcode::SourceText& source) {
  return json_list(diagnostics, [&](const gcode::Diagnostic& diagnostic) -> Json {
    const gcode::SourcePlace place = source.place_of(diagnostic.where.begin);
    return {{"severity", name_of(diagnostic.severity)},
            {"id", diagnostic.id},
            {"line", place.line},
            {"column", place.column},
            {"message", diagnostic.message},
            {"advice", advice_on(diagnostic.id)}};
  });
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace batten::postproc
