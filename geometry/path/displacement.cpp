#include "geometry/path/displacement.h"

#include <algorithm>

#include "geometry/path/bezier_halves.h"

namespace batten::geometry {

namespace {

// A half is nearer to its polygon by a quarter, so twenty halvings take a millimetre to 1e-12 mm.
constexpr int kMostHalvings = 20;

double farthest_control(const CubicBezier& piece) {
  double most = 0;
  for (const Point3& p : piece.control) most = std::max(most, p.norm());
  return most;
}

// `reached` is the greatest |displacement| met so far in the span. The span's maximum is above
// it or on it, so a piece whose bound is less than `slack` above it need not be looked at.
double bound_of(const CubicBezier& piece, double slack, int halvings, double& reached) {
  reached = std::max({reached, piece.control[0].norm(), piece.control[3].norm()});
  const double bound = farthest_control(piece);
  if (bound <= reached + slack || halvings == 0) return bound;
  const auto [left, right] = halves(piece);
  return std::max(bound_of(left, slack, halvings - 1, reached),
                  bound_of(right, slack, halvings - 1, reached));
}

}  // namespace

std::vector<double> displacement_bounds(const BsplineCurve& displacement, double slack) {
  std::vector<double> bounds;
  for (const CubicBezier& piece : displacement.bezier_pieces()) {
    double reached = 0;
    bounds.push_back(bound_of(piece, slack, kMostHalvings, reached));
  }
  return bounds;
}

}  // namespace batten::geometry
