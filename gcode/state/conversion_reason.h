// Why a program cannot be converted to another language, where the user may say that it can: ids
// for --allow beside those of gcode/state/reason.h, explained with them.
#pragma once

#include <string_view>

namespace batten::gcode::reason {

inline constexpr std::string_view kWorkOffset = "work-offset";  // G54, where there is none
inline constexpr std::string_view kToolLength = "tool-length";  // G49, where lengths always count
inline constexpr std::string_view kBlankForm = "blank-form";    // BLK FORM, where there is none

}  // namespace batten::gcode::reason
