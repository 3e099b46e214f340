// What a control remembers from block to block. Every item can be unknown: it is so after a
// block that was not understood and could have changed it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "gcode/state/block_words.h"
#include "gcode/text/number_format.h"
#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {

struct ModalState {
  MotionMode motion = MotionMode::kUnknown;
  Units units = Units::kUnknown;
  Plane plane = Plane::kXY;
  DistanceMode distance = DistanceMode::kAbsolute;
  DistanceMode arc_distance = DistanceMode::kIncremental;  // G91.1; G90.1 is absolute
  FeedMode feed_mode = FeedMode::kPerMinute;
  PathMode path = PathMode::kBlending;
  TriState cutter_compensation = TriState::kOff;  // G41, G42 (any form)
  TriState tool_center_point = TriState::kOff;    // G43.4, G43.5, TRAORI, M128
  TriState tilted_plane = TriState::kOff;         // G68.2, CYCLE800, PLANE
  TriState scaling = TriState::kOff;              // G51, G50
  TriState rotation = TriState::kOff;             // G68, G69
  TriState mirror = TriState::kOff;               // G51.1, M21 ..
  TriState polar = TriState::kOff;                // G16, G12.1, G112
  TriState cylindrical = TriState::kOff;          // G07.1, G107
  TriState control_smoothing =
      TriState::kOff;  // G05.1 Q2/Q3, G05 P10000, G131: the control refits points
  TriState modal_macro = TriState::kOff;             // G66
  TriState constant_surface_speed = TriState::kOff;  // G96
  TriState lathe_diameter = TriState::kOff;          // G7 (LinuxCNC)
  TriState laser_power_mode =
      TriState::kOff;          // grbl M4 with $32: never known; M4 alone does not set it
  std::optional<double> feed;  // F as last programmed, in mm/min, 1/min or mm/rev by feed_mode
  // F1000 rather than F1000., on controls where these may be two feeds (Word::without_point).
  bool feed_without_point = false;
  std::optional<double> spindle_speed;  // S
  bool operator==(const ModalState&) const = default;
};

// Nothing is known: after a call, or a block that could have changed anything.
[[nodiscard]] ModalState unknown_modal_state();

// What is known when either of two states may hold: items in which they differ are unknown.
[[nodiscard]] ModalState either(const ModalState& a, const ModalState& b);

// Does every item have a value? The motion mode, the feed, the spindle speed and the laser
// mode are not asked for: a block names the first itself, the others do not bend the path.
[[nodiscard]] bool is_known(const ModalState& state);

// The programmed position, mm. An axis that is not known has no value: before its first
// word, and after blocks that moved it in ways that were not understood.
struct Position {
  geometry::Point3 mm = geometry::Point3::Zero();  // 0 on unknown axes
  std::array<bool, 3> known = {false, false, false};
  [[nodiscard]] bool all_known() const { return known[0] && known[1] && known[2]; }
};

// Units: G20, G21 and what other controls say in their place, and the sizes of printed numbers.

// The units that the block sets; nothing where it sets none. G70 and G71 with parameters are cycles
// of a lathe.
[[nodiscard]] std::optional<Units> units_set_by(const BlockWords& words);

// Whether G70 or G71 beside these words is such a cycle.
[[nodiscard]] bool is_lathe_cycle(Code code, const BlockWords& words);

// 1 or 25.4. Throws std::invalid_argument for unknown units.
[[nodiscard]] double millimetres_per(Units units);

// The step between neighbouring numbers of a format, in mm.
[[nodiscard]] double printed_step(const NumberFormat& format, Units units);

// The three planes of G17, G18 and G19 by their axes.

// A plane's axes (0, 1, 2 for X, Y, Z) in the order in which its normal is right-handed: seen from
// the tip of +Y, the way from Z to X is counter-clockwise, so G18 has Z before X and G3 is
// counter-clockwise in all three.
struct PlaneAxes {
  Plane plane = Plane::kUnknown;
  int first = 0;
  int second = 1;
  int normal = 2;
};

inline constexpr std::array<PlaneAxes, 3> kPlaneAxes = {
    PlaneAxes{Plane::kXY, 0, 1, 2}, PlaneAxes{Plane::kZX, 2, 0, 1}, PlaneAxes{Plane::kYZ, 1, 2, 0}};

// The plane across a unit vector of either sign; nothing when it is no axis of the coordinate
// system.
[[nodiscard]] inline const PlaneAxes* plane_across(const geometry::Vector3& axis) {
  for (const PlaneAxes& plane : kPlaneAxes) {
    if (std::abs(std::abs(axis[plane.normal]) - 1) < geometry::kSameDirection) return &plane;
  }
  return nullptr;
}

// A state in which the path in X, Y, Z is all there is to a cutting motion. Unknown is not. What a
// control fits through the points by itself (COMPCAD) is its own deviation, in both programs.
[[nodiscard]] bool path_alone_counts(const ModalState& state);

}  // namespace batten::gcode
