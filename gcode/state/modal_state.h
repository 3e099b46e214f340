// What a control remembers from block to block. Every item can be unknown: it is so after a
// block that was not understood and could have changed it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "gcode/state/block_words.h"
#include "gcode/state/path_control.h"
#include "gcode/state/stated_tolerance.h"
#include "gcode/text/number_format.h"
#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {

class OwnWords;  // gcode/state/own_words.h

struct ModalState {
  MotionMode motion = MotionMode::kUnknown;
  Units units = Units::kUnknown;
  Plane plane = Plane::kXY;
  DistanceMode distance = DistanceMode::kAbsolute;
  DistanceMode arc_distance = DistanceMode::kIncremental;  // G91.1; G90.1 is absolute
  FeedMode feed_mode = FeedMode::kPerMinute;
  PathControl path;
  TriState cutter_compensation = TriState::kOff;     // G41, G42 (any form)
  TriState tool_center_point = TriState::kOff;       // G43.4, G43.5, TRAORI, M128, FUNCTION TCPM
  TriState tilted_plane = TriState::kOff;            // G68.2, CYCLE800, PLANE
  TriState scaling = TriState::kOff;                 // G51, G50
  TriState rotation = TriState::kOff;                // G68, G69
  TriState mirror = TriState::kOff;                  // G51.1, M21 ..
  TriState polar = TriState::kOff;                   // G16, G15
  TriState polar_interpolation = TriState::kOff;     // G12.1, G112; G13.1
  TriState cylindrical = TriState::kOff;             // G07.1, G107
  TriState control_smoothing = TriState::kOff;       // G05.1 Q2: the control refits points
  TriState modal_macro = TriState::kOff;             // G66
  TriState constant_surface_speed = TriState::kOff;  // G96
  TriState lathe_diameter = TriState::kOff;          // G7 (LinuxCNC)
  // grbl M4 with $32: never known; M4 alone does not set it
  TriState laser_power_mode = TriState::kOff;
  std::optional<double> feed;  // F as last programmed, in mm/min, 1/min or mm/rev by feed_mode
  // F1000 rather than F1000., on controls where these may be two feeds (Word::without_point).
  bool feed_without_point = false;
  std::optional<double> spindle_speed;  // S
  // What the program says of how exact it has to be. No block makes it unknown.
  StatedTolerances stated;
  bool operator==(const ModalState&) const = default;
};

// What may be on or off, in the words of messages.
struct ModalSwitch {
  TriState ModalState::*item;
  std::string_view name;
  bool bends_path = true;  // where it is on, the path in X, Y, Z is not all that counts
  bool moves_path = true;  // where it is on, the tool does not follow the programmed path
};
inline constexpr std::array kModalSwitches = {
    ModalSwitch{&ModalState::cutter_compensation, "cutter compensation"},
    ModalSwitch{&ModalState::tool_center_point, "tool centre point control"},
    ModalSwitch{&ModalState::tilted_plane, "tilted plane"},
    ModalSwitch{&ModalState::scaling, "scaling"},
    ModalSwitch{&ModalState::rotation, "rotation"},
    ModalSwitch{&ModalState::mirror, "mirroring"},
    ModalSwitch{&ModalState::polar, "polar coordinates"},
    ModalSwitch{&ModalState::polar_interpolation, "polar interpolation"},
    ModalSwitch{&ModalState::cylindrical, "cylindrical coordinates"},
    // What a control fits through the points by itself is its own deviation, in both programs.
    ModalSwitch{&ModalState::control_smoothing, "smoothing by the control", false},
    ModalSwitch{&ModalState::modal_macro, "modal macro", true, false},
    ModalSwitch{&ModalState::constant_surface_speed, "constant surface speed", true, false},
    ModalSwitch{&ModalState::lathe_diameter, "diameter mode"},
    ModalSwitch{&ModalState::laser_power_mode, "laser power mode", false, false},
};

// Modes as a set, a bit for each.
using ModeSet = std::uint32_t;
namespace mode {
inline constexpr ModeSet kUnits = 1U << 0U;
inline constexpr ModeSet kPlane = 1U << 1U;
inline constexpr ModeSet kDistance = 1U << 2U;
inline constexpr ModeSet kArcDistance = 1U << 3U;
inline constexpr ModeSet kFeedMode = 1U << 4U;
inline constexpr ModeSet kPath = 1U << 5U;
inline constexpr unsigned kFirstSwitch = 6;

// Of one of kModalSwitches; of another item none.
[[nodiscard]] constexpr ModeSet of(TriState ModalState::*item) {
  for (std::size_t i = 0; i < kModalSwitches.size(); ++i) {
    if (kModalSwitches[i].item == item) return 1U << (kFirstSwitch + i);
  }
  return 0;
}
inline constexpr ModeSet kCutterCompensation = of(&ModalState::cutter_compensation);
inline constexpr ModeSet kToolCenterPoint = of(&ModalState::tool_center_point);
inline constexpr ModeSet kTiltedPlane = of(&ModalState::tilted_plane);
inline constexpr ModeSet kScaling = of(&ModalState::scaling);
inline constexpr ModeSet kRotation = of(&ModalState::rotation);
inline constexpr ModeSet kMirror = of(&ModalState::mirror);
inline constexpr ModeSet kPolar = of(&ModalState::polar);
inline constexpr ModeSet kPolarInterpolation = of(&ModalState::polar_interpolation);
inline constexpr ModeSet kCylindrical = of(&ModalState::cylindrical);
inline constexpr ModeSet kControlSmoothing = of(&ModalState::control_smoothing);
inline constexpr ModeSet kModalMacro = of(&ModalState::modal_macro);
inline constexpr ModeSet kSurfaceSpeed = of(&ModalState::constant_surface_speed);
inline constexpr ModeSet kLatheDiameter = of(&ModalState::lathe_diameter);
// All that is_known() asks for.
inline constexpr ModeSet kAll =
    (1U << (kFirstSwitch + kModalSwitches.size())) - 1 - of(&ModalState::laser_power_mode);
}  // namespace mode

