// Where noisy vertices were meant to be, as far as their neighbours tell: an estimate that no
// band holds. Method: docs/algorithms/fair.md, section Noise that takes much of the band.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/fair/path_features.h"

namespace batten::geometry {

struct DenoiseTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  std::size_t fewest = 8;  // vertices of a section [MeantPath.OfFewVerticesIsTheVertices]
  // A vertex that turns by so many times what its noise turns it (standard deviations) was meant
  // to.
  double surely_meant = 4;  // [>]
  // The weight is looked for on so many vertices at the most, from the middle of a section: enough
  // to know it to some percent, and few enough for the search to cost little.
  std::size_t judged = 1000;  // [<]
  // Decades of the weight over the stiffness of the spline that are looked at. At the lower end a
  // wave of a hundred vertices is smoothed away, at the upper one nothing is.
  int lowest_decade = -12;  // [<]
  int highest_decade = 1;
  int closings = 6;  // of the interval around the best decade, by the golden section
  // Where this part of the vertices is further from the denoised path than the limit, noise fills
  // the band: the curve that the others would allow has no room between these.
  double fills_band = 0.125;  // [MeantPath.IsTheVerticesWhereRoundingLeavesRoom]
  // Among so many vertices on either side is that part counted.
  std::size_t around = 40;  // [MeantPath.IsTheVerticesWhereRoundingLeavesRoom]
  // Vertices that scatter by more than this part of the limit, and by more than so many of the
  // greatest rounding errors, are drawn to their denoised positions. A curve that is only expected
  // to leave their scatter leaves some of the path, too, where they are coarse, and would find room
  // for the feed on any side of it.
  double much = 0.08;
  double rounding_noise = 2;
  // Of normal noise an eighth is beyond 1.5 standard deviations, and noise is known to a third.
  double may_fill = 0.4;  // [> MeantPath.IsTheVerticesWhereRoundingLeavesRoom]
};
inline constexpr DenoiseTuning kDenoiseTuning;

// One position per vertex. Between kept corners, corners that no noise explains, and lines, it is
// on the cubic spline with a knot at every vertex that has the least sum of squared distances and
// of energy (the integral of |C'''|^2), the two weighed as generalised cross-validation says. Those
// of one line are on that of least squares. The other vertices that part those sections stay, and
// so do sections of few vertices. Linear time.
//
// `features`: of these points, neighbours apart.
[[nodiscard]] std::vector<Point3> denoised_positions(std::span<const Point3> points,
                                                     const PathFeatures& features);

// The same, but only where noise takes a good part of the `limit` (mm; `rounding` in mm, too).
// Elsewhere, and in sections that a straight line between their ends follows within the limit, a
// vertex keeps its position. Empty where that is so everywhere.
[[nodiscard]] std::vector<Point3> denoised_among_noise(std::span<const Point3> points,
                                                       const PathFeatures& features, double limit,
                                                       double rounding);

}  // namespace batten::geometry
