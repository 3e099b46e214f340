// A program's motion in time: where the tool is every millisecond, as the control's model says or
// by a plan.
#pragma once

#include <cstdint>
#include <functional>

#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/planned_chain.h"
#include "postproc/machine/program_time/program_time_steps.h"

namespace batten::postproc {

// Differences of the places, as a drive sees them: over the period that ends at the sample. The
// first samples after a jump (the start of the program, a place that was not known) are at rest.
struct ProfileSample {
  double time = 0;                                             // s
  std::uint32_t line = 0;                                      // of the block that runs
  geometry::Point3 place;                                      // mm
  double feed = 0;                                             // mm/min along the path
  geometry::Vector3 acceleration = geometry::Vector3::Zero();  // mm/s^2 of each axis
  geometry::Vector3 jerk = geometry::Vector3::Zero();          // mm/s^3 of each axis
};

// Calls `use` every `period` seconds from 0 on; the last sample is the first one at or after
// the end. Stops where `use` says false, and returns false then. Samples are not kept.
//
// The places are those of the programmed path and of the bends that the control puts into its
// corners; where a control cuts arcs into chords, those of the chords. By a plan all are on the
// programmed path.
[[nodiscard]] bool sample_program(const ProgramSteps& steps, const Machine& machine, double period,
                                  const std::function<bool(const ProfileSample&)>& use,
                                  FeedPlanner planner = FeedPlanner::kControl);

}  // namespace batten::postproc
