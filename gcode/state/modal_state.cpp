#include "gcode/state/modal_state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

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

bool is_lathe_cycle(Code code, const BlockWords& words) {
  return row_of_g(code).is(trait::kOldUnits) && words.has_any("PQUVWDIJKRABCEFSXYZL");
}

std::optional<Units> units_set_by(const BlockWords& words) {
  for (const Code code : words.g_codes()) {
    const CodeRow& row = row_of_g(code);
    if (row.group == CodeGroup::kUnits && !is_lathe_cycle(code, words)) {
      return row.value.as<Units>();
    }
  }
  return std::nullopt;
}

double millimetres_per(Units units) {
  switch (units) {
    case Units::kMillimetre:
      return 1;
    case Units::kInch:
      return 25.4;
    case Units::kUnknown:
      break;
  }
  throw std::invalid_argument("millimetres_per: units unknown, expected millimetre or inch");
}

double printed_step(const NumberFormat& format, Units units) {
  return std::pow(10.0, -format.decimals) * millimetres_per(units);
}

bool path_alone_counts(const ModalState& state) {
  const std::array switches = {
      state.cutter_compensation,
      state.tool_center_point,
      state.tilted_plane,
      state.scaling,
      state.rotation,
      state.mirror,
      state.polar,
      state.cylindrical,
      state.modal_macro,
      state.constant_surface_speed,
      state.lathe_diameter,
  };
  return std::ranges::all_of(switches, [](TriState item) { return item == TriState::kOff; }) &&
         state.control_smoothing != TriState::kUnknown && state.units != Units::kUnknown &&
         state.feed_mode == FeedMode::kPerMinute && state.distance == DistanceMode::kAbsolute;
}

}  // namespace batten::gcode
