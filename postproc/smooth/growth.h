// What a program gains as a whole, and what that costs it.
#pragma once

#include <optional>
#include <vector>

#include "postproc/options/options.h"
#include "postproc/smooth/run_smoother.h"

namespace batten::postproc {

// What is added up over runs, or what one of them has more than before.
struct RunSums {
  double time = 0;  // s, as programmed
  double blocks = 0;
  double bytes = 0;
  double squares = 0;  // mm^3, of the distance from the path that was meant, along the path

  RunSums& add(const RunSums& other, double multiple);
};

struct PartSums {
  double length = 0;  // mm
  RunSums before;
  RunSums change;

  PartSums& operator+=(const PartSums& other);
  [[nodiscard]] bool grow() const;  // in blocks, bytes or distance
};

// Of all runs but those whose form the user asks for by name.
[[nodiscard]] PartSums sums_of(const std::vector<RunState>& works,
                               const std::vector<CutRun>& cut_runs, const SmoothOptions& options);

// Whether so many runs are larger or farther off together, and nothing makes up for it
// (postproc/smooth/selection/cost.h).
[[nodiscard]] bool is_worse(const PartSums& sums, const SmoothOptions& options);

// Runs are chosen one by one, and one that is a percent faster may have more blocks, though it is a
// thousandth of the program. Where all runs together are worse, those that gain the least for what
// they grow change to a candidate that does not, or keep their blocks. All keep them where all
// that is won is less size, in blocks and bytes by halves, than the comment takes that says that
// the program was smoothed, unless a form is asked for by name. `beside`: other runs, which stay as
// they are and have that comment, and are not worse together.
void revert_growth(std::vector<RunState>& works, std::vector<CutRun>& cut_runs,
                   const SmoothOptions& options, const std::optional<PartSums>& beside = {});

}  // namespace batten::postproc
