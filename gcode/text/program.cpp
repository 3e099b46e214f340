#include "gcode/text/program.h"

#include <algorithm>
#include <string_view>

namespace batten::gcode {

bool is_block_number(const Program& program, const Block& block, const Word& word) {
  const auto is_before = [&](const auto& other) {
    return other.span.begin >= block.span.begin && other.span.begin < word.span.begin;
  };
  const std::string_view number = program.source.text(word.span);
  return word.letter == 'N' && number.find_first_of("+-") == std::string_view::npos &&
         std::ranges::none_of(program.words_of(block), is_before) &&
         std::ranges::none_of(program.comments_of(block), is_before);
}

}  // namespace batten::gcode
