// What a machine and its control can do.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace batten::postproc {

// How the control runs blocks; see docs/controllers/ for the rules of each.
enum class ControllerModel {
  kLookAhead,  // any control: junction speed by acceleration, block rate, no jerk
  kLinuxcnc,  // one segment per servo period, half tangential acceleration on arcs, blending within
              // P
  kGrbl,      // junction deviation, a planner of 16 blocks, trapezoids
};

struct Machine {
  std::string name;
  std::string description;
  ControllerModel model = ControllerModel::kLookAhead;
  double max_velocity = 400;         // mm/s on every axis
  double max_acceleration = 4000;    // mm/s^2 on every axis
  double rapid_velocity = 400;       // mm/s
  double block_period = 0.001;       // s: no block is passed faster
  int look_ahead = 2000;             // blocks
  double junction_deviation = 0.01;  // mm (grbl's $11)
  double arc_tolerance = 0.002;      // mm: arcs become chords this near to them (grbl's $12)
  double blend_tolerance = 0.01;     // mm (LinuxCNC's G64 P when the program sets none; 0: no P)
  double naive_cam_tolerance = 0;    // mm (LinuxCNC's G64 Q, which is P where only P is given)
};

[[nodiscard]] std::span<const Machine> built_in_machines();
[[nodiscard]] const Machine* find_machine(std::string_view name);

}  // namespace batten::postproc
