// When controls refuse an arc, as functions of its printed numbers. A family's row names one. The
// least radius is a value of every target, a user's profile too: arc_refusal asks it beside the
// rule.
#pragma once

#include <string_view>

#include "gcode/control/target_table.h"

namespace batten::gcode {

// Why the target is not given the printed arc, empty where it is: below its least radius, or
// refused by its own rule, or said by numbers that nobody writes.
[[nodiscard]] std::string_view arc_refusal(const Dialect& target, const geometry::Arc& printed,
                                           Units units);

// The control's complaint about the printed arc, empty when it takes it.
using ArcRule = std::string_view (*)(const geometry::Arc& printed, Units units,
                                     const TargetTable& table);

// grbl 1.1 and those that kept its check: error 33 in 32-bit numbers, read from the printed digits
// as grbl reads them, and no angle that is noise there.
[[nodiscard]] std::string_view grbl_arc_rule(const geometry::Arc& printed, Units units,
                                             const TargetTable& table);

// TinyG and g2core in either reading of their check: radii that differ by 0.1 % are refused.
[[nodiscard]] std::string_view tinyg_arc_rule(const geometry::Arc& printed, Units units,
                                              const TargetTable& table);

// Firmware without a check of radii (Marlin, Klipper, Smoothieware, RepRapFirmware): it turns about
// the centre by the angle to the end and takes the last chord to the end itself. The centre must
// not print as the start, and the arc must be long enough to be run at all.
[[nodiscard]] std::string_view unchecked_arc_rule(const geometry::Arc& printed, Units units,
                                                  const TargetTable& table);

// Where the control's own check is not known: the radii agree as well as the printed digits can
// say, so that no control of these digits can ask for more, and the sweep is no matter of rounding.
[[nodiscard]] std::string_view strictest_arc_rule(const geometry::Arc& printed, Units units,
                                                  const TargetTable& table);

}  // namespace batten::gcode
