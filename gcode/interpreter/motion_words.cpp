#include "gcode/interpreter/motion_words.h"

#include "gcode/state/reason.h"

namespace batten::gcode {
namespace {

std::string_view why_arc_not_followed(const BlockWords& words, const StateEffect& effect,
                                      const ControlState& state) {
  const ModalState& modal = state.modal;
  if (modal.plane == Plane::kUnknown || modal.arc_distance == DistanceMode::kUnknown) {
    return reason::kStateUnknown;
  }
  const ArcAxes plane = axes_of(modal.plane);
  if (!state.position.known[plane.axis0] || !state.position.known[plane.axis1]) {
    return reason::kPositionUnknown;
  }
  const Word* turns = words.find('P');
  const bool several_turns = turns != nullptr && turns->value != 1;
  if (!effect.takes_parameters && (several_turns || words.has_any("QL"))) {
    return reason::kNotUnderstood;
  }
  return {};
}

double to_mm(double value, const ControlState& state) {
  return state.modal.units == Units::kInch ? value * kMillimetresPerInch : value;
}

}  // namespace

MotionMode mode_of(Code motion) {
  switch (motion) {
    case 0:
      return MotionMode::kRapid;
    case 10:
      return MotionMode::kLine;
    case 20:
      return MotionMode::kClockwise;
    case 30:
      return MotionMode::kCounterclockwise;
    default:
      return MotionMode::kOther;
  }
}

// Why a motion that is neither G0, G1, G2 nor G3 ends a run.
std::string_view other_motion_reason(Code motion) {
  switch (motion) {
    case 50:
    case 51:
    case 52:
    case 53:
    case 60:
    case 61:
    case 62:
    case 63:
      return reason::kSpline;
    case 310:
    case 382:
    case 383:
    case 384:
    case 385:
      return reason::kProbe;
    case 320:
    case 330:
    case 331:
    case 340:
    case 760:
      return reason::kThreading;
    default:
      return reason::kCannedCycle;
  }
}

bool is_arc(MotionMode mode) {
  return mode == MotionMode::kClockwise || mode == MotionMode::kCounterclockwise;
}

std::string_view why_not_followed(const BlockWords& words, const StateEffect& effect,
                                  const ControlState& state) {
  const ModalState& modal = state.modal;
  if (!words.all_numbers()) {
    return reason::kExpression;
  }
  if (modal.motion == MotionMode::kUnknown || modal.distance == DistanceMode::kUnknown) {
    return reason::kStateUnknown;
  }
  if (modal.polar != TriState::kOff || modal.modal_macro != TriState::kOff) {
    return modal.polar == TriState::kOn         ? reason::kPolar
           : modal.modal_macro == TriState::kOn ? reason::kModalMacro
                                                : reason::kStateUnknown;
  }
  if (is_arc(modal.motion)) {
    return why_arc_not_followed(words, effect, state);
  }
  if (!effect.takes_parameters && words.has('R')) {
    return reason::kCornerWord;  // G1 X10 R2: a rounded corner
  }
  if (!effect.takes_parameters && words.has_any("IJKPQL")) {
    return reason::kNotUnderstood;
  }
  return {};
}

Position end_of_motion(const BlockWords& words, const ControlState& state) {
  Position end = state.position;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Word* word = words.find("XYZ"[axis]);
    if (word == nullptr) {
      continue;
    }
    double& place = end.mm[static_cast<Eigen::Index>(axis)];
    if (state.modal.distance == DistanceMode::kAbsolute) {
      place = to_mm(word->value, state);
      end.known[axis] = true;
    } else {
      place += end.known[axis] ? to_mm(word->value, state) : 0;
    }
  }
  return end;
}

ArcWords arc_words(const BlockWords& words, const ControlState& state, const Position& end) {
  ArcWords arc;
  arc.start = state.position.mm;
  arc.end = end.mm;
  arc.plane = axes_of(state.modal.plane);
  arc.clockwise = state.modal.motion == MotionMode::kClockwise;
  arc.center_absolute = state.modal.arc_distance == DistanceMode::kAbsolute;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (const Word* word = words.find("IJK"[axis])) {
      arc.center[axis] = to_mm(word->value, state);
    }
  }
  if (const Word* word = words.find('R')) {
    arc.radius = to_mm(word->value, state);
  }
  return arc;
}

}  // namespace batten::gcode
