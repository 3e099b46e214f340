#include "postproc/stream/time_bounds.h"

#include <algorithm>
#include <functional>
#include <variant>
#include <vector>

#include "gcode/state/reason.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/selection/candidate_bounds.h"
#include "postproc/smooth/selection/run_times.h"

namespace batten::postproc {

namespace {

// A control that joins lines runs faster than each of them allows, and one that blends corners cuts
// them: then less is known.
double least_below(double time, const Run& run, double tolerance, const Machine& machine,
                   const gcode::PathControl& path) {
  const auto kind = geometry::ToleranceKind::kPath;
  const double least = least_time(run, tolerance, machine, path, kind);
  if (least <= time) return least;
  return std::min(time, least_time(run, tolerance, machine, path, kind, LimitsOf::kAnyDirection));
}

BoundedTime bounded(const Run& run, const gcode::PathControl& path, const Machine& machine,
                    std::optional<double> tolerance_mm) {
  BoundedTime bounded;
  bounded.time = times_of(timed_pieces(run, 0, run.points.size() - 1), machine, path).programmed;
  bounded.least_on_path = least_below(bounded.time, run, 0, machine, path);
  if (tolerance_mm) {
    bounded.least_within = std::min(bounded.least_on_path,
                                    least_below(bounded.time, run, *tolerance_mm, machine, path));
  }
  return bounded;
}

}  // namespace

TimeBounds time_bounds(const gcode::Program& program, const gcode::Interpretation& meaning,
                       const Machine& machine, std::optional<double> tolerance_mm) {
  TimeBounds bounds;
  bounds.tolerance_mm = tolerance_mm;
  if (tolerance_mm) bounds.seconds.least_within = 0;
  GroupingOptions grouping;
  grouping.tolerance_mm = tolerance_mm.value_or(grouping.tolerance_mm);
  const std::vector<Section> sections = group_runs(program, meaning, grouping);
  for (const Section& section : sections) {
    const Run* run = std::get_if<Run>(&section.content);
    if (run == nullptr) continue;
    const std::uint32_t state = meaning.blocks[section.first_block].state_after;
    const BoundedTime seconds = bounded(*run, meaning.states[state].path, machine, tolerance_mm);
    bounds.seconds.time += seconds.time;
    bounds.seconds.least_on_path += seconds.least_on_path;
    if (tolerance_mm) *bounds.seconds.least_within += *seconds.least_within;
    bounds.runs.push_back({program.blocks[section.first_block].line,
                           program.blocks[section.last_block].line, seconds});
  }
  CauseTally tally;
  tally.add(program, meaning, sections, grouping);
  for (const KeptCause& cause : tally.causes().causes) {
    if (cause.reason == gcode::reason::kExactStop) bounds.exact_stop = cause;
  }
  std::ranges::stable_sort(bounds.runs, std::greater<>(), [](const RunBound& run) {
    return run.seconds.time - run.seconds.least();
  });
  return bounds;
}

}  // namespace batten::postproc
