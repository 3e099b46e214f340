#include "postproc/text/json_values.h"

#include <nlohmann/json.hpp>

namespace batten::postproc {

Json diagnostics_json(const gcode::Diagnostics& diagnostics, const gcode::SourceText& source) {
  return json_list(diagnostics, [&](const gcode::Diagnostic& diagnostic) -> Json {
    const gcode::SourcePlace place = source.place_of(diagnostic.where.begin);
    return {{"severity", name_of(diagnostic.severity)},
            {"id", diagnostic.id},
            {"line", place.line},
            {"column", place.column},
            {"message", diagnostic.message}};
  });
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace batten::postproc
