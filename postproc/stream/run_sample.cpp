#include "postproc/stream/run_sample.h"

#include <algorithm>
#include <numeric>

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

}  // namespace batten::postproc
