// Lines that controls read in two ways. A CR that no LF follows ends a line for grbl and is left
// out by LinuxCNC, which then reads the words on both sides of it as one block.
#pragma once

#include <cstddef>
#include <string_view>

#include "gcode/text/line_cursor.h"

namespace batten::gcode {

// What people are told of such a line.
inline constexpr std::string_view kJoinedLine =
    "a CR without LF between words, which ends a line for some controls and is left out by others; "
    "expected LF or CRLF behind every line: convert the line ends";

// LinuxCNC drops what stands behind a NUL in its line, grbl the NUL alone.
inline constexpr std::string_view kNulInLine =
    "a NUL beside words, where some controls end the line and which others leave out; expected "
    "none: take it out";

[[nodiscard]] constexpr bool has_nul(std::string_view line) {
  return line.find('\0') != std::string_view::npos;
}

class JoinedLines {
 public:
  explicit JoinedLines(std::string_view text) : text_(text) {}

  // Is there anything but blanks in this line and in another one between the same two LFs? Lines
  // are asked in their order; linear in the text as a whole.
  [[nodiscard]] bool holds(const LineBounds& line);

 private:
  std::string_view text_;
  std::size_t begin_ = 0;  // of the text between two LFs that was looked at last
  std::size_t end_ = 0;
  bool joined_ = false;
};

// False: nothing joins the line that begins there to what stands before it.
[[nodiscard]] constexpr bool follows_lone_return(std::string_view text, std::size_t begin) {
  return begin > 0 && text[begin - 1] == '\r';
}

}  // namespace batten::gcode
