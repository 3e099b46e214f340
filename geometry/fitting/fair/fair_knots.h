// The knots that a fair curve starts with. Method: docs/algorithms/fair.md, section Band.
#pragma once

#include <vector>

#include "geometry/fitting/fit_problem.h"

namespace batten::geometry {

// The knots wished for along the path, in order but for some, and about its corners: in order, none
// inside a zone of `problem`, outside `path` or nearer than `closest` (mm) to the one before. Pins
// and ends of zones stay, and take the place of knots nearer than that.
[[nodiscard]] std::vector<double> knots_of(std::vector<double> along,
                                           std::vector<double> about_corners,
                                           const FitProblem& problem, const ParameterRange& path,
                                           double closest);

}  // namespace batten::geometry
