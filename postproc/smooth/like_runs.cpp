#include "postproc/smooth/like_runs.h"

#include <algorithm>
#include <array>

#include "postproc/smooth/selection/cost.h"

namespace batten::postproc {

void LikeRuns::learn(const std::function<const RunState&(std::size_t)>& state_of,
                     const SmoothOptions& options) {
  if (others.empty()) return;
  double blocks = 0;
  for (const std::size_t i : in_full) {
    const SmoothedRun& smoothed = state_of(i).smoothed;
    record.add(smoothed.facts.scale.original.blocks, outcomes_of(smoothed, options));
    outlook_of_block += outlook_of(smoothed, options);
    blocks += smoothed.facts.scale.original.blocks;
  }
  outlook_of_block.others /= std::max(1.0, blocks);
  record.learn(weights_of(options.prefer).size);
}

std::vector<LikeRuns> like_runs(const std::vector<std::size_t>& runs,
                                const std::function<bool(std::size_t)>& is_of_corners) {
  std::array<std::vector<std::size_t>, 2> alike;
  for (const std::size_t run : runs) alike[is_of_corners(run) ? 1 : 0].push_back(run);
  std::vector<LikeRuns> kinds(alike.size());
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    std::vector<bool> is_full(alike[k].size());
    for (const std::size_t place : runs_in_full(alike[k].size())) is_full[place] = true;
    for (std::size_t i = 0; i < alike[k].size(); ++i) {
      (is_full[i] ? kinds[k].in_full : kinds[k].others).push_back(alike[k][i]);
    }
  }
  return kinds;
}

}  // namespace batten::postproc
