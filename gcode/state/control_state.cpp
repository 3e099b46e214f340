#include "gcode/state/control_state.h"

namespace batten::gcode {

void forget_axis(ControlState& state, std::size_t axis) {
  state.position.known[axis] = false;
  state.position.mm[static_cast<Eigen::Index>(axis)] = 0;
}

void forget_position(ControlState& state) { state.position = Position{}; }

void forget_everything(ControlState& state) {
  state.modal = unknown_modal_state();
  forget_position(state);
  state.other_motion = {};
  state.work_offset = 0;
  state.set_by_word = 0;
}

void forget_what_calls_change(ControlState& state) {
  if (!state.calls_keep_modes) return forget_everything(state);
  state.modal.motion = MotionMode::kUnknown;
  state.modal.feed.reset();
  state.modal.spindle_speed.reset();
  forget_position(state);
  state.other_motion = {};
}

void forget_named_axes(ControlState& state, const BlockWords& words) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (words.has("XYZ"[axis]) || words.has("UVW"[axis])) {
      forget_axis(state, axis);
    }
  }
}

bool same_knowledge(const ControlState& a, const ControlState& b) {
  return a.modal == b.modal && a.position.known == b.position.known &&
         a.position.mm == b.position.mm && a.other_motion == b.other_motion &&
         a.work_offset == b.work_offset && a.set_by_word == b.set_by_word;
}

ControlState either(const ControlState& a, const ControlState& b) {
  ControlState both = a;
  both.modal = either(a.modal, b.modal);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const bool same =
        a.position.known[axis] && b.position.known[axis] && a.position.mm[i] == b.position.mm[i];
    if (!same) {
      forget_axis(both, axis);
    }
  }
  if (a.modal.units != b.modal.units) {
    forget_position(both);  // what is programmed next has no certain length
  }
  if (a.other_motion != b.other_motion) {
    both.other_motion = {};
  }
  if (a.work_offset != b.work_offset) {
    both.work_offset = 0;
  }
  both.set_by_word = a.set_by_word & b.set_by_word;
  return both;
}

void set_units(ControlState& state, Units units) {
  if (state.modal.units == units) {
    return;
  }
  if (state.modal.units == Units::kUnknown || units == Units::kUnknown) {
    forget_position(state);
  }
  state.modal.units = units;
  state.modal.feed.reset();
}

}  // namespace batten::gcode
