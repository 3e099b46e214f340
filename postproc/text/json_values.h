// Parts that every JSON report of the program has in common.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"

namespace batten::postproc {

// Keeps its fields in the order in which they were set. Who looks into one includes
// <nlohmann/json.hpp>.
using Json = nlohmann::ordered_json;

// [{"severity": "warning", "id": "", "line": 1, "column": 1, "message": ""}]
[[nodiscard]] Json diagnostics_json(const gcode::Diagnostics& diagnostics,
                                    const gcode::SourceText& source);

// Indented text with a last newline; bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string json_text(const Json& json);

}  // namespace batten::postproc
