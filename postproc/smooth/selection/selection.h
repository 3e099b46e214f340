// Which candidate replaces a run, if any: of all that nothing speaks against, and the blocks as
// they are, the one of the least cost. Method: docs/algorithms/choice.md.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <vector>

#include "postproc/options/options.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

struct Selection {
  std::vector<std::size_t> order;  // indices of the candidates worth writing, the best first
  std::string_view reason;         // why there is none
};

// The reason id; empty for kNone.
[[nodiscard]] std::string_view reason_for(Objection objection);

// Whether a candidate is of the form that the user asked for by name, and the run as it is not:
// then the run is rewritten so, whatever it costs, where any figure gains by it.
[[nodiscard]] bool is_forced(Form form, const RunFacts& facts, const SmoothOptions& options);

// Why such figures are not written in place of the run; empty where they may be. The order among
// those that may is that of their costs, and a candidate more or less changes nothing in it.
[[nodiscard]] std::string_view reason_against(const Figures& figures, Form form,
                                              const RunFacts& facts, const SmoothOptions& options);

// Of all candidates, or without those that have the run, or its vertices, in place of a form.
enum class Among { kAll, kFormsAlone };

[[nodiscard]] Selection choose(const SmoothedRun& run, const SmoothOptions& options,
                               Among among = Among::kAll);

// What the candidates that were made would give under other options, and whether there is anything
// to win. Of several runs: sums.
struct Outlook {
  // For each of all forms, then of all preferences, what it has more than the original: seconds,
  // blocks, squared distance by length (mm^3).
  Eigen::Array<double, 7, 3> others = Eigen::Array<double, 7, 3>::Zero();
  double at_feeds_s = 0;  // the length at the programmed feeds
  int better = 0;         // runs with a candidate that is clearly better in a figure

  Outlook& operator+=(const Outlook& other);
};

// With the form or the preference of such a row.
[[nodiscard]] SmoothOptions other_options(SmoothOptions options, int row);

[[nodiscard]] Outlook outlook_of(const SmoothedRun& run, const SmoothOptions& options);

// What another candidate has to be better than: the best one so far, or the blocks as they are.
struct BestSoFar {
  std::optional<FormKey> key;  // of a candidate
  double cost = 0;             // infinite where a form is forced and there is none of it
};
[[nodiscard]] BestSoFar best_so_far(const SmoothedRun& run, const SmoothOptions& options);
[[nodiscard]] double cost_to_beat(const SmoothedRun& run, const SmoothOptions& options);

// What became of the forms that were made, for like runs.
[[nodiscard]] std::vector<FormRecord::Outcome> outcomes_of(const SmoothedRun& run,
                                                           const SmoothOptions& options);

struct MethodTime {
  std::string_view method;
  double time_s = 0;  // of its fastest candidate, as programmed
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
