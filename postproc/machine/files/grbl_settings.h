// The settings of a grbl control, as it prints them when asked for `$$`.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/machine/machine.h"

namespace batten::postproc {

// `base` with what a dump sets: $11, $12, and $110 to $112 and $120 to $122 for X Y Z (a dump of
// grblHAL goes on for A B C). All other settings, answers of the control and lines of comment are
// passed over; a setting that is there twice counts as it is last.
//
// Adds a sentence with `file` and place to `problems` for everything that is wrong, and then
// returns nothing: a line that is none of these, a value that is no number or too small, a
// setting that is missing.
[[nodiscard]] std::optional<Machine> with_grbl_settings(const Machine& base, std::string_view dump,
                                                        const std::string& file,
                                                        std::vector<std::string>& problems);

}  // namespace batten::postproc
