#include "gcode/interpreter/opaque_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "gcode/interpreter/program_flow.h"
#include "gcode/state/reason.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

// Parameter assignments of LinuxCNC and macro B change no modal state, but high numbers are
// windows into the control: FANUC's tool offsets begin at #2000, work offsets lie above #5000.
bool assigns_only_variables(std::string_view text) {
  constexpr int kFirstSystemVariable = 2000;
  for (std::size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1)) {
    int number = -1;
    std::size_t digit = at + 1;
    for (; digit < text.size() && (is_digit(text[digit]) || is_blank(text[digit])); ++digit) {
      if (is_blank(text[digit])) continue;  // they mean nothing within a number
      number = std::max(number, 0) * 10 + (text[digit] - '0');
      if (number >= kFirstSystemVariable) return false;
    }
    const bool named = digit < text.size() && text[digit] == '<';
    if (number < 0 && !named) return false;
  }
  return true;
}

void apply_assignment(std::string_view text, ControlState& state) {
  if (assigns_only_variables(text)) return;
  forget_position(state);
  state.work_offset = 0;
}

void apply_flow(std::string_view text, ControlState& state) {
  switch (flow_effect(text)) {
    case FlowEffect::kNothing:
      return;
    case FlowEffect::kAssignment:
      return apply_assignment(text, state);
    case FlowEffect::kCall:
      return forget_what_calls_change(state);
    case FlowEffect::kProgramNumber:
    case FlowEffect::kEverything:
      return forget_everything(state);
  }
}

}  // namespace

std::string_view opacity_reason(ParseStatus opacity) {
  switch (opacity) {
    case ParseStatus::kExpression:
      return reason::kExpression;
    case ParseStatus::kCornerWord:
      return reason::kCornerWord;
    case ParseStatus::kAssignment:
      return reason::kAssignment;
    case ParseStatus::kFlow:
      return reason::kProgramFlow;
    case ParseStatus::kForeign:
    case ParseStatus::kContinued:
    case ParseStatus::kNamedWords:
      return reason::kForeignWords;
    case ParseStatus::kProgramMark:
      return reason::kProgramMark;
    default:
      return reason::kNotUnderstood;
  }
}

void apply_opaque(ParseStatus opacity, std::string_view text, ControlState& state) {
  switch (opacity) {
    case ParseStatus::kProgramMark:  // and text that no control reads
      return;
    case ParseStatus::kAssignment:
      return apply_assignment(text, state);
    case ParseStatus::kFlow:
      return apply_flow(text, state);
    default:
      forget_everything(state);
  }
}

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
