#include "gcode/interpreter/word_applier.h"

#include "gcode/state/modal_state.h"
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

// Words that move the origin, bend the coordinates, or act in their own block only.

void WordApplier::apply_one_block_word(Code code) {
  switch (code) {
    case 40:
      // G4: X and U are seconds on FANUC, F and S seconds or turns on Sinumerik; LinuxCNC
      // would move with X.
      acts(reason::kDwell);
      effect_.takes_axes = true;
      forget_named_axes(state_, words_);
      return;
    case 90:
      // Exact stop; on Fagor an arc that starts tangentially.
      effect_.understood = false;
      return block(reason::kExactStop);
    case 530:
      // Machine coordinates: where that is in the program's is not known. The motion mode of
      // the block still becomes modal.
      acts(reason::kCoordinateChange);
      effect_.takes_axes = true;
      forget_named_axes(state_, words_);
      return;
    default:
      return acts(reason::kStateChange);
  }
}

void WordApplier::apply_axis_user(Code code) {
  effect_.takes_axes = true;
  switch (code) {
    case 280:
    case 300:
      // Home: all axes when none is named. Named ones pass through an intermediate place.
      acts(reason::kCoordinateChange);
      return words_.has_any("XYZUVW") ? forget_named_axes(state_, words_)
             : words_.has_any("ABC")  ? void()
                                      : forget_position(state_);
    case 281:
    case 301:
      // Store the home position: nothing moves by themselves. Axis words beside them are a motion
      // on LinuxCNC, in its mode, cycles too; of other controls nothing is known.
      acts(reason::kCoordinateChange);
      return words_.has_any("XYZABCUVWIJKR") ? forget_position(state_) : void();
    case 650:  // a macro call may leave any state behind
      acts(reason::kSubprogram);
      return;
    case 920:
      return apply_g92();
    case 100:
      // Data setting: work and tool offsets, and on FANUC lines of data until G11.
      acts(reason::kCoordinateChange);
      forget_position(state_);
      state_.work_offset = 0;
      modal().motion = MotionMode::kUnknown;
      return;
    default:  // G52, G92.1 ..: the coordinates of all axes may move
      acts(reason::kCoordinateChange);
      return forget_position(state_);
  }
}

// G92 sets coordinates; with S alone it limits the spindle on lathes; with F it is a thread.
void WordApplier::apply_g92() {
  acts(reason::kCoordinateChange);
  forget_named_axes(state_, words_);
  if (words_.has_any("FIKPQR")) {
    forget_position(state_);
    modal().motion = MotionMode::kUnknown;
  }
}

// G51 scales. G50 ends that on mills; on lathes it limits the spindle (S) or sets coordinates.
void WordApplier::apply_scaling(Code code) {
  effect_.takes_axes = true;
  if (code == 500 && words_.has_any("XYZUVWS")) {
    acts(reason::kCoordinateChange);
    return forget_named_axes(state_, words_);
  }
  set_frame(CodeGroup::kScaling, modal().scaling, code == 510 ? TriState::kOn : TriState::kOff,
            reason::kScaling);
}

void WordApplier::apply_rotation(Code code) {
  effect_.takes_axes = code != 690;
  if (code == 682 || code == 683 || code == 684) {
    return set_frame(CodeGroup::kRotation, modal().tilted_plane, TriState::kOn,
                     reason::kTiltedPlane);
  }
  if (code == 690) {
    set_frame(CodeGroup::kRotation, modal().tilted_plane, TriState::kOff, reason::kTiltedPlane);
  }
  set_frame(CodeGroup::kRotation, modal().rotation, code == 680 ? TriState::kOn : TriState::kOff,
            reason::kRotation);
}

// G7.1 C<radius>: on; a radius of zero ends it.
void WordApplier::apply_cylindrical() {
  bool ends = false;
  for (const char letter : {'A', 'B', 'C'}) {
    const Word* word = words_.find(letter);
    ends |= word != nullptr && word->is_number && word->value == 0;
  }
  effect_.takes_axes = true;
  set_frame(CodeGroup::kCylindrical, modal().cylindrical, ends ? TriState::kOff : TriState::kOn,
            reason::kCylindrical);
}

// G5.1 Q0, Q1: look-ahead only. Q2, Q3: the control fits a curve. With I, J: a spline.
void WordApplier::apply_smoothing(Code code) {
  if (code == 51 && words_.has_any("IJ")) {
    effect_.motion = code;
    return;
  }
  acts(reason::kControlSmoothing);
  effect_.takes_axes = true;  // X0 Y0 Z0 say which axes
  const Word* q = words_.find('Q');
  if (code == 51) {
    modal().control_smoothing = q == nullptr || !q->is_number ? TriState::kUnknown
                                : q->value <= 1               ? TriState::kOff
                                                              : TriState::kOn;
  } else {
    modal().control_smoothing = code == 1310 ? TriState::kOn : TriState::kOff;
  }
}

void WordApplier::apply_high_speed_mode() {
  const Word* p = words_.find('P');
  modal().control_smoothing = !p->is_number   ? TriState::kUnknown
                              : p->value == 0 ? TriState::kOff
                                              : TriState::kOn;
  acts(reason::kControlSmoothing);
}

