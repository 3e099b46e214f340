// What is left to win in a program: the least time that its runs could take.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/text/program.h"
#include "postproc/machine/machine.h"
#include "postproc/runs/kept_causes.h"

namespace batten::postproc {

// Seconds from rest to rest.
struct BoundedTime {
  double time = 0;                          // as the machine runs it
  double least_on_path = 0;                 // no feed plan takes less on the path as it is
  std::optional<double> least_within = {};  // no path within the tolerance takes less

  [[nodiscard]] double least() const { return least_within.value_or(least_on_path); }
};

struct RunBound {
  std::uint32_t first_line = 0;
  std::uint32_t last_line = 0;
  BoundedTime seconds;
};

struct TimeBounds {
  std::optional<double> tolerance_mm = {};
  BoundedTime seconds;         // of all runs
  std::vector<RunBound> runs;  // those first in which the most is left
  KeptCause exact_stop;        // moves that are in no run since they end in an exact stop
};

// Of the runs that may be rewritten. The bounds leave out what brakes between the ends of a run
// but for sharp corners (least_time, candidate_bounds.h).
[[nodiscard]] TimeBounds time_bounds(const gcode::Program& program,
                                     const gcode::Interpretation& meaning, const Machine& machine,
                                     std::optional<double> tolerance_mm);

}  // namespace batten::postproc
