// What a machine and its control can do: limits of its axes and of the path as a whole, and the
// settings of the control that decide how fast it runs a program. Built in or from a file of the
// user's own: docs/machine_file.md.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <string_view>

#include "gcode/state/modal_state.h"

namespace batten::postproc {

// How the control runs blocks; see docs/controllers/ for the rules of each.
enum class ControllerModel {
  kLookAhead,  // any control: junction speed by acceleration, block rate; limits on jerk
  kLinuxcnc,  // one segment per servo period, half tangential acceleration on arcs, blending within
              // P
  kGrbl,     // junction deviation, a planner of 16 blocks, trapezoids; ends on whole steps, arcs in
             // single precision
  kGrblhal,  // the same, arcs in double precision
  kKlipper,  // square corner velocity, minimum cruise ratio, arcs in chords of equal length
  kMarlin,   // junction deviation with a rule for short blocks, or steps of velocity; as grbl else
};

enum class Axis { kX, kY, kZ, kA, kB, kC };
inline constexpr std::size_t kAxes = 6;
inline constexpr std::size_t kLinearAxes = 3;  // X Y Z, which stand before the rotary ones

// In mm on X Y Z, in degrees on A B C. All above 0; only a jerk may be infinite: there is no such
// limit then.
struct AxisLimits {
  double velocity = 0;        // per s, while cutting
  double acceleration = 0;    // per s^2
  double jerk = 0;            // per s^3
  double rapid_velocity = 0;  // per s, in a rapid move
  // Of the motor, per mm or degree: the ends of moves lie on whole steps. Infinite: they lie where
  // the program says.
  double steps = std::numeric_limits<double>::infinity();
  // Per s: by so much an axis may change its velocity at once, where joints go by that (Marlin's
  // classic jerk, RepRapFirmware's M566). Infinite: they go by the junction deviation.
  double velocity_step = std::numeric_limits<double>::infinity();

  bool operator==(const AxisLimits&) const = default;
};

struct Machine {
  static constexpr double kNone = std::numeric_limits<double>::infinity();  // no such limit
  static constexpr AxisLimits kLinearAxis{400, 4000, kNone, 400};
  // 15 turns a minute within 0.1 s: a common indexing table that can also cut.
  static constexpr AxisLimits kRotaryAxis{90, 900, kNone, 90};

  std::string name = {};
  std::string description = {};
  std::string source = {};  // where its numbers come from
  ControllerModel model = ControllerModel::kLookAhead;

  std::array<AxisLimits, kAxes> axes = {kLinearAxis, kLinearAxis, kLinearAxis,
                                        kRotaryAxis, kRotaryAxis, kRotaryAxis};
  // The path of X Y Z as a whole, beside what its axes allow.
  double path_feed = kNone;          // mm/s, in any move ([TRAJ]MAX_LINEAR_VELOCITY)
  double path_acceleration = kNone;  // mm/s^2, along the path
  double path_jerk = kNone;          // mm/s^3, along the path

  // How blocks come in.
  double block_period = 0.001;  // s: no block is passed faster
  double stream_rate = kNone;  // bytes/s of the line that feeds the control; kNone: it reads a file
  int look_ahead = 2000;       // blocks

  // Settings of the control. Each model reads those that its control has.
  double servo_period = 0.001;  // s: how often the axes get a new position
  gcode::PathMode path_mode = gcode::PathMode::kBlending;  // until the program says G61 or G64
  double junction_deviation = 0.01;                        // mm (grbl's $11)
  double arc_tolerance = 0.002;       // mm: arcs become chords this near to them (grbl's $12)
  double square_corner_velocity = 5;  // mm/s: Klipper's speed at a right angle
  double minimum_cruise_ratio = 0.5;  // Klipper: of a move that speeds up and slows down
  double arc_resolution = 1;          // mm: Klipper's chords of arcs ([gcode_arcs] resolution)
  double blend_tolerance = 0.01;      // mm (LinuxCNC's G64 P when the program sets none; 0: no P)
  double naive_cam_tolerance = 0;     // mm (LinuxCNC's G64 Q, which is P where only P is given)

  // What takes time beside moves.
  double tool_change_time = 0;    // s for each tool change, from the last chip to the first
  double spindle_start_time = 0;  // s until a spindle that was started or turned round is up
  double extra_dwell_time = 0;    // s that each dwell takes beyond what it says

  [[nodiscard]] const AxisLimits& axis(Axis which) const {
    return axes[static_cast<std::size_t>(which)];
  }
  [[nodiscard]] AxisLimits& axis(Axis which) { return axes[static_cast<std::size_t>(which)]; }

  // The least over X Y Z: for rules that know one limit for all directions.
  [[nodiscard]] double max_velocity() const;      // mm/s
  [[nodiscard]] double max_acceleration() const;  // mm/s^2
  [[nodiscard]] double max_jerk() const;          // mm/s^3, kNone without a limit
  [[nodiscard]] double rapid_velocity() const;    // mm/s

  bool operator==(const Machine&) const = default;
};

// "look-ahead", "linuxcnc", "grbl", "grblhal", "klipper", "marlin"
[[nodiscard]] std::string_view name_of(ControllerModel model);
// Is it grbl or grblHAL, which share their settings and their planner?
[[nodiscard]] bool is_grbl(ControllerModel model);
// Do rapids and cuts follow each other in one queue, without a stop between them?
[[nodiscard]] bool has_one_queue(ControllerModel model);
[[nodiscard]] std::string_view name_of(
    gcode::PathMode mode);                          // "blend", "exact-path", "exact-stop"
[[nodiscard]] std::string_view name_of(Axis axis);  // "x" to "c"

[[nodiscard]] std::span<const Machine> built_in_machines();
[[nodiscard]] const Machine* find_machine(std::string_view name);

// Units in which people give numbers, in those in which we reckon.

inline constexpr double kInch = 25.4;                      // mm
inline constexpr double kMinute = 60;                      // s
inline constexpr double kRadian = 180 / std::numbers::pi;  // degrees

}  // namespace batten::postproc
