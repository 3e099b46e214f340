#include "gcode/writer/block_numbers.h"

#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"

namespace batten::postproc {
namespace {

// Greater numbers are not counted on.
constexpr double kGreatestNumber = 1e9;

std::optional<std::uint32_t> number_of(const gcode::Program& program, const gcode::Block& block) {
  for (const gcode::Word& word : program.words_of(block)) {
    if (word.letter == 'N' && word.is_number && word.value < kGreatestNumber) {
      return static_cast<std::uint32_t>(word.value);
    }
  }
  return {};
}

bool takes_number(std::string_view line) { return !line.empty() && !gcode::is_blank(line.front()); }

std::string_view without_number(std::string_view line) {
  std::size_t at = 0;
  while (at < line.size() && gcode::is_digit(line[at])) ++at;
  if (at == 0) return line;
  while (at < line.size() && gcode::is_blank(line[at])) ++at;
  return line.substr(at);
}

}  // namespace

LineNumberRange number_room(const gcode::Program& program, std::uint32_t first_block,
                            std::uint32_t last_block) {
  LineNumberRange room;
  if (program.language != gcode::Language::kKlartext) return room;
  for (std::uint32_t i = first_block; i <= last_block && !room.first; ++i) {
    room.first = number_of(program, program.blocks[i]);
  }
  if (!room.first) return room;
  for (std::size_t i = last_block + 1; i < program.blocks.size(); ++i) {
    const auto next = number_of(program, program.blocks[i]);
    if (!next) continue;
    room.blocks = *next > *room.first ? *next - *room.first : 0;
    break;
  }
  return room;
}

std::size_t numbered_lines(std::string_view text) {
  std::size_t count = 0;
  gcode::LineCursor lines(text);
  while (const auto line = lines.next()) {
    if (takes_number(text.substr(line->begin, line->text_end - line->begin))) ++count;
  }
  return count;
}

std::string with_numbers(std::string_view text, std::uint32_t first) {
  std::string numbered;
  numbered.reserve(text.size() + text.size() / 4);
  gcode::LineCursor lines(text);
  while (const auto line = lines.next()) {
    std::string_view whole = text.substr(line->begin, line->end - line->begin);
    if (takes_number(text.substr(line->begin, line->text_end - line->begin))) {
      numbered += std::to_string(first++) + ' ';
      whole = without_number(whole);
    }
    numbered += whole;
  }
  return numbered;
}

}  // namespace batten::postproc
