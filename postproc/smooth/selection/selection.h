// Which candidate replaces a run, if any: never one that is worse than what stood there.
#pragma once

#include <string_view>
#include <vector>

#include "postproc/options/options.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

struct Selection {
  std::vector<std::size_t> order;  // indices of the candidates worth writing, the best first
  std::string_view reason;         // why there is none
};

// Whether `now` is more than the error of the estimate above `before`. `much_better`: in a quarter
// of the blocks, or without the kinks that there were and in no more blocks. `wanted`: the user
// asked for the form by name, which may cost something.
[[nodiscard]] bool slower(const Times& now, const Times& before, bool much_better, bool wanted);

// So few blocks that they are worth a little time.
[[nodiscard]] bool far_smaller(std::size_t blocks, std::size_t others);

// Whether the choice looks at Times::exact_path of candidates that are equal otherwise.
[[nodiscard]] bool compares_kinks(const SmoothOptions& options);

// Whether nothing that takes `least_time` (s) or more could be better for having fewer kinks.
[[nodiscard]] bool keeps_speed(const Times& times, double least_time);

// What is known of a candidate before it is made. `blocks` may be too many by a fifth, `least_time`
// is a bound for every way in which the control may be set.
struct Prospect {
  double least_time = 0;  // s
  double blocks = 0;
  double error = 0;  // mm
};

// Whether such a candidate could be worth writing. `before` as for `choose`.
[[nodiscard]] bool may_gain(const Prospect& prospect, const RunFacts& before, std::size_t blocks,
                            Prefer prefer);

// What is known of another candidate that is not made.
struct Bound {
  double least_time = 0;  // s: no way in which the control may be set takes it less
  double error = 0;       // mm, about
  double blocks = 0;      // may be too many by a fifth
  double exact_path = 0;  // s: under exact path no less than this, about
};

// Whether `choose` prefers the candidate to such another one, whatever its time is.
[[nodiscard]] bool beats(const Candidate& candidate, const Bound& bound, const SmoothedRun& run,
                         const RunContext& context, const SmoothOptions& options);

// As many moves as a run of so many blocks may get for accuracy.
[[nodiscard]] std::size_t most_moves_for_accuracy(std::size_t blocks);

// A candidate is worth writing when it is not slower and gains time, blocks or accuracy by a
// margin. Between candidates `prefer` decides. A form that the user asked for by name may be
// somewhat slower.
[[nodiscard]] Selection choose(const SmoothedRun& run, const RunContext& context,
                               const SmoothOptions& options);

}  // namespace batten::postproc
