// How long a whole program takes on a machine, and where the time goes.
// Method: docs/algorithms/cycle_time.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/planned_chain.h"
#include "postproc/machine/program_time/program_time_steps.h"

namespace batten::postproc {

// Seconds by what the machine does. Their sum is the whole time.
struct TimeParts {
  double cutting = 0;
  double rapids = 0;
  double dwells = 0;
  double tool_changes = 0;
  double spindle = 0;
  double rotary = 0;
  [[nodiscard]] double sum() const {
    return cutting + rapids + dwells + tool_changes + spindle + rotary;
  }
};

// From one tool change to the next; a tool that comes back has all its times in one.
struct ToolTime {
  std::int32_t tool = ProgramStep::kNoTool;
  TimeParts seconds;
};

// Neighbouring cutting blocks that run below half of their programmed feed.
struct SlowPlace {
  std::uint32_t first_line = 0;
  std::uint32_t last_line = 0;
  double seconds = 0;
  double length_mm = 0;
  double feed = 0;          // mm/min, programmed, the mean over the way
  double seconds_lost = 0;  // more than the programmed feed would take
};

struct StepCounts {
  std::size_t cuts = 0;
  std::size_t rapids = 0;
  std::size_t dwells = 0;
  std::size_t tool_changes = 0;
  std::size_t spindle_starts = 0;
};

struct ProgramTime {
  TimeParts seconds;
  StepCounts counts;
  double cutting_mm = 0;
  double rapid_mm = 0;
  double cutting_at_feed = 0;       // s: the cutting length at the programmed feeds
  double below_half_feed = 0;       // s of the cutting time at less than half the programmed feed
  std::vector<ToolTime> tools;      // in the order in which they come
  std::vector<SlowPlace> slowest;   // most seconds lost first
  std::vector<NotTimed> not_timed;  // what is left out or assumed
};

// Linear cost. Throws as cutting_time does for a machine without limits. `planner`: what moves the
// axes.
[[nodiscard]] ProgramTime time_program(const gcode::Program& program,
                                       const gcode::Interpretation& meaning, const Machine& machine,
                                       const StepOptions& options,
                                       FeedPlanner planner = FeedPlanner::kControl);

// The same for a program that is read part by part; see StepReader. Holds some thousand steps. A
// copy goes on from there.
class ProgramTimer {
 public:
  ProgramTimer(const Machine& machine, const StepOptions& options,
               FeedPlanner planner = FeedPlanner::kControl);
  ProgramTimer(const ProgramTimer& other);
  ProgramTimer& operator=(const ProgramTimer&) = delete;
  ~ProgramTimer();

  void add(const gcode::Program& part, const gcode::Interpretation& meaning);
  [[nodiscard]] ProgramTime finish();  // after the last part

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace batten::postproc
