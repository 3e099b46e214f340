#include "postproc/stream/program_timers.h"

#include <span>

#include "postproc/machine/program_time/program_time_blocks.h"

namespace batten::postproc {

TimeFigures& TimeFigures::operator+=(const TimeFigures& other) {
  seconds += other.seconds;
  cutting_s += other.cutting_s;
  slow_s += other.slow_s;
  return *this;
}

ProgramTimers::ProgramTimers(const SmoothOptions& options, std::optional<bool> has_m6) {
  StepOptions steps{.dwell_unit = dwell_unit_of(options.target, *options.machine),
                    .has_m6 = has_m6};
  timers_.reserve(1 + options.timed_feeds.size());
  timers_.emplace_back(*options.machine, steps);
  for (const double feed : options.timed_feeds) {
    steps.feed_override = feed;
    timers_.emplace_back(*options.machine, steps);
  }
}

void ProgramTimers::add(const gcode::Program& part, const gcode::Interpretation& meaning) {
  for (ProgramTimer& timer : timers_) timer.add(part, meaning);
}

TimeFigures ProgramTimers::finish() {
  const ProgramTime time = timers_.front().finish();
  TimeFigures figures{time.seconds.sum(), time.seconds.cutting, time.below_half_feed, {}};
  for (ProgramTimer& timer : std::span(timers_).subspan(1)) {
    figures.at_feeds.push_back(timer.finish().seconds.sum());
  }
  return figures;
}

TimeFigures time_of(const gcode::Program& program, const gcode::Interpretation& meaning,
                    const SmoothOptions& options) {
  ProgramTimers timers(options, has_m6(program));
  timers.add(program, meaning);
  return timers.finish();
}

}  // namespace batten::postproc