void WordApplier::apply_modal_macro(Code code) {
  acts(reason::kModalMacro);
  if (code == 670) {
    modal().modal_macro = TriState::kOff;
  } else {
    effect_.takes_axes = true;  // arguments; apply_late_words forgets everything
  }
}

// Words that say how motions are read: units, feed mode, path, offsets of the tool, cycles.

void WordApplier::apply_motion_word(Code code) {
  if (code == 50 && words_.has('P') && !words_.has_any("XYZIJ")) {
    return apply_high_speed_mode();  // G5 P10000, G5 P0
  }
  effect_.motion = code;
}

void WordApplier::apply_cycle_end() {
  block(reason::kStateChange);
  if (words_.has_g(0) || words_.has_g(10) || words_.has_g(20) || words_.has_g(30)) {
    return;  // the motion word wins
  }
  // RS-274: no motion mode any more. FANUC: the G0 or G1 before the cycle. So: not known.
  modal().motion = MotionMode::kOther;
  state_.other_motion = reason::kCannedCycle;
}

void WordApplier::apply_feed_mode(FeedMode mode) {
  // The number before had another meaning; and LinuxCNC forgets it at each of these words, also
  // where the mode was set already.
  modal().feed.reset();
  block(reason::kStateChange);
  set(CodeGroup::kFeedMode, modal().feed_mode, mode);
}

void WordApplier::apply_units(Code code) {
  if (is_lathe_cycle(code, words_)) {
    acts(reason::kCannedCycle);
    effect_.takes_axes = true;
    forget_position(state_);
    return;
  }
  const Units units = code == 200 || code == 700 ? Units::kInch : Units::kMillimetre;
  if (modal().units != units || !state_.is_set(CodeGroup::kUnits)) {
    block(reason::kStateChange);
  }
  set_units(state_, units);
  state_.mark_set(CodeGroup::kUnits);
  effect_.unit_word = true;
}

void WordApplier::apply_cutter(Code code) {
  if (code != 400) {
    effect_.takes_parameters = true;
    modal().cutter_compensation = TriState::kOn;
    state_.mark_set(CodeGroup::kCutter);
    return block(reason::kCutterCompensation);
  }
  if (modal().cutter_compensation != TriState::kOff) {
    forget_position(state_);  // the tool stands beside the programmed place
  }
  set(CodeGroup::kCutter, modal().cutter_compensation, TriState::kOff);
}

// Tool offsets lie along Z on mills, along X and Z on lathes, along any axis on LinuxCNC.
void WordApplier::apply_tool_length(Code code) {
  acts(reason::kToolChange);
  forget_position(state_);
  // Axis words of G43.1 are offsets on LinuxCNC and grbl, a motion on FANUC.
  effect_.takes_axes |= code == 431 || code == 432;
  if (code == 434 || code == 435) {
    modal().tool_center_point = TriState::kOn;
  } else if (code == 490) {
    modal().tool_center_point = TriState::kOff;
  }
}

// Mills: where cycles retract to. Lathes of one kind: feed per minute and per revolution.
void WordApplier::apply_cycle_return(Code code) {
  block(reason::kStateChange);
  const bool feed_mode_named = words_.has_g(930) || words_.has_g(940) || words_.has_g(950);
  const bool of_a_cycle = modal().motion == MotionMode::kOther || has_cycle();
  if (code == 990 && !of_a_cycle && !feed_mode_named) {
    modal().feed_mode = FeedMode::kUnknown;
    modal().feed.reset();
  } else if (code == 980 && modal().feed_mode == FeedMode::kUnknown) {
    modal().feed_mode = FeedMode::kPerMinute;
    modal().feed.reset();
  }
}

bool WordApplier::has_cycle() const {
  for (const Code code : words_.g_codes()) {
    if (code >= 730 && code <= 890 && code != 800) {
      return true;
    }
  }
  return false;
}

void WordApplier::apply_work_offset(Code code) {
  const bool extended = code == 541 || words_.has('P');
  if (extended || state_.work_offset != code) {
    forget_position(state_);
  }
  state_.work_offset = extended ? 0 : code;
  acts(reason::kCoordinateChange);
}

void WordApplier::apply_path_mode(Code code) {
  switch (code) {
    case 640:
      effect_.takes_parameters = true;  // P and Q: they are set anew even when G64 is repeated
      block(reason::kStateChange);
      return set(CodeGroup::kPath, modal().path, PathMode::kBlending);
    case 610:
      return set(CodeGroup::kPath, modal().path, PathMode::kExactPath);
    case 611:
    case 600:
      return set(CodeGroup::kPath, modal().path, PathMode::kExactStop);
    default:  // G62, G63: corner override, tapping, a tolerance cycle
      effect_.takes_parameters = true;
      block(reason::kStateChange);
      modal().path = PathMode::kUnknown;
  }
}

// G7: X is a diameter. G8 ends it; G8 P1 is look-ahead on FANUC.
void WordApplier::apply_diameter(Code code) {
  if (code == 80 && words_.has('P')) {
    return acts(reason::kStateChange);
  }
  const TriState wanted = code == 70 ? TriState::kOn : TriState::kOff;
  if (modal().lathe_diameter != wanted) {
    forget_axis(state_, 0);
  }
  set(CodeGroup::kDiameter, modal().lathe_diameter, wanted);
}

}  // namespace batten::gcode
