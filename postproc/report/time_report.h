// What the reports of `batten time` are made from.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gcode/state/own_words.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/program_time/program_time.h"
#include "postproc/stream/called_files.h"
#include "postproc/stream/time_bounds.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

struct TimeReport {
  const gcode::Program& program;
  const Machine& machine;
  const ProgramTime& time;
  const gcode::Diagnostics& diagnostics;
  const std::shared_ptr<const gcode::OwnWords>& own_words;  // that the user vouches for
  const std::vector<CalledFile>& called;    // programs that it calls, whose time is not in it
  const std::optional<TimeBounds>& bounds;  // where they are asked for
  FeedPlanner planner = FeedPlanner::kControl;
  double feed_override = 1;
};

// For people:
//
//   part.nc on linuxcnc: 12 min 34 s
//     cutting       10 min 02 s  80 %   31.24 m in 15163 moves; 9 min 50 s at the programmed feeds
//     rapids        ...
//     slow          12.3 % of the cutting time is below half of the programmed feed
//     lines 120-180     2.10 s for 12.3 mm, 351 of 2000 mm/min: 1.73 s lost
//     to win        at most 0.31 s of the 10.20 s in runs: ..
//     lines 120-180 ..
//     not timed     3 place-unknown, first in line 45: ...
[[nodiscard]] std::string time_text(const TimeReport& report);

// Seconds, millimetres and mm/min; the fields are named in docs/algorithms/cycle_time.md.
[[nodiscard]] Json time_json(const TimeReport& report);

}  // namespace batten::postproc
