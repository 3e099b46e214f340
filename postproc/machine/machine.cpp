#include "postproc/machine/machine.h"

#include <algorithm>

namespace batten::postproc {
namespace {

double least_of_xyz(const Machine& machine, double AxisLimits::*limit) {
  return std::min({machine.axis(Axis::kX).*limit, machine.axis(Axis::kY).*limit,
                   machine.axis(Axis::kZ).*limit});
}

}  // namespace

double Machine::max_velocity() const { return least_of_xyz(*this, &AxisLimits::velocity); }
double Machine::max_acceleration() const { return least_of_xyz(*this, &AxisLimits::acceleration); }
double Machine::max_jerk() const { return least_of_xyz(*this, &AxisLimits::jerk); }
double Machine::rapid_velocity() const { return least_of_xyz(*this, &AxisLimits::rapid_velocity); }

std::string_view name_of(ControllerModel model) {
  constexpr std::array<std::string_view, 6> kNames = {"look-ahead", "linuxcnc", "grbl",
                                                      "grblhal",    "klipper",  "marlin"};
  return kNames[static_cast<std::size_t>(model)];
}

bool is_grbl(ControllerModel model) {
  return model == ControllerModel::kGrbl || model == ControllerModel::kGrblhal;
}

bool has_one_queue(ControllerModel model) {
  return is_grbl(model) || model == ControllerModel::kKlipper || model == ControllerModel::kMarlin;
}

std::string_view name_of(gcode::PathMode mode) {
  if (mode == gcode::PathMode::kExactPath) return "exact-path";
  return mode == gcode::PathMode::kExactStop ? "exact-stop" : "blend";
}

std::string_view name_of(Axis axis) {
  constexpr std::array<std::string_view, kAxes> kNames = {"x", "y", "z", "a", "b", "c"};
  return kNames[static_cast<std::size_t>(axis)];
}

}  // namespace batten::postproc
