// The plans of postproc/plan/output_plan.h for who makes more than one of a curve, and so has it in
// its pieces: `pieces` is all of fair.curve.
#pragma once

#include <optional>

#include "geometry/curve_pieces.h"
#include "postproc/plan/curve_bends.h"
#include "postproc/plan/output_plan.h"

namespace batten::postproc {

[[nodiscard]] OutputPlan plan_lines(const Run& run, const geometry::FairPath& fair,
                                    const geometry::MarkedPieces& pieces,
                                    const PlanOptions& options);

[[nodiscard]] std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::FairPath& fair,
                                                  const geometry::MarkedPieces& pieces,
                                                  const CurveBends& bends,
                                                  const PlanOptions& options);

}  // namespace batten::postproc
