// Words that say how motions are read: units, feed mode, path, offsets of the tool, cycles.
#include "gcode/interpreter/word_applier.h"
#include "gcode/state/units.h"

namespace batten::gcode {

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
