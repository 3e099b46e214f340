#include "gcode/opaque_blocks.h"

#include "gcode/program_flow.h"
#include "gcode/reason.h"

namespace batten::gcode {
namespace {

// Parameter assignments of LinuxCNC and macro B change no modal state, but high numbers are
// windows into the control: FANUC's tool offsets begin at #2000, work offsets lie above #5000.
bool assigns_only_variables(std::string_view text) {
  constexpr int kFirstSystemVariable = 2000;
  for (std::size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1)) {
    std::size_t digit = at + 1;
    int number = 0;
    while (digit < text.size() && text[digit] >= '0' && text[digit] <= '9' &&
           number < kFirstSystemVariable) {
      number = number * 10 + (text[digit] - '0');
      ++digit;
    }
    const bool named = digit < text.size() && text[digit] == '<';
    if (number >= kFirstSystemVariable || (digit == at + 1 && !named)) {
      return false;
    }
  }
  return true;
}

void apply_flow(FlowEffect effect, ControlState& state) {
  switch (effect) {
    case FlowEffect::kNothing:
      return;
    case FlowEffect::kCall:
      return forget_what_calls_change(state);
    case FlowEffect::kProgramNumber:
    case FlowEffect::kEverything:
      return forget_everything(state);
  }
}

}  // namespace

std::string_view opacity_reason(Opacity opacity) {
  switch (opacity) {
    case Opacity::kExpression:
      return reason::kExpression;
    case Opacity::kCornerWord:
      return reason::kCornerWord;
    case Opacity::kAssignment:
      return reason::kAssignment;
    case Opacity::kFlow:
      return reason::kProgramFlow;
    case Opacity::kForeign:
    case Opacity::kContinued:
    case Opacity::kNamedWords:
      return reason::kForeignWords;
    case Opacity::kProgramMark:
      return reason::kProgramMark;
    default:
      return reason::kNotUnderstood;
  }
}

void apply_opaque(Opacity opacity, std::string_view text, ControlState& state) {
  switch (opacity) {
    case Opacity::kProgramMark:  // and text that no control reads
      return;
    case Opacity::kAssignment:
      if (!assigns_only_variables(text)) {
        forget_position(state);
        state.work_offset = 0;
      }
      return;
    case Opacity::kFlow:
      return apply_flow(flow_effect(text), state);
    default:
      forget_everything(state);
  }
}

}  // namespace batten::gcode
