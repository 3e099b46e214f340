#include "postproc/stream/run_sample.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>
#include <variant>

#include "postproc/runs/run_path.h"
#include "postproc/smooth/selection/candidate_bounds.h"

namespace batten::postproc {

std::vector<SampledRun> sample_of(std::span<const std::size_t> moves) {
  const std::size_t places = std::max(kRunSample.least, moves.size() / kRunSample.one_of);
  std::vector<SampledRun> sample;
  if (moves.size() <= places) {
    for (std::size_t i = 0; i < moves.size(); ++i) sample.push_back({i, 1});
    return sample;
  }
  const auto all = static_cast<double>(std::accumulate(moves.begin(), moves.end(), std::size_t{0}));
  const double longest = all / static_cast<double>(places);
  const auto is_long = [&](std::size_t run) { return static_cast<double>(run) >= longest; };
  const auto long_runs = static_cast<std::size_t>(std::ranges::count_if(moves, is_long));
  double short_moves = 0;
  for (const std::size_t run : moves) short_moves += is_long(run) ? 0 : static_cast<double>(run);
  const double step = short_moves / static_cast<double>(places - std::min(long_runs, places - 1));
  double next = step / 2;  // place, in moves of the short runs
  double passed = 0;
  double represented = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const auto own = static_cast<double>(moves[i]);
    if (is_long(moves[i])) {
      sample.push_back({i, 1});
      continue;
    }
    passed += own;
    if (passed <= next) continue;
    while (next < passed) next += step;
    sample.push_back({i, std::max(1.0, step / own)});
    represented += sample.back().stands_for * own;
  }
  for (SampledRun& run : sample) {
    if (!is_long(moves[run.run])) run.stands_for *= short_moves / represented;
  }
  return sample;
}

double PartSample::stands_for(std::uint32_t line) const {
  const auto after = by_line.upper_bound(line);
  return after == by_line.begin() ? 1 : std::prev(after)->second;
}

PartSample sample_of_part(const ProgramPart& part, PartRuns runs, double user_tolerance_mm) {
  const auto run_of = [&](const RunState& work) -> const Run& {
    return std::get<Run>(runs.sections[work.section].content);
  };
  std::vector<std::size_t> order;  // of those that are tried, runs of corners behind the others
  std::vector<bool> is_looked_at(runs.works.size());
  for (std::size_t i = 0; i < runs.works.size(); ++i) {
    is_looked_at[i] = !runs.works[i].selection.reason.empty();
    if (!is_looked_at[i]) order.push_back(i);
  }
  std::ranges::stable_partition(order, [&](std::size_t i) {
    return !is_run_of_corners(run_of(runs.works[i]), user_tolerance_mm);
  });
  std::vector<std::size_t> moves;
  for (const std::size_t i : order) moves.push_back(motion_count(run_of(runs.works[i])));
  PartSample sample;
  for (const SampledRun& sampled : sample_of(moves)) {
    const std::size_t work = order[sampled.run];
    is_looked_at[work] = true;
    const Section& section = runs.sections[runs.works[work].section];
    sample.by_line[part.program.blocks[section.first_block].line] = sampled.stands_for;
  }
  std::vector<RunState> works;
  for (std::size_t i = 0; i < runs.works.size(); ++i) {
    if (is_looked_at[i]) {
      works.push_back(std::move(runs.works[i]));
    } else {
      runs.sections[runs.works[i].section].content = Verbatim{};
    }
  }
  runs.works = std::move(works);
  sample.runs = std::move(runs);
  return sample;
}

}  // namespace batten::postproc
