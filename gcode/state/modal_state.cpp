#include "gcode/state/modal_state.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>

namespace batten::gcode {
namespace {

// Calls `visit` with the items of two states, what each is where it is not known, and its bit in a
// ModeSet (the motion has none): all but feeds and speeds.
template <typename Visit>
void for_each_mode(ModalState& a, const ModalState& b, Visit visit) {
  visit(a.units, b.units, Units::kUnknown, mode::kUnits);
  visit(a.plane, b.plane, Plane::kUnknown, mode::kPlane);
  visit(a.distance, b.distance, DistanceMode::kUnknown, mode::kDistance);
  visit(a.arc_distance, b.arc_distance, DistanceMode::kUnknown, mode::kArcDistance);
  visit(a.feed_mode, b.feed_mode, FeedMode::kUnknown, mode::kFeedMode);
  visit(a.path.mode, b.path.mode, PathMode::kUnknown, mode::kPath);
  visit(a.motion, b.motion, MotionMode::kUnknown, ModeSet{0});
  ModeSet next = 1U << mode::kFirstSwitch;
  for (const ModalSwitch& each : kModalSwitches) {
    visit(a.*each.item, b.*each.item, TriState::kUnknown, next);
    next <<= 1U;
  }
}

// An item that is added to the state does not compile here: it is to be visited above, by a row of
// kModalSwitches where it is a switch, or stands beside feeds and speeds in `either`.
constexpr std::size_t switches_of(const ModalState& state) {
  const auto& [motion, units, plane, distance, arc_distance, feed_mode, path, cutter, tool_center,
               tilted, scaling, rotation, mirror, polar, interpolation, cylindrical, smoothing,
               macro, surface, diameter, laser, feed, without_point, spindle, stated] = state;
  const auto count = [](const auto&... items) {
    return (0 + ... + (std::is_same_v<decltype(items), const TriState&> ? 1 : 0));
  };
  return count(motion, units, plane, distance, arc_distance, feed_mode, path, cutter, tool_center,
               tilted, scaling, rotation, mirror, polar, interpolation, cylindrical, smoothing,
               macro, surface, diameter, laser, feed, without_point, spindle, stated);
}
static_assert(switches_of({}) == kModalSwitches.size());

double to_mm(const StatedLength& length, Units units) {
  const Units known = length.units != Units::kUnknown ? length.units : units;
  return known == Units::kUnknown ? length.value : length.value * millimetres_per(known);
}

// Of each kind the lesser one, or the only one.
StatedTolerances lesser_of(const StatedTolerances& a, const StatedTolerances& b) {
  StatedTolerances least = a;
  const auto is_less = [](const StatedLength& one, const StatedLength& other) {
    return to_mm(one, Units::kUnknown) < to_mm(other, Units::kUnknown);
  };
  if (b.by_comment && (!a.by_comment || is_less(*b.by_comment, *a.by_comment))) {
    least.by_comment = b.by_comment;
  }
  if (b.by_control_mm) {
    least.by_control_mm = std::min(*b.by_control_mm, a.by_control_mm.value_or(*b.by_control_mm));
  }
  return least;
}

ModalState either(const ModalState& a, const ModalState& b) {
  ModalState both = a;
  for_each_mode(both, b, [](auto& item, auto other, auto unknown, ModeSet) {
    if (item != other) item = unknown;
  });
  if (a.feed != b.feed || a.feed_without_point != b.feed_without_point) both.feed.reset();
  if (a.spindle_speed != b.spindle_speed) both.spindle_speed.reset();
  if (a.path != b.path) both.path = both.path.mode;
  both.stated = lesser_of(a.stated, b.stated);
  return both;
}

}  // namespace

ModalState unknown_modal_state(const ModalState& before, ModeSet lacks) {
  ModalState state;  // as at power-on
  state.stated = before.stated;
  for_each_mode(state, before, [lacks](auto& item, auto was, auto unknown, ModeSet bit) {
    if ((lacks & bit) == 0 || was != item) item = unknown;
  });
  if ((lacks & mode::kUnits) != 0) state.units = before.units;  // nothing can have changed them
  return state;
}

bool is_known(const ModalState& state, ModeSet asked) {
  ModalState items = state;
  bool known = true;
  for_each_mode(items, state, [&known, asked](auto item, auto, auto unknown, ModeSet bit) {
    known &= item != unknown || (asked & bit) == 0;
  });
  return known;
}

std::optional<double> least_mm(const StatedTolerances& stated, Units units) {
  if (!stated.by_comment) return stated.by_control_mm;
  const double by_comment = to_mm(*stated.by_comment, units);
  return std::min(by_comment, stated.by_control_mm.value_or(by_comment));
}

bool path_alone_counts(const ModalState& state) {
  const auto leaves_path = [&state](const ModalSwitch& each) {
    return !each.bends_path || state.*each.item == TriState::kOff;
  };
  return std::ranges::all_of(kModalSwitches, leaves_path) && state.units != Units::kUnknown &&
         state.feed_mode == FeedMode::kPerMinute && state.distance == DistanceMode::kAbsolute;
}

void forget_axis(ControlState& state, std::size_t axis) {
  state.position.known[axis] = false;
  state.position.mm[static_cast<Eigen::Index>(axis)] = 0;
}

TriState KlartextState::holds_center() const {
  const auto any = [this](TriState held) {
    return std::find(center_holds.begin(), center_holds.end(), held) != center_holds.end();
  };
  if (any(TriState::kOn)) return TriState::kOn;
  return any(TriState::kUnknown) ? TriState::kUnknown : TriState::kOff;
}

void forget_position(ControlState& state) { state.position = Position{}; }

void forget_everything(ControlState& state) {
  ControlState unknown;
  unknown.modal = unknown_modal_state(state.modal, state.lacks);
  unknown.calls_keep_modes = state.calls_keep_modes;
  unknown.lacks = state.lacks;
  unknown.centers_follow_distance = state.centers_follow_distance;
  unknown.own_words = state.own_words;
  unknown.klartext.center_holds.fill(TriState::kUnknown);
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
  both.klartext.scaled_by_axis = a.klartext.scaled_by_axis || b.klartext.scaled_by_axis;
  for (std::size_t i = 0; i < kCenterHolds; ++i) {
    TriState& hold = both.klartext.center_holds[i];
    if (hold != b.klartext.center_holds[i]) hold = TriState::kUnknown;
  }
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

double printed_rms(const NumberFormat& format, Units units) {
  return printed_step(format, units) / std::sqrt(12);
}

}  // namespace batten::gcode
