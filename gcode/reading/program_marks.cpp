#include "gcode/reading/program_marks.h"

#include <algorithm>
#include <string_view>

namespace batten::gcode {
namespace {

bool is_mark(const Program& program, const Block& block) {
  if (block.opacity != ParseStatus::kProgramMark) return false;
  const std::string_view text = program.source.text(block.span);
  const std::size_t first = text.find_first_not_of(std::string_view("\0 \t\xEF\xBB\xBF", 6));
  return first != std::string_view::npos && text[first] == '%';
}

// Would a control act on it, if it read it?
bool has_words(const Block& block) {
  return block.opacity == ParseStatus::kNone ? block.word_count > 0
                                             : block.opacity != ParseStatus::kProgramMark;
}

}  // namespace

void close_behind_marks(Block& block) {
  block.opacity = ParseStatus::kProgramMark;
  block.word_count = 0;
}

void close_program_marks(Program& program, Diagnostics& found) {
  const auto begin = program.blocks.begin();
  const auto end = program.blocks.end();
  const auto mark = [&](const Block& block) { return is_mark(program, block); };
  const auto first = std::find_if(begin, end, mark);
  if (first == end || std::none_of(first, end, has_words)) {
    return;
  }
  // From inside, the text before the first mark may or may not have been run: unlike the text after
  // the last one it can change the state that the program starts in.
  if (std::any_of(begin, first, has_words)) {
    found.push_back({Severity::kWarning, "text-outside-marks", first->span,
                     "words stand before this first % line: some controls run them, others do "
                     "not; they are copied as they are"});
  }
  for (auto block = begin; block != first; ++block) {
    if (has_words(*block)) block->opacity = ParseStatus::kUnreadable;
  }
  const auto second = std::find_if(first + 1, end, mark);
  if (second == end) return;
  if (std::any_of(second, end, has_words)) {
    found.push_back({Severity::kNote, "text-outside-marks", second->span,
                     "words stand after this second % line, which ends the program; they are "
                     "copied as they are"});
  }
  std::for_each(second + 1, end, close_behind_marks);
}

// Only marks with words behind them are the first: others end what began without one.
void PercentMarkScanner::see(const Program& part) {
  for (const Block& block : part.blocks) {
    if (is_mark(part, block)) {
      ++marks_;
      if (marks_ == 2 && words_behind_first_) last_mark_ = block.line;
    } else if (has_words(block)) {
      words_before_ |= marks_ == 0;
      words_behind_first_ |= marks_ > 0;
      words_behind_second_ |= marks_ > 1;
    }
  }
}

}  // namespace batten::gcode
