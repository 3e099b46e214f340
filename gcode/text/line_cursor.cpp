#include "gcode/text/line_cursor.h"

#include <algorithm>

#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

constexpr std::string_view kBlanks = " \t\r";

// Does more than one of the lines that CRs end say anything?
bool has_several_lines(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return false;
  const std::size_t ended = text.find('\r', first);
  return ended != std::string_view::npos &&
         text.find_first_not_of(kBlanks, ended) != std::string_view::npos;
}

}  // namespace

std::uint32_t begin_of_content(std::string_view text, const LineBounds& line) {
  std::size_t begin = line.begin;
  if (begin == 0 && text.starts_with(kByteOrderMark)) begin = kByteOrderMark.size();
  begin = after_blanks(text.substr(0, line.text_end), begin);
  return std::min(static_cast<std::uint32_t>(begin), line.text_end);
}

bool JoinedLines::holds(const LineBounds& line) {
  const bool ends_so = line.end > line.text_end && text_[line.end - 1] == '\r';
  if (!ends_so && !follows_lone_return(text_, line.begin)) return false;
  if (line.begin < begin_ || line.begin >= end_) {
    const std::size_t before =
        line.begin == 0 ? std::string_view::npos : text_.rfind('\n', line.begin - 1);
    begin_ = before == std::string_view::npos ? 0 : before + 1;
    const std::size_t feed = std::min(text_.find('\n', line.begin), text_.size());
    joined_ = has_several_lines(text_.substr(begin_, feed - begin_));
    end_ = feed + 1;
  }
  return joined_ &&
         text_.substr(line.begin, line.text_end - line.begin).find_first_not_of(kBlanks) !=
             std::string_view::npos;
}

}  // namespace batten::gcode
