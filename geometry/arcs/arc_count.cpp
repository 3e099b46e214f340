#include "geometry/arcs/arc_count.h"

#include <algorithm>
#include <cmath>

#include "geometry/arcs/arc_chain.h"
#include "geometry/arcs/arc_fit.h"
#include "geometry/basic/rounding.h"
#include "geometry/path/cubic_polynomial.h"

namespace batten::geometry {

namespace {

constexpr int kParts = 4;  // of each piece, in which bend and rise change evenly

// A place of the curve, seen along an axis.
struct SeenPlace {
  double speed = 0;  // mm across the axis per parameter
  double bend = 0;   // 1/mm, signed
  double slope = 0;  // rise per mm across
};

SeenPlace seen_along(int normal, const Vector3& d1, const Vector3& d2) {
  const int x = (normal + 1) % 3;
  const int y = (normal + 2) % 3;
  SeenPlace seen;
  seen.speed = std::hypot(d1[x], d1[y]);
  if (seen.speed <= kSamePlace * d1.norm()) return {};  // along the axis
  seen.bend = (d1[x] * d2[y] - d1[y] * d2[x]) / (seen.speed * seen.speed * seen.speed);
  seen.slope = d1[normal] / seen.speed;
  return seen;
}

// Arcs per mm that hold an even change of the slope: each is off by half of what it changes along
// the arc, and may be by slope_error and by what rounding its ends allows, 2 grid / length.
double arcs_by_slope(double change_per_mm, double grid) {
  const double allowed = 2 * kArcChainTuning.slope_error;
  const double by_grid = 4 * grid;
  if (!(by_grid * change_per_mm > kSamePlace * allowed * allowed)) return change_per_mm / allowed;
  return (std::sqrt(allowed * allowed + 4 * by_grid * change_per_mm) - allowed) / (2 * by_grid);
}

}  // namespace

ArcCount::ArcCount(const CurvePieces& pieces) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const CubicBezier& piece = pieces.piece(i);
    const CubicPolynomial cubic(piece);
    std::array<SeenPlace, 3> before;
    for (int k = 0; k <= kParts; ++k) {
      const double t = static_cast<double>(k) / kParts;
      const Vector3 d1 = cubic.first(t);
      const Vector3 d2 = cubic.second(t);
      for (int normal = 0; normal < 3; ++normal) {
        const SeenPlace here = seen_along(normal, d1, d2);
        if (k > 0) {
          const SeenPlace& last = before[normal];
          const double length = 0.5 * (last.speed + here.speed) / kParts;
          parts_[normal].push_back(
              {length, std::abs(here.bend - last.bend), std::abs(here.slope - last.slope)});
        }
        before[normal] = here;
      }
    }
    for (const Point3& control : piece.control) {
      for (int normal = 0; normal < 3; ++normal) {
        const double height = control[normal] - pieces.piece(0).control[0][normal];
        if (std::abs(height) > kArcFitTuning.one_height) rises_[normal] = true;
      }
    }
  }
}

double ArcCount::within(double deviation, double grid, int normal) const {
  const double across = deviation * (rises_[normal] ? kArcFitTuning.plane_share : 1);
  double arcs = 0;
  for (const Part& part : parts_[normal]) {
    if (!(part.length > 0)) continue;
    double per_mm = std::cbrt(part.bend_change / part.length / (kArcChainTuning.best_arc * across));
    if (rises_[normal])
      per_mm = std::max(per_mm, arcs_by_slope(part.slope_change / part.length, grid));
    arcs += part.length * per_mm;
  }
  return arcs;
}

}  // namespace batten::geometry
