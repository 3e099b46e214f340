// Variables that a Siemens program declares for itself: DEF REAL A, B = 5, C[3]. To set one changes
// nothing but what words in which it stands will say.
#pragma once

#include <string>
#include <string_view>
#include <unordered_set>

namespace batten::gcode {

using SiemensVariables = std::unordered_set<std::string>;  // in upper case

// `declaration` is what stands behind DEF: the type, then the names with their first values.
void add_declared_names(std::string_view declaration, SiemensVariables& variables);

}  // namespace batten::gcode
