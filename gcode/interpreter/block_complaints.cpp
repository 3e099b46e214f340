#include "gcode/interpreter/block_complaints.h"

#include <fmt/format.h>

#include <utility>

namespace batten::gcode {

void BlockComplaints::begin_block(std::uint32_t block) {
  block_ = block;
  block_told_ = false;
}

void BlockComplaints::tell_words(const BlockWords& words) {
  const auto text = [this](const Word* word) { return program_.source.text(word->span); };
  switch (words.problem()) {
    case BlockWords::Problem::kNone:
      return;
    case BlockWords::Problem::kSameGroupTwice:
      return tell("two-words-of-one-group", words.second()->span,
                  fmt::format("{} and {} in one block; expected one word of their group",
                              text(words.first()), text(words.second())));
    case BlockWords::Problem::kLetterTwice:
      return tell("word-repeated", words.second()->span,
                  fmt::format("{} and {} in one block; expected one {} word", text(words.first()),
                              text(words.second()), words.first()->letter));
    case BlockWords::Problem::kBadCode:
      if (!words.all_numbers()) return;
      return tell("bad-code", words.first()->span,
                  fmt::format("{} is no code; expected a G or M number that a block can hold",
                              text(words.first())));
  }
}

void BlockComplaints::tell_unknown_code(Code code) {
  if (!told_.is_new(code)) return;
  tell("unknown-g-code",
       fmt::format("G{} is not known and may change anything; what follows is left alone until "
                   "the program has set every mode again",
                   code % 10 == 0 ? fmt::format("{}", code / 10)
                                  : fmt::format("{}.{}", code / 10, code % 10)));
}

void BlockComplaints::tell(std::string_view id, std::string message) {
  tell(id, program_.blocks[block_].span, std::move(message));
}

void BlockComplaints::tell(std::string_view id, SourceSpan where, std::string message) {
  if (std::exchange(block_told_, true)) return;
  if (told_.counts(id, where)) {
    found_.push_back({Severity::kWarning, id, where, std::move(message)});
  }
}

}  // namespace batten::gcode
