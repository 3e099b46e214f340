#include "postproc/text/json_values.h"

#include <nlohmann/json.hpp>
#include <string_view>

namespace batten::postproc {

Json diagnostics_json(const gcode::Diagnostics& diagnostics, const gcode::SourceText& source) {
  Json list = Json::array();
  for (const gcode::Diagnostic& diagnostic : diagnostics) {
    const gcode::SourcePlace place = source.place_of(diagnostic.where.begin);
    list.push_back({{"severity", name_of(diagnostic.severity)},
                    {"id", diagnostic.id},
                    {"line", place.line},
                    {"column", place.column},
                    {"message", diagnostic.message}});
  }
  return list;
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace batten::postproc
