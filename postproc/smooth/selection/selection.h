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

// Which methods were tried on a run, and how fast what they made would be cut.

struct MethodTime {
  std::string_view method;
  double time_s = 0;  // of its fastest candidate, as the control is set
};

// In the order in which they were tried.
[[nodiscard]] std::vector<MethodTime> method_times(const SmoothedRun& run);

// Seconds by which the fastest other method is slower than this time; negative where it is
// faster (what was chosen had other merits). 0 where there is no other.
[[nodiscard]] double lead_of(std::string_view method, double time_s,
                             const std::vector<MethodTime>& times);

// What was tried on two neighbouring stretches of a run, when a report tells of them as one.

// What was tried on a stretch of a run.
struct TriedStretch {
  std::vector<MethodTime> methods;
  double time_s = 0;  // as it was
};

// Of two neighbouring stretches as one. A method that was tried on one of them only leaves the
// other as it was.
[[nodiscard]] std::vector<MethodTime> joined_times(const TriedStretch& first,
                                                   const TriedStretch& second);

}  // namespace batten::postproc
