// The forms in which one curve could replace its run: curves of the target, few arcs and near ones,
// coarse lines and fine ones. Made are those that may be chosen.
#pragma once

#include <optional>

#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/methods/run_curve.h"
#include "postproc/smooth/selection/candidate.h"
#include "postproc/smooth/selection/candidate_bounds.h"
#include "postproc/smooth/selection/run_times.h"

namespace batten::postproc {

// Multiples of the form's share of the tolerance that a form may be from the curve, however little
// the curve used. Long chords are few, fine ones are near to the curve and keep the speed on a
// control that rounds each of their corners.
struct FormTuning {
  double arcs = 1.5;        // and curves
  double fine_arcs = 0.25;  // the same
  double chords[3] = {1.5, 0.6, 0.25};
  double another = 0.9;               // of the chords before, at most, or chords are those again
  double bands[3] = {1, 0.97, 0.94};  // parts of the band around arcs in which few are looked for
};
inline constexpr FormTuning kFormTuning;

// `old`: what the run takes. The candidate's method, error and curvature are left to who knows
// them. Nothing where the target cannot say the plan, or there are not enough block numbers.
[[nodiscard]] std::optional<Candidate> make_candidate(const RunTask& task, const RunTimes& times,
                                                      const OutputPlan& plan, const Times& old);

struct CurveOfRun {
  const RunCurve& curve;
  const CurvatureProfile& bends;
  double share = 0;  // mm, of the tolerance: the form's
  double left = 0;   // mm, what the curve leaves of the tolerance
};

// Adds candidates to `result`, and what it says of those that were not made.
void add_forms(const RunTask& task, const RunTimes& times, const CandidateBounds& bounds,
               const CurveOfRun& curve, SmoothedRun& result);

}  // namespace batten::postproc
