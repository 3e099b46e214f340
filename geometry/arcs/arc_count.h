// How many arcs a curve takes at least, about: from how its bend and its rise change, known before
// an arc is made. The chains that are found have some 1.2 times as many. Method:
// docs/algorithms/arc_fit.md, section How many arcs.
#pragma once

#include <array>
#include <vector>

#include "geometry/path/curve_pieces.h"

namespace batten::geometry {

class ArcCount {
 public:
  // Linear cost.
  explicit ArcCount(const CurvePieces& pieces);

  // Arcs about the coordinate axis `normal` (0: X ..) that stay within `deviation` (mm) of the
  // curve, with ends on multiples of `grid` (mm). A curve that rises along the axis takes helices.
  [[nodiscard]] double within(double deviation, double grid, int normal) const;

 private:
  struct Part {
    double length;        // mm across the axis
    double bend_change;   // 1/mm
    double slope_change;  // mm per mm
  };
  std::array<std::vector<Part>, 3> parts_;  // seen along each axis
  std::array<bool, 3> rises_{};
};

}  // namespace batten::geometry
