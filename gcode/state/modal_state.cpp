#include "gcode/state/modal_state.h"

namespace batten::gcode {
namespace {

template <typename Item>
Item same_or(Item a, Item b, Item otherwise) {
  return a == b ? a : otherwise;
}

// Visits the items that is_known() asks for, in pairs of two states.
template <typename Visit>
void for_each_mode(ModalState& a, const ModalState& b, Visit visit) {
  visit(a.units, b.units, Units::kUnknown);
  visit(a.plane, b.plane, Plane::kUnknown);
  visit(a.distance, b.distance, DistanceMode::kUnknown);
  visit(a.arc_distance, b.arc_distance, DistanceMode::kUnknown);
  visit(a.feed_mode, b.feed_mode, FeedMode::kUnknown);
  visit(a.path, b.path, PathMode::kUnknown);
  for (const auto item :
       {&ModalState::cutter_compensation, &ModalState::tool_center_point, &ModalState::tilted_plane,
        &ModalState::scaling, &ModalState::rotation, &ModalState::mirror, &ModalState::polar,
        &ModalState::cylindrical, &ModalState::control_smoothing, &ModalState::modal_macro,
        &ModalState::constant_surface_speed, &ModalState::lathe_diameter}) {
    visit(a.*item, b.*item, TriState::kUnknown);
  }
}

}  // namespace

ModalState unknown_modal_state() {
  ModalState state;
  for_each_mode(state, state, [](auto& item, auto, auto unknown) { item = unknown; });
  state.motion = MotionMode::kUnknown;
  state.laser_power_mode = TriState::kUnknown;
  return state;
}

ModalState either(const ModalState& a, const ModalState& b) {
  ModalState both = a;
  for_each_mode(both, b,
                [](auto& item, auto other, auto unknown) { item = same_or(item, other, unknown); });
  both.motion = same_or(a.motion, b.motion, MotionMode::kUnknown);
  both.laser_power_mode = same_or(a.laser_power_mode, b.laser_power_mode, TriState::kUnknown);
  both.feed =
      a.feed == b.feed && a.feed_without_point == b.feed_without_point ? a.feed : std::nullopt;
  both.spindle_speed = a.spindle_speed == b.spindle_speed ? a.spindle_speed : std::nullopt;
  return both;
}

bool is_known(const ModalState& state) {
  bool known = true;
  ModalState copy = state;
  for_each_mode(copy, state, [&known](auto item, auto, auto unknown) { known &= item != unknown; });
  return known;
}

}  // namespace batten::gcode
