// Walks over the lines of a text. A line ends after LF, or after a CR that no LF follows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace batten::gcode {

struct LineBounds {
  std::uint32_t begin = 0;
  std::uint32_t text_end = 0;  // without the line end
  std::uint32_t end = 0;       // after the line end: the next line's begin
};

// Linear in the text as a whole, whatever its line ends are.
class LineCursor {
 public:
  // `from`: the begin of a line.
  explicit LineCursor(std::string_view text, std::size_t from = 0) : text_(text), at_(from) {}

  // Goes on at the begin of a line, after the last one.
  void go_to(std::size_t at) { at_ = at; }

  // The next line; nothing after the last one. An empty text has no line, and a line end at
  // the end of the text starts no further line.
  [[nodiscard]] std::optional<LineBounds> next() {
    if (at_ >= text_.size()) return std::nullopt;
    const std::size_t feed = find_from(at_, '\n', next_feed_);
    const std::size_t carriage = find_from(at_, '\r', next_return_);
    std::size_t text_end = text_.size();
    std::size_t end = text_.size();
    if (carriage < feed) {
      text_end = carriage;
      const bool feed_follows = carriage + 1 == feed && feed < text_.size();
      end = feed_follows ? feed + 1 : carriage + 1;
    } else if (feed < text_.size()) {
      text_end = feed;
      end = feed + 1;
    }
    const LineBounds line{static_cast<std::uint32_t>(at_), static_cast<std::uint32_t>(text_end),
                          static_cast<std::uint32_t>(end)};
    at_ = end;
    return line;
  }

 private:
  // The position of the next `c` at or after `from`. `known` keeps it from call to call: a text
  // with one kind of line end is not searched for the other again for every line.
  std::size_t find_from(std::size_t from, char c, std::size_t& known) const {
    if (known < from || known == kNotSearched) {
      const std::size_t found = text_.find(c, from);
      known = found == std::string_view::npos ? text_.size() : found;
    }
    return known;
  }

  static constexpr std::size_t kNotSearched = std::string_view::npos;
  std::string_view text_;
  std::size_t at_;
  std::size_t next_feed_ = kNotSearched;
  std::size_t next_return_ = kNotSearched;
};

// Where a line begins, without the bytes that some editors put before the first one, and blanks.
[[nodiscard]] std::uint32_t begin_of_content(std::string_view text, const LineBounds& line);

// Lines that controls read differently. A CR that no LF follows ends a line for grbl and is left
// out by LinuxCNC, which then reads the words on both sides of it as one block.
inline constexpr std::string_view kJoinedLine =
    "a CR without LF between words, which ends a line for some controls and is left out by others; "
    "expected LF or CRLF after every line: convert the line ends";

// LinuxCNC drops what is after a NUL in its line, grbl the NUL alone.
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

// False: nothing joins the line that begins there to what is before it.
[[nodiscard]] constexpr bool follows_lone_return(std::string_view text, std::size_t begin) {
  return begin > 0 && text[begin - 1] == '\r';
}

// How a new line ends: as the line of the source beside it does; never in a CR alone,
// which some controls leave out.
[[nodiscard]] constexpr std::string_view written_line_end(std::string_view of_source) {
  return of_source.starts_with('\r') ? "\r\n" : "\n";
}

}  // namespace batten::gcode
