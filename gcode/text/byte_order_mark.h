// The bytes that some editors put before the first line of UTF-8.
#pragma once

#include <string_view>

namespace batten::gcode {

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace batten::gcode
