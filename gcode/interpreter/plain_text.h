// Lines that say something to people and that no control reads as a command.
#pragma once

#include <string_view>

namespace batten::gcode {

// Whether a line of the RS-274 family that is no block of words is one of these, comments aside:
//   fanuc.nc (a title)   the name of a program file: letters, digits, -, _ and a known suffix
//                        (not mpf or spf, whose names may be calls)
//   [ROUGHING]           in brackets as a whole, which WinCNC takes for a comment
// False for all that a control could act on: names with values, macros, statements of other
// languages.
[[nodiscard]] bool is_plain_text(std::string_view line);

// Whether the line is a title: two or more words of letters and numbers of which none is a word of
// RS-274 (X10) or begins a command of some control. At the beginning of a program only: further
// down it could be a macro's.
[[nodiscard]] bool is_title(std::string_view line);

}  // namespace batten::gcode
