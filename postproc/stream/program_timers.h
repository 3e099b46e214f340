// The time of a whole program as `smooth` tells it, before and after: at its feeds, and at others.
#pragma once

#include <optional>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/text/program.h"
#include "postproc/machine/program_time/program_time.h"
#include "postproc/options/options.h"

namespace batten::postproc {

// Of a whole program, as `batten time` predicts it for the machine: rapids and waits count.
struct TimeFigures {
  double seconds = 0;
  double cutting_s = 0;
  double slow_s = 0;                  // of the cutting time: below half of the programmed feed
  std::vector<double> at_feeds = {};  // seconds at each of SmoothOptions::timed_feeds

  [[nodiscard]] double slow_share() const { return cutting_s > 0 ? slow_s / cutting_s : 0; }
  TimeFigures& operator+=(const TimeFigures& other);  // not at other feeds
};

// Of a program that is read part by part. A copy goes on from there.
class ProgramTimers {
 public:
  // `has_m6`: see StepOptions.
  ProgramTimers(const SmoothOptions& options, std::optional<bool> has_m6);

  void add(const gcode::Program& part, const gcode::Interpretation& meaning);
  [[nodiscard]] TimeFigures finish();  // after the last part

 private:
  std::vector<ProgramTimer> timers_;  // as programmed, and at each of the other feeds
};

[[nodiscard]] TimeFigures time_of(const gcode::Program& program,
                                  const gcode::Interpretation& meaning,
                                  const SmoothOptions& options);

}  // namespace batten::postproc
