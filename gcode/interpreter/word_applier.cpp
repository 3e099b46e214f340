#include "gcode/interpreter/word_applier.h"

#include "gcode/state/reason.h"

namespace batten::gcode {
namespace {

// M100 and above are the user's or the builder's: LinuxCNC runs a program of that name, others a
// macro or the PLC. Any of them may move the axes, but sees no modal state of ours.
bool is_user_function(Code code) {
  constexpr Code kFirst = 1000;
  return code >= kFirst;
}

}  // namespace

StateEffect WordApplier::apply() {
  for (const Code code : words_.g_codes()) {
    apply_g(code);
  }
  if (effect_.unknown_code >= 0) {
    forget_everything(state_);
  }
  apply_feed();
  apply_spindle_speed();
  apply_tool_words();
  for (const Code code : words_.m_codes()) {
    apply_m(code);
  }
  if (words_.has('E') && !effect_.takes_parameters) {
    block(reason::kExtruder);
  }
  if (words_.has_any("ABCUVW") && !effect_.takes_axes) {
    block(reason::kOtherAxis);
  }
  return effect_;
}

void WordApplier::apply_g(Code code) {
  switch (group_of_g(code)) {
    case CodeGroup::kUnknown:
      effect_.unknown_code = code;
      effect_.understood = false;
      return acts(reason::kNotUnderstood);
    case CodeGroup::kNone:
      return apply_one_block_word(code);
    case CodeGroup::kAxisUser:
      return apply_axis_user(code);
    case CodeGroup::kMotion:
      return apply_motion_word(code);
    case CodeGroup::kCycleEnd:
      return apply_cycle_end();
    case CodeGroup::kPlane:
      return set(CodeGroup::kPlane, modal().plane,
                 code == 170   ? Plane::kXY
                 : code == 180 ? Plane::kZX
                               : Plane::kYZ);
    case CodeGroup::kDistance:
      return set(CodeGroup::kDistance, modal().distance,
                 code == 900 ? DistanceMode::kAbsolute : DistanceMode::kIncremental);
    case CodeGroup::kArcDistance:
      return set(CodeGroup::kArcDistance, modal().arc_distance,
                 code == 901 ? DistanceMode::kAbsolute : DistanceMode::kIncremental);
    case CodeGroup::kFeedMode:
      return apply_feed_mode(code == 930   ? FeedMode::kInverseTime
                             : code == 940 ? FeedMode::kPerMinute
                                           : FeedMode::kPerRevolution);
    case CodeGroup::kUnits:
      return apply_units(code);
    case CodeGroup::kCutter:
      return apply_cutter(code);
    case CodeGroup::kToolLength:
      return apply_tool_length(code);
    case CodeGroup::kCycleReturn:
      return apply_cycle_return(code);
    case CodeGroup::kWorkOffset:
      return apply_work_offset(code);
    case CodeGroup::kPath:
      return apply_path_mode(code);
    case CodeGroup::kSpindleMode:
      effect_.takes_parameters = true;  // G96 D.. S..
      return set(CodeGroup::kSpindleMode, modal().constant_surface_speed,
                 code == 960 ? TriState::kOn : TriState::kOff, reason::kSpindle);
    case CodeGroup::kDiameter:
      return apply_diameter(code);
    case CodeGroup::kScaling:
      return apply_scaling(code);
    case CodeGroup::kRotation:
      return apply_rotation(code);
    case CodeGroup::kMirror:
      effect_.takes_axes = true;
      return set_frame(CodeGroup::kMirror, modal().mirror,
                       code == 511 ? TriState::kOn : TriState::kOff, reason::kMirror);
    case CodeGroup::kPolar:
      return set_frame(CodeGroup::kPolar, modal().polar,
                       code == 160 || code == 121 || code == 1120 ? TriState::kOn : TriState::kOff,
                       reason::kPolar);
    case CodeGroup::kCylindrical:
      return apply_cylindrical();
    case CodeGroup::kSmoothing:
      return apply_smoothing(code);
    case CodeGroup::kModalMacro:
      return apply_modal_macro(code);
  }
}

void WordApplier::apply_feed() {
  const Word* f = words_.find('F');
  if (f == nullptr) {
    return;
  }
  const std::optional<double> before = modal().feed;
  // A run has one way of writing feeds.
  if (before && modal().feed_without_point != f->without_point) {
    block(reason::kStateChange);
  }
  modal().feed = feed_of(*f);
  modal().feed_without_point = f->without_point;
  effect_.feed_changed = before != modal().feed || !modal().feed;
}

std::optional<double> WordApplier::feed_of(const Word& f) const {
  const ModalState& now = state_.modal;
  const bool known = f.is_number && f.value > 0 && now.feed_mode != FeedMode::kUnknown &&
                     !words_.has_g(40) && !words_.has_g(920);
  if (!known) {
    return std::nullopt;  // also: F of a dwell or a thread is no feed
  }
  const bool inches = now.units == Units::kInch && now.feed_mode != FeedMode::kInverseTime;
  return inches ? f.value * kMillimetresPerInch : f.value;
}

void WordApplier::apply_spindle_speed() {
  const Word* s = words_.find('S');
  if (s == nullptr) {
    return;
  }
  // S of a dwell or of a speed limit is not the speed.
  const bool is_speed =
      s->is_number && !words_.has_g(40) && !words_.has_g(920) && !words_.has_g(500);
  const std::optional<double> speed = is_speed ? std::optional(s->value) : std::nullopt;
  if (!speed || modal().spindle_speed != speed) {
    block(reason::kSpindle);
  }
  modal().spindle_speed = speed;
}

// T changes the tool and its offsets at once on lathes; H and D may name other offsets.
void WordApplier::apply_tool_words() {
  if (words_.has('T') || (words_.has('H') && !effect_.takes_parameters)) {
    forget_position(state_);
  }
  if (words_.has_any("THD") && !effect_.takes_parameters) {
    block(reason::kToolChange);
  }
  if (words_.has('T')) {
    block(reason::kToolChange);
  }
}

void WordApplier::apply_m(Code code) {
  switch (code / 10) {
    case 0:
    case 1:
    case 2:
    case 30:
      return acts(reason::kProgramEnd);
    case 60:  // pallet change
      acts(reason::kProgramEnd);
      return forget_position(state_);
    case 3:
    case 4:
    case 5:
    case 19:
      return acts(reason::kSpindle);
    case 7:
    case 8:
    case 9:
      return acts(reason::kCoolant);
    case 6:
    case 61:
      // The axes may go to a place for it, and tool offsets may change.
      acts(reason::kToolChange);
      return forget_position(state_);
    case 21:
    case 22:
      // Mirror X or Y on some controls, something of the builder's on others.
      modal().mirror = TriState::kUnknown;
      return acts(reason::kMiscFunction);
    case 23:
      modal().mirror = TriState::kOff;
      return acts(reason::kMiscFunction);
    case 128:
      modal().tool_center_point = TriState::kOn;
      forget_position(state_);
      return acts(reason::kMiscFunction);
    case 129:
      modal().tool_center_point = TriState::kOff;
      forget_position(state_);
      return acts(reason::kMiscFunction);
    case 97:
    case 98:
    case 99:
    case 198:
      return acts(reason::kSubprogram);
    default:
      if (is_user_function(code)) forget_position(state_);
      return acts(reason::kMiscFunction);
  }
}

StateEffect apply_words(const BlockWords& words, ControlState& state) {
  return WordApplier(words, state).apply();
}

void apply_late_words(const BlockWords& words, ControlState& state) {
  for (const Code code : words.m_codes()) {
    switch (code / 10) {
      case 2:
      case 30:  // what follows is no part of this program, or one of its subprograms
      case 72:  // LinuxCNC: back to a saved state
      case 99:
        forget_everything(state);
        return;
      case 97:
      case 98:
      case 198:
        forget_what_calls_change(state);
        break;
      case 6:
      case 60:
      case 61:  // before or after the motion of its block: controls differ
        forget_position(state);
        break;
      default:
        if (is_user_function(code)) forget_position(state);
        break;
    }
  }
  if (words.has('T')) {
    forget_position(state);
  }
  if (words.has_g(650)) {
    forget_what_calls_change(state);
  }
  if (words.has_g(660) || words.has_g(661)) {
    forget_everything(state);
    state.modal.modal_macro = TriState::kOn;
  }
}

}  // namespace batten::gcode
