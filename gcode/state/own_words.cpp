#include "gcode/state/own_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace batten::gcode {
namespace {

constexpr OwnEffect kKeepsAll = {.keeps_modes = true, .keeps_motion = true, .keeps_place = true};

constexpr OwnEffectRow kOwnEffects[] = {
    {"keeps state", "modes, kind of motion, feed, speed and position are after it as before",
     kKeepsAll},
    {"ends a run", "the same, of a word that acts where it stands: a clamp, a message", kKeepsAll},
    {"position unknown",
     "as before but for the position: something else moved the axes",
     {.keeps_modes = true, .keeps_motion = true}},
    {"moves",
     "the modes are as before; kind of motion, feed, speed and position are unknown",
     {.keeps_modes = true}},
    {"returns",
     "a call goes on at the block behind it, never at a label (M99 P)",
     {.returns = true},
     true},
};

}  // namespace

std::span<const OwnEffectRow> own_effects() { return kOwnEffects; }

bool may_choose_zero(const CodeRow& row) {
  return row.group == CodeGroup::kScaling || row.group == CodeGroup::kWorkOffset ||
         row.act == CodeAct::kMovesOrigin || row.act == CodeAct::kMachinePlace;
}

std::string numbered_call(const BlockWords& words) {
  const Word* program = words.find('P');
  constexpr double kGreatest = 99999999;
  const bool whole = program != nullptr && program->is_number && program->value >= 0 &&
                     program->value <= kGreatest && program->value == std::floor(program->value);
  std::string_view call;
  int calls = 0;
  const auto note = [&](std::string_view name, bool stands_here) {
    if (!stands_here) return;
    call = name;
    ++calls;
  };
  note("G65", words.has_g(650));
  note("M98", words.has_m(980) && !words.has_any("HQ"));
  note("M198", words.has_m(1980) && !words.has_any("HQ"));
  note("others", words.has_g(660) || words.has_g(661) || words.has_m(970) || words.has_m(990));
  return whole && calls == 1 && call != "others" ? fmt::format("{} P{:.0f}", call, program->value)
                                                 : std::string();
}

const OwnWord* OwnWords::find(std::string_view name) const {
  const auto found = std::ranges::find(words_, name, &OwnWord::name);
  return found == words_.end() ? nullptr : &*found;
}

const OwnWord* OwnWords::find(char letter, Code code, const BlockWords& words) const {
  const CodeRow& row = letter == 'M' ? row_of_m(code) : row_of_g(code);
  if (row.act == CodeAct::kCalls) return find(numbered_call(words));
  return find(code % 10 == 0 ? fmt::format("{}{}", letter, code / 10)
                             : fmt::format("{}{}.{}", letter, code / 10, code % 10));
}

void apply_own(const OwnEffect& effect, ControlState& state) {
  if (!effect.keeps_modes) return forget_everything(state);
  if (!effect.keeps_motion) {
    state.modal.motion = MotionMode::kUnknown;
    state.modal.feed.reset();
    state.modal.spindle_speed.reset();
    state.other_motion = {};
  }
  if (effect.keeps_place) return;
  forget_position(state);
  state.work_offset = 0;  // it may have chosen another
}

}  // namespace batten::gcode
