// Runs that are alike: some of them are smoothed in full, the others in the forms that these show
// to be worth it. Method: docs/algorithms/choice.md, section Runs that are alike.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "postproc/options/options.h"
#include "postproc/smooth/run_smoother.h"
#include "postproc/smooth/selection/form_record.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

// Runs of corners, or others, by the numbers that the caller knows them by.
struct LikeRuns {
  std::vector<std::size_t> in_full = {};
  std::vector<std::size_t> others = {};
  FormRecord record = {};
  Outlook outlook_of_block = {};  // of those in full, on average

  // From those in full, smoothed. Does nothing where there are no others.
  void learn(const std::function<const RunState&(std::size_t)>& state_of,
             const SmoothOptions& options);
};

[[nodiscard]] std::vector<LikeRuns> like_runs(
    const std::vector<std::size_t>& runs, const std::function<bool(std::size_t)>& is_of_corners);

}  // namespace batten::postproc
