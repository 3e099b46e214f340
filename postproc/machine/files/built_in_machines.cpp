// The machines that need no file. Limits of real ones differ by more than a factor of ten, so each
// says in `source` where its figures come from; a machine file starts as one of them.
#include <algorithm>
#include <array>

#include "postproc/machine/machine.h"

namespace batten::postproc {
namespace {

using AllAxes = std::array<AxisLimits, kAxes>;

// X, Y and Z alike; A, B and C as they are where nothing is known.
AllAxes xyz(const AxisLimits& limits) {
  AllAxes axes = Machine().axes;
  std::fill_n(axes.begin(), kLinearAxes, limits);
  return axes;
}

constexpr double kPerMinute = 1.0 / 60;

// A metric mill or router with stepper motors, as LinuxCNC's own configuration has it.
Machine linuxcnc() {
  Machine m = {
      .name = "linuxcnc",
      .description = "LinuxCNC 2.9, G64 P0.0127, 60 mm/s (Z 40 mm/s) and 500 mm/s2, 1 ms servo",
      .source =
          "LinuxCNC 2.9, its sample configuration sim/qtdragon/qtdragon_xyz/qtdragon_metric.ini",
      .model = ControllerModel::kLinuxcnc,
      .axes = xyz({60, 500, Machine::kNone, 60}),
      .path_feed = 60,
      .block_period = 0.001,
      // What the planner optimises ([TRAJ]ARC_BLEND_OPTIMIZATION_DEPTH); its queue of 2000
      // blocks is never the limit.
      .look_ahead = 50,
      .servo_period = 0.001,
      .blend_tolerance = 0.0127,
      .naive_cam_tolerance = 0.0127};
  m.axis(Axis::kZ) = {40, 500, Machine::kNone, 40};
  return m;
}

Machine fast_linuxcnc() {
  Machine m = linuxcnc();
  m.name = "linuxcnc-fast";
  m.description = "LinuxCNC 2.9, G64 P0.01, 400 mm/s and 4000 mm/s2 on every axis, 1 ms servo";
  m.source =
      "typical of a fast router or engraving machine; the limits under which the model was "
      "compared "
      "with LinuxCNC 2.9 itself";
  m.axes = xyz({400, 4000, Machine::kNone, 400});
  m.path_feed = 400;
  m.blend_tolerance = 0.01;
  m.naive_cam_tolerance = 0.01;
  return m;
}

// What every grbl 1.1 has in common: 16 MHz, and a serial line of 115200 baud, which is 11,520
// bytes a second: X12.345Y-6.789 and its line end take 1.3 ms.
Machine any_grbl() {
  return {.model = ControllerModel::kGrbl,
          .block_period = 0.0013,
          .stream_rate = 11520,
          .look_ahead = 15,      // the ring of 16 holds one block less
          .servo_period = 0.01,  // speeds change in steps of a hundredth of a second
          .junction_deviation = 0.01,
          .arc_tolerance = 0.002,
          .blend_tolerance = 0};
}

// What a new grbl answers to `$$` (DEFAULTS_GENERIC of its defaults.h), as far as time goes.
Machine grbl() {
  Machine m = any_grbl();
  m.name = "grbl";
  m.description = "grbl 1.1 as it comes ($110=500, $120=10): for first steps of any machine";
  m.source = "grbl 1.1, defaults.h, DEFAULTS_GENERIC";
  m.axes = xyz({500 / kMinute, 10, Machine::kNone, 500 / kMinute, 250});
  return m;
}

// A belt-driven hobby router.
Machine router() {
  Machine m = any_grbl();
  m.name = "router";
  m.description = "hobby router, grbl 1.1 at 115200 baud, 5000 mm/min and 400 mm/s2";
  m.source = "grbl 1.1, defaults.h: limits of DEFAULTS_SHAPEOKO_3, $11 and $12 of DEFAULTS_GENERIC";
  m.axes = xyz({5000 * kPerMinute, 400, Machine::kNone, 5000 * kPerMinute, 40});
  return m;
}

// The same for controls that plan with the ends as programmed.
Machine unrounded_router() {
  Machine m = router();
  m.name = "router-unrounded";
  m.description = "as router, for controls that plan with ends that are not rounded to steps";
  m.source = "as router; RepRapFirmware, Smoothieware and g2core plan in millimetres";
  for (AxisLimits& axis : m.axes) axis.steps = Machine::kNone;
  return m;
}

// The same with Klipper, which plans along the path, and a host that reads a file.
Machine klipper_router() {
  Machine m = unrounded_router();
  m.name = "klipper-router";
  m.description = "hobby router, Klipper, 5000 mm/min and 400 mm/s2";
  m.source =
      "limits as router; Klipper's defaults of square_corner_velocity, minimum_cruise_ratio and "
      "resolution; 5000 blocks/s of its host: own choice";
  m.model = ControllerModel::kKlipper;
  m.path_feed = m.max_velocity();
  m.path_acceleration = m.max_acceleration();
  m.block_period = 0.0002;
  m.stream_rate = Machine::kNone;
  m.look_ahead = 1000;  // it sees all that matters
  m.servo_period = 0.001;
  return m;
}

// The same with grblHAL, which plans more blocks.
Machine grblhal_router() {
  Machine m = router();
  m.name = "grblhal-router";
  m.description = "hobby router, grblHAL at 115200 baud, 5000 mm/min and 400 mm/s2";
  m.source = "as router; grblHAL, config.h: 100 planner blocks ($398)";
  m.model = ControllerModel::kGrblhal;
  m.look_ahead = 100;
  return m;
}

// The same with Marlin, which has its own rules for joints and arcs.
Machine marlin_router() {
  Machine m = router();
  m.name = "marlin-router";
  m.description = "hobby router, Marlin 2, 5000 mm/min and 400 mm/s2";
  m.source = "limits as router; Marlin's defaults of JUNCTION_DEVIATION_MM and BLOCK_BUFFER_SIZE";
  m.model = ControllerModel::kMarlin;
  m.junction_deviation = 0.013;
  return m;
}

// A machining centre with an industrial control of which nothing else is known; 6 s from chip to
// chip with a carousel.
Machine mill() {
  return {.name = "mill",
          .description = "machining centre, 20 m/min and 2000 mm/s2 on every axis, 500 blocks/s",
          .source =
              "typical of the class: what makers name for mid-range machining centres and "
              "controls (20 m/min, 500 blocks/s, 200 blocks ahead); not one machine",
          .axes = xyz({20000 * kPerMinute, 2000, Machine::kNone, 20000 * kPerMinute}),
          .block_period = 0.002,
          .look_ahead = 200,
          .blend_tolerance = 0,
          .tool_change_time = 6,
          .spindle_start_time = 2};
}

// A high-speed mill for dies.
Machine high_speed_mill() {
  return {.name = "high-speed",
          .description = "high-speed mill, 40 m/min, 10 m/s2, jerk 100 m/s3, 2000 blocks/s",
          .source =
              "0.5 ms a block and 1024 blocks ahead: Heidenhain on its iTNC 530; limits "
              "typical of the class: what makers name for such mills; not one machine",
          .axes = xyz({40000 * kPerMinute, 10000, 100000, 60000 * kPerMinute}),
          .block_period = 0.0005,
          .look_ahead = 1024,
          .servo_period = 0.0005,
          .blend_tolerance = 0.01,
          .tool_change_time = 4,
          .spindle_start_time = 1.5};
}

// A control of the nineties that was fast then: it sees 20 blocks and brakes for what may follow.
Machine old_mill() {
  return {.name = "old-mill",
          .description = "old shop control, 10 m/min, 1000 mm/s2, 1000 blocks/s, 20 blocks ahead",
          .source = "typical of the class: fast controls of the nineties; not one machine",
          .axes = xyz({10000 * kPerMinute, 1000, Machine::kNone, 15000 * kPerMinute}),
          .block_period = 0.001,
          .look_ahead = 20,
          .servo_period = 0.002,
          .blend_tolerance = 0,
          .tool_change_time = 10,
          .spindle_start_time = 3};
}

}  // namespace

std::span<const Machine> built_in_machines() {
  static const std::array machines = {
      linuxcnc(),       fast_linuxcnc(), router(), grblhal_router(), unrounded_router(),
      klipper_router(), marlin_router(), grbl(),   mill(),           high_speed_mill(),
      old_mill()};
  return machines;
}

const Machine* find_machine(std::string_view name) {
  const auto machines = built_in_machines();
  const auto found = std::find_if(machines.begin(), machines.end(),
                                  [&](const Machine& m) { return m.name == name; });
  return found == machines.end() ? nullptr : &*found;
}

}  // namespace batten::postproc
