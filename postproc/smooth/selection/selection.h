// Which candidate replaces a run, if any: never one that is worse than the run.
#pragma once

#include <string_view>
#include <vector>

#include "postproc/options/options.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

// Times are estimates, good to about a percent. Multiples and parts, but where units are given.
struct SelectionTuning {
  double same_time = 0.01;  // a difference below this is none ..
  double slower = 0.005;    // .. and half of it speaks against replacing the run
  double same_time_where_far_smaller =
      0.025;                   // just about measurable: worth a quarter of the blocks
  double wanted_costs = 0.15;  // more time, for a form that the user asked for by name
  // Of two equals, one that takes less than this under exact path has fewer kinks, on any control.
  double fewer_kinks = 0.7;
  // A gain is so much less time, so many fewer blocks or bytes, an error so much smaller.
  double less_time = 0.01;
  double less_time_for_more = 0.05;  // where it takes more blocks than before
  double fewer_blocks = 0.9;
  double fewer_bytes = 0.9;
  double nearer = 0.6;
  // Arcs of which no two meet in more than this part of the greatest kink before are a gain, and
  // may be so many more, or one, where that saves time with the feed turned up.
  double smoother = 0.1;
  double more_for_smoother = 0.1;
  double more_blocks = 1.5;  // for who prefers accuracy
  double same_error = 2.5;   // errors within this factor are equal: then the smaller text is better
  double estimate = 1.25;    // so much too high an estimate of blocks may be
};
inline constexpr SelectionTuning kChoice;

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

// What is known of a candidate that is not made.
struct Bound {
  double least_time = 0;  // s: under no setting of the control it takes less
  double error = 0;       // mm, about
  double blocks = 0;      // may be too many by a fifth
  double exact_path = 0;  // s: under exact path no less than this, about
};

// Whether such a candidate could be worth writing. `before` as for `choose`.
[[nodiscard]] bool may_gain(const Bound& bound, const RunFacts& before, std::size_t blocks,
                            Prefer prefer);

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

struct MethodTime {
  std::string_view method;
  double time_s = 0;  // of its fastest candidate, as the control is set
};

// Of the methods in the order in which they were tried.
[[nodiscard]] std::vector<MethodTime> method_times(const SmoothedRun& run);

// Seconds by which the fastest other method is slower than this time; negative where it is faster
// (what was chosen had other merits). 0 where there is no other.
[[nodiscard]] double lead_of(std::string_view method, double time_s,
                             const std::vector<MethodTime>& times);

// What was tried on a section of a run.
struct TriedSection {
  std::vector<MethodTime> methods;
  double time_s = 0;  // as it was
};

// Of two neighbours as one. A method that was tried on one of them only leaves the other as it was.
[[nodiscard]] std::vector<MethodTime> joined_times(const TriedSection& first,
                                                   const TriedSection& second);

}  // namespace batten::postproc
