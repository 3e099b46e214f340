// What a control would say about the curve blocks of a program: found in the written text alone,
// by code that shares nothing with the code that wrote it.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace batten::gcode {

struct CurveAlarm {
  std::uint32_t line = 0;  // from 1
  // The control's own number where its manual gives one ("PS1002", "P33"), else a name of ours
  // in lower case.
  std::string_view id;
};

using CurveAlarms = std::vector<CurveAlarm>;

}  // namespace batten::gcode
