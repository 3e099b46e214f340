#include "geometry/fitting/bspline_fit.h"

#include <algorithm>

#include "geometry/fitting/bspline_fit_parts.h"

namespace batten::geometry {

BsplineFit fit_bspline(const FitProblem& problem, const FitOptions& options) {
  const PartedFit fit(problem, options);
  BsplineFit result{fit.curve(), fit.ratios(problem.samples), 0};
  for (const double ratio : result.ratios) result.worst_ratio = std::max(result.worst_ratio, ratio);
  return result;
}

}  // namespace batten::geometry
