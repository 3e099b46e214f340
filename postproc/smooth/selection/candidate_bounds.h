// What is known of a run's forms before they are made: whether one could gain anything, and whether
// what has been made would be chosen whatever it takes. What is said to be hopeless would have been
// kept after all, as `choose` decides; what is not may still be kept.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/path/curve_pieces.h"
#include "postproc/machine/machine.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/methods/run_curve.h"
#include "postproc/smooth/selection/candidate.h"
#include "postproc/smooth/selection/run_times.h"

namespace batten::postproc {

struct BoundTuning {
  double coarse =
      0.5;  // part of the vertices: of a run with so many coarse ones only corners are left
  // Of their scatter: the fair curve of scattered vertices is no better known, so that a form that
  // is nearer to it is not nearer to the path that was meant.
  double known = 0.5;
  double even_less = 1.1;          // times fewer kinks than finer chords should have: chords differ
  double corners = 0.5;            // part of the vertices that makes a run one of corners
  double worth_trying = 0.02;      // part of the time: the least that there must be left to win
  std::size_t most_searched = 50;  // points: time-optimal and eight-point corners are searches each
};
inline constexpr BoundTuning kBounds;

struct LinesAhead {
  const CurvatureProfile& bends;  // of the curve
  double deviation = 0;           // mm: no further from it
};

class CandidateBounds {
 public:
  // All must live as long. `so_far`: what is known of the run and has been made, its facts' times
  // at least.
  CandidateBounds(const RunTask& task, const RunTimes& times, const SmoothedRun& so_far);

  [[nodiscard]] const RunFacts& facts() const { return so_far_.facts; }

  // s, as the function of that name below.
  [[nodiscard]] double least_time() const { return least_time_; }

  // s: what the run takes, by which gains are measured. Of a piece: from rest to rest.
  [[nodiscard]] const Times& times_before() const { return before_; }

  // Whether the program's own chords are coarser than the tolerance nearly everywhere: a curve
  // could only round their corners, in more blocks than there are.
  [[nodiscard]] bool is_hopeless() const;

  [[nodiscard]] bool are_hopeless(const LinesAhead& lines) const;

  // Corners between lines, each of which would be more arcs than it has blocks: chords do as well.
  [[nodiscard]] bool arcs_are_hopeless(const geometry::MarkedPieces& curve) const;

  // mm: how near to the path that was meant a form so near to the fair curve can be said to be.
  [[nodiscard]] double known(double error) const;

  // Whether a kink that costs time is none of those in a form that takes this.
  [[nodiscard]] bool keeps_speed(const Times& times) const;

  // Whether the candidate would be chosen rather than any form at this deviation (mm) in so many
  // blocks, whatever it takes.
  [[nodiscard]] bool beats_form(const Candidate& candidate, double deviation, double blocks) const;
  [[nodiscard]] bool beats_lines(const Candidate& candidate, const LinesAhead& lines) const;

  // Whether lines that are this far from the curve would be chosen rather than finer ones.
  [[nodiscard]] bool beats_finer(const Candidate& lines, double deviation,
                                 const LinesAhead& finer) const;

 private:
  [[nodiscard]] double blocks_of(const LinesAhead& lines) const;
  [[nodiscard]] double least_time_at_rest() const;
  [[nodiscard]] RunFacts facts_before() const;

  const RunTask& task_;
  const RunTimes& times_;
  const SmoothedRun& so_far_;
  double least_time_;
  Times before_;
};

// Seconds below which no form of the run comes that stays within `tolerance`: its length at its
// feeds, less what can be saved at its vertices, when there were no accelerations to mind.
[[nodiscard]] double least_time(const Run& run, double tolerance, const Machine& machine,
                                geometry::ToleranceKind kind = geometry::ToleranceKind::kPath);

// The part of the run's vertices whose chords would leave a curve through them by more than
// `tolerance`: a run of a coarser one, of which only the corners could be rounded.
[[nodiscard]] double coarse_part(const Run& run, double tolerance);

// The methods beside `fair` that may win on a run, for Method::kBest. `corners` is coarse_part of
// it, `points` how many it has, `time` (s) what its fastest form so far takes on the machine.
// docs/algorithms/methods.md says why these.
[[nodiscard]] std::vector<Method> methods_worth_trying(double corners, std::size_t points,
                                                       double least_time, double time);

}  // namespace batten::postproc
