#include "gcode/state/modal_state.h"

#include <algorithm>
#include <stdexcept>
#include <type_traits>

namespace batten::gcode {
namespace {

// Calls `visit` with the items of two states and what each is where it is not known: those that
// is_known() asks for, then the others but feeds and speeds.
template <typename Visit>
void for_each_mode(ModalState& a, const ModalState& b, Visit visit) {
  visit(a.units, b.units, Units::kUnknown);
  visit(a.plane, b.plane, Plane::kUnknown);
  visit(a.distance, b.distance, DistanceMode::kUnknown);
  visit(a.arc_distance, b.arc_distance, DistanceMode::kUnknown);
  visit(a.feed_mode, b.feed_mode, FeedMode::kUnknown);
  visit(a.path, b.path, PathMode::kUnknown);
  visit(a.motion, b.motion, MotionMode::kUnknown);
  for (const ModalSwitch& each : kModalSwitches) {
    visit(a.*each.item, b.*each.item, TriState::kUnknown);
  }
}

// An item that is added to the state does not compile here: it is to be visited above, by a row of
// kModalSwitches where it is a switch, or stands beside feeds and speeds in `either`.
constexpr std::size_t switches_of(const ModalState& state) {
  const auto& [motion, units, plane, distance, arc_distance, feed_mode, path, cutter, tool_center,
               tilted, scaling, rotation, mirror, polar, cylindrical, smoothing, macro, surface,
               diameter, laser, feed, without_point, spindle] = state;
  const auto count = [](const auto&... items) {
    return (0 + ... + (std::is_same_v<decltype(items), const TriState&> ? 1 : 0));
  };
  return count(motion, units, plane, distance, arc_distance, feed_mode, path, cutter, tool_center,
               tilted, scaling, rotation, mirror, polar, cylindrical, smoothing, macro, surface,
               diameter, laser, feed, without_point, spindle);
}
static_assert(switches_of({}) == kModalSwitches.size());

ModalState either(const ModalState& a, const ModalState& b) {
  ModalState both = a;
  for_each_mode(both, b, [](auto& item, auto other, auto unknown) {
    if (item != other) item = unknown;
  });
  if (a.feed != b.feed || a.feed_without_point != b.feed_without_point) both.feed.reset();
  if (a.spindle_speed != b.spindle_speed) both.spindle_speed.reset();
  return both;
}

}  // namespace

ModalState unknown_modal_state() {
  ModalState state;
  for_each_mode(state, state, [](auto& item, auto, auto unknown) { item = unknown; });
  return state;
}

ModalState unknown_basic_modes(const ModalState& before) {
  ModalState after = unknown_modal_state();
  for (const ModalSwitch& each : kModalSwitches) {
    const bool has_it = each.item == &ModalState::laser_power_mode;
    if (!has_it && before.*each.item == TriState::kOff) after.*each.item = TriState::kOff;
  }
  if (before.path == PathMode::kBlending) after.path = before.path;
  if (before.arc_distance == DistanceMode::kIncremental) after.arc_distance = before.arc_distance;
  return after;
}

bool is_known(const ModalState& state) {
  ModalState asked = state;
  asked.motion = MotionMode::kLine;
  asked.laser_power_mode = TriState::kOff;
  bool known = true;
  for_each_mode(asked, state,
                [&known](auto item, auto, auto unknown) { known &= item != unknown; });
  return known;
}

bool path_alone_counts(const ModalState& state) {
  const auto leaves_path = [&state](const ModalSwitch& each) {
    return !each.bends_path || state.*each.item == TriState::kOff;
  };
  return std::ranges::all_of(kModalSwitches, leaves_path) &&
         state.control_smoothing != TriState::kUnknown && state.units != Units::kUnknown &&
         state.feed_mode == FeedMode::kPerMinute && state.distance == DistanceMode::kAbsolute;
}

void forget_axis(ControlState& state, std::size_t axis) {
  state.position.known[axis] = false;
  state.position.mm[static_cast<Eigen::Index>(axis)] = 0;
}

void forget_position(ControlState& state) { state.position = Position{}; }

void forget_everything(ControlState& state) {
  ControlState unknown;
  unknown.modal = state.only_basic_modes ? unknown_basic_modes(state.modal) : unknown_modal_state();
  unknown.calls_keep_modes = state.calls_keep_modes;
  unknown.only_basic_modes = state.only_basic_modes;
  unknown.own_words = state.own_words;
  state = unknown;
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
    if (words.has("XYZ"[axis]) || words.has("UVW"[axis])) forget_axis(state, axis);
  }
}

ControlState either(const ControlState& a, const ControlState& b) {
  ControlState both = a;
  both.modal = either(a.modal, b.modal);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const bool same =
        a.position.known[axis] && b.position.known[axis] && a.position.mm[i] == b.position.mm[i];
    if (!same) forget_axis(both, axis);
  }
  // What is programmed next has no certain length.
  if (a.modal.units != b.modal.units) forget_position(both);
  if (a.other_motion != b.other_motion) both.other_motion = {};
  if (a.work_offset != b.work_offset) both.work_offset = 0;
  both.set_by_word = a.set_by_word & b.set_by_word;
  return both;
}

void set_units(ControlState& state, Units units) {
  if (state.modal.units == units) return;
  if (state.modal.units == Units::kUnknown || units == Units::kUnknown) forget_position(state);
  state.modal.units = units;
  state.modal.feed.reset();
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
  if (units == Units::kUnknown) {
    throw std::invalid_argument("millimetres_per: units unknown, expected millimetre or inch");
  }
  return units == Units::kInch ? kMillimetresPerInch : 1;
}

double printed_step(const NumberFormat& format, Units units) {
  return std::pow(10.0, -format.decimals) * millimetres_per(units);
}

}  // namespace batten::gcode
