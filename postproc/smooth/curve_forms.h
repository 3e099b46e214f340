// The forms in which one curve could replace its run, made as far as they may be the best: curves
// of the target, arcs and lines (postproc/smooth/form_offers.h), with the run where one is slower.
#pragma once

#include <optional>
#include <span>

#include "postproc/smooth/form_offers.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/selection/candidate.h"
#include "postproc/smooth/selection/run_times.h"

namespace batten::postproc {

// The candidate's method and curvature are left to who knows them. Nothing where the target cannot
// say the plan, or there are not enough block numbers, or one of those that are there has the same
// text.
[[nodiscard]] std::optional<Candidate> make_candidate(const RunTask& task, const RunTimes& times,
                                                      const OutputPlan& plan, const RunFacts& facts,
                                                      std::span<const Candidate> there = {});

// Adds candidates to `result`, and what it says of those that were not made.
void add_forms(const FormSetting& setting, const CurveOfRun& curve, SmoothedRun& result);

// The same of lines between the run's own vertices, moved to `curve`.
void add_vertices(const FormSetting& setting, const CurveOfRun& curve, SmoothedRun& result);

}  // namespace batten::postproc
