// Files that are no programs of any control.
#pragma once

#include <string_view>

namespace batten::gcode {

// What the text is, for people ("a program for computers (ELF)"), when it is certainly no program of
// a control; empty otherwise. Known by: the first bytes of common kinds of files; text of 16 bits
// per character; control characters that no program has (NUL as on tapes, the characters 17 to 20 of
// tape readers and 26 aside), more than one in a hundred; NULs only; or three lines or more that only
// ShopBot's language or that of plotters has, and none that begins with G or N and a digit. Of long texts
// the first 64 KiB are looked at.
[[nodiscard]] std::string_view foreign_kind_of(std::string_view text);

}  // namespace batten::gcode
