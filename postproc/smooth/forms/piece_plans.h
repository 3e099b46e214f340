// The plans of postproc/smooth/forms/output_plan.h for who makes more than one of a curve, and so
// has it in its pieces: `pieces` is all of fair.curve.
#pragma once

#include <optional>

#include "geometry/path/curve_pieces.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/methods/curvature_profile.h"

namespace batten::postproc {

[[nodiscard]] OutputPlan plan_lines(const Run& run, const geometry::SmoothCurve& fair,
                                    const geometry::MarkedPieces& pieces,
                                    const PlanOptions& options);

[[nodiscard]] std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::SmoothCurve& fair,
                                                  const geometry::MarkedPieces& pieces,
                                                  const CurvatureProfile& bends,
                                                  const PlanOptions& options);

}  // namespace batten::postproc