// Nothing is known: after a call, or a block that could have changed anything. A mode that the
// control lacks is still off, and as it is at power-on, where it was so before.
[[nodiscard]] ModalState unknown_modal_state(const ModalState& before = {}, ModeSet lacks = 0);

// Does every item that is asked for have a value? The motion mode, the feed, the spindle speed and
// the laser mode are not asked for: a block names the first itself, the others do not bend the
// path.
[[nodiscard]] bool is_known(const ModalState& state, ModeSet asked = mode::kAll);

// A state in which the path in X, Y, Z is all there is to a cutting motion. Unknown is not.
[[nodiscard]] bool path_alone_counts(const ModalState& state);

// mm: the lesser of both, in a program with these units; nothing where neither is said. A length
// without any units counts as millimetres, the lesser reading.
[[nodiscard]] std::optional<double> least_mm(const StatedTolerances& stated, Units units);

// How exact the program says that a motion in this state has to be.
[[nodiscard]] inline std::optional<double> stated_tolerance_mm(const ModalState& state) {
  return least_mm(state.stated, state.units);
}

// The programmed position, mm. An axis that is not known has no value: before its first
// word, and after blocks that moved it in ways that were not understood.
struct Position {
  geometry::Point3 mm = geometry::Point3::Zero();  // 0 on unknown axes
  std::array<bool, 3> known = {false, false, false};
  bool operator==(const Position&) const = default;
};

// The ways in which Klartext holds the tool's centre while rotary axes turn, each with an end of
// its own: M128 (M129), M114 (M115), M144 (M145), FUNCTION TCPM (FUNCTION RESET TCPM).
enum class CenterHold : std::uint8_t { kM128, kM114, kM144, kFunction };
inline constexpr std::size_t kCenterHolds = 4;

// What ModalState tells of Klartext in one item, though several words set it.
struct KlartextState {
  bool scaled_by_axis = false;                           // cycle 26 may hold a factor for an axis
  std::array<TriState, kCenterHolds> center_holds = {};  // by CenterHold

  // ModalState::tool_center_point: what all of them come to.
  [[nodiscard]] TriState holds_center() const;
  bool operator==(const KlartextState&) const = default;
};

// All that the interpreter knows about the control between two blocks.
struct ControlState {
  ModalState modal;
  Position position;
  // With MotionMode::kOther: which kind of motion, as the reason to keep its blocks.
  std::string_view other_motion;
  Code work_offset = 0;  // G54 .. as programmed; 0: not known
  // Groups (bit = CodeGroup) that a word has set. A word that repeats what is only assumed of
  // the control at power-on is no repetition: it must stay.
  std::uint32_t set_by_word = 0;
  static_assert(kCodeGroups <= 32);
  KlartextState klartext;
  bool calls_keep_modes = false;         // ReadOptions
  ModeSet lacks = 0;                     // ReadOptions
  bool centers_follow_distance = false;  // ReadOptions
  const OwnWords* own_words = nullptr;   // ReadOptions; they outlive the reading

  [[nodiscard]] bool is_set(CodeGroup group) const { return (set_by_word & bit(group)) != 0; }
  void mark_set(CodeGroup group) { set_by_word |= bit(group); }
  bool operator==(const ControlState&) const = default;

 private:
  static std::uint32_t bit(CodeGroup group) { return 1U << static_cast<unsigned>(group); }
};

void forget_axis(ControlState& state, std::size_t axis);
void forget_position(ControlState& state);

// State and position: the block could have changed anything.
void forget_everything(ControlState& state);

// What a subprogram or a macro could have changed.
void forget_what_calls_change(ControlState& state);

// The axes that the block names. U, V, W are increments of X, Y, Z on lathes.
void forget_named_axes(ControlState& state, const BlockWords& words);

// What is known when either state may hold: items in which they differ are unknown.
[[nodiscard]] ControlState either(const ControlState& a, const ControlState& b);

// Units that become known or unknown take the position with them: it was numbers without a
// meaning. Between inch and millimetre it stays (as LinuxCNC and grbl keep it), while the
// meaning of the last F differs from control to control: it is forgotten.
void set_units(ControlState& state, Units units);

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

// mm, rms across the path: each printed coordinate is off by up to half a step, evenly.
[[nodiscard]] double printed_rms(const NumberFormat& format, Units units);

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

// Those of a known plane.
[[nodiscard]] inline const PlaneAxes& axes_of(Plane plane) {
  return kPlaneAxes[plane == Plane::kZX ? 1 : plane == Plane::kYZ ? 2 : 0];
}

// The plane across a unit vector of either sign; nothing when it is no axis of the coordinate
// system.
[[nodiscard]] inline const PlaneAxes* plane_across(const geometry::Vector3& axis) {
  for (const PlaneAxes& plane : kPlaneAxes) {
    if (std::abs(std::abs(axis[plane.normal]) - 1) < geometry::kSameDirection) return &plane;
  }
  return nullptr;
}

}  // namespace batten::gcode
