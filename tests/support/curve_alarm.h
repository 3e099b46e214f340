// What a control would say about the curve blocks of a program: found in the written text alone,
// by code that shares nothing with the code that wrote it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/diagnostic.h"

namespace batten::gcode {

struct CurveAlarm {
  // kError: the control stops there. kWarning: it runs on, but not as one would expect.
  Severity severity = Severity::kError;
  std::uint32_t line = 0;  // from 1
  // The control's own number where its manual gives one ("PS1002", "P33"), else a name of ours
  // in lower case.
  std::string_view id;
  std::string message;  // found and expected, with units
};

using CurveAlarms = std::vector<CurveAlarm>;

}  // namespace batten::gcode
