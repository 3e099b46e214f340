#include "postproc/machine/machine.h"

#include <algorithm>
#include <array>

namespace batten::postproc {
namespace {

// LinuxCNC, with the limits under which its model was compared with the real control
// (docs/algorithms/cycle_time.md): a fast router or engraving machine.
Machine linuxcnc() {
  Machine m;
  m.name = "linuxcnc";
  m.description = "LinuxCNC 2.9, G64 P0.01, 400 mm/s and 4000 mm/s2 on every axis, 1 ms servo";
  m.model = ControllerModel::kLinuxcnc;
  m.max_velocity = 400;
  m.max_acceleration = 4000;
  m.rapid_velocity = 400;
  m.block_period = 0.001;
  // What the planner optimises ([TRAJ]ARC_BLEND_OPTIMIZATION_DEPTH); its queue of 2000
  // blocks is never the limit.
  m.look_ahead = 50;
  m.blend_tolerance = 0.01;
  m.naive_cam_tolerance = 0.01;
  return m;
}

// grbl on a belt-driven hobby router. grbl's own defaults (500 mm/min, 10 mm/s2) are meant
// for first steps of an unknown machine; owners of such routers set about 5000 mm/min and
// 400 mm/s2.
Machine grbl() {
  Machine m;
  m.name = "grbl";
  m.description = "grbl 1.1 on a hobby router, 5000 mm/min and 400 mm/s2 on every axis";
  m.model = ControllerModel::kGrbl;
  m.max_velocity = 5000.0 / 60;
  m.max_acceleration = 400;
  m.rapid_velocity = 5000.0 / 60;
  // 115200 baud are 11,520 bytes a second: X12.345Y-6.789 and its line end take 1.3 ms.
  m.block_period = 0.0013;
  m.look_ahead = 15;  // the ring of 16 holds one block less
  m.junction_deviation = 0.01;
  m.arc_tolerance = 0.002;
  m.blend_tolerance = 0;
  return m;
}

// A machining centre with an industrial control of which nothing else is known: 20 m/min,
// a fifth of g, 2 ms a block (500 blocks/s) and 200 blocks of look-ahead are what makers
// name for mid-range controls.
Machine mill() {
  Machine m;
  m.name = "mill";
  m.description = "machining centre, 20 m/min and 2000 mm/s2 on every axis, 500 blocks/s";
  m.model = ControllerModel::kLookAhead;
  m.max_velocity = 20000.0 / 60;
  m.max_acceleration = 2000;
  m.rapid_velocity = 20000.0 / 60;
  m.block_period = 0.002;
  m.look_ahead = 200;
  m.blend_tolerance = 0;
  return m;
}

}  // namespace

std::span<const Machine> built_in_machines() {
  static const std::array<Machine, 3> machines = {linuxcnc(), grbl(), mill()};
  return machines;
}

const Machine* find_machine(std::string_view name) {
  const auto machines = built_in_machines();
  const auto found = std::find_if(machines.begin(), machines.end(),
                                  [&](const Machine& m) { return m.name == name; });
  return found == machines.end() ? nullptr : &*found;
}

}  // namespace batten::postproc
