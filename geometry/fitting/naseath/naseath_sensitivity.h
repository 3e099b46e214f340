// How much of a control point's move the curve follows. (Naseath 2007, chapter 3;
// docs/algorithms/naseath.md, step 4.)
#pragma once

#include <vector>

#include "geometry/path/bspline_basis.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// The parameter at which a control point acts most, one per point: the middle knot of the five
// of its function; beside the ends of a clamped curve, where that is the end itself, the middle
// of the first (last) span. Requires degree 3; `points` is the number of distinct points, three
// less than basis.size() on a ring.
[[nodiscard]] std::vector<double> parameters_of_influence(const BsplineBasis& basis,
                                                          std::size_t points);

// |D(t_i)| / move_i per point, where D is the spline of the moves as they were made and move_i
// (mm) the nominal size of one, counted even if its direction was null. Where the quotient is
// nothing, 1. Points with move_i = 0 keep their entry of `before`.
[[nodiscard]] std::vector<double> naseath_sensitivities(const BsplineCurve& moves,
                                                        const std::vector<double>& parameters,
                                                        const std::vector<double>& nominal,
                                                        const std::vector<double>& before);

}  // namespace batten::geometry
