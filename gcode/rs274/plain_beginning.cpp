#include "gcode/rs274/plain_beginning.h"

#include <string_view>

#include "gcode/text/byte_order_mark.h"
#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"

namespace batten::gcode {
namespace {

// The line without the blanks before it.
SourceSpan without_blanks(std::string_view text, std::uint32_t begin, std::uint32_t end) {
  if (begin == 0 && text.starts_with(kByteOrderMark)) {
    begin = static_cast<std::uint32_t>(kByteOrderMark.size());
  }
  while (begin < end && is_blank(text[begin])) ++begin;
  return {begin, end};
}

std::string_view without_digits(std::string_view line) {
  while (!line.empty() && (is_digit(line.front()) || is_blank(line.front()))) line.remove_prefix(1);
  return line;
}

bool says_nothing(std::string_view line) {
  if (line.empty() || line.front() == '%' || line.front() == '(' || line.front() == ';') {
    return true;
  }
  const bool of_program = upper(line.front()) == 'O' && line.size() > 1 && is_digit(line[1]);
  if (!of_program) return false;
  const std::string_view rest = without_digits(line.substr(1));
  return rest.empty() || rest.front() == '(';
}

bool begins_with_g(std::string_view line) {
  if (upper(line.front()) == 'N') line = without_digits(line.substr(1));
  return line.size() > 1 && upper(line[0]) == 'G' && is_digit(line[1]);
}

}  // namespace

std::optional<SourceSpan> plain_beginning(const SourceText& source) {
  const std::string_view text = source.text();
  LineCursor lines(text);
  while (const auto line = lines.next()) {
    const SourceSpan span = without_blanks(text, line->begin, line->text_end);
    const std::string_view said = source.text(span);
    if (says_nothing(said)) continue;
    return begins_with_g(said) ? std::optional(span) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace batten::gcode
