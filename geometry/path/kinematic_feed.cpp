#include "geometry/path/kinematic_feed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/numeric/extrema.h"
#include "geometry/path/cubic_polynomial.h"
#include "geometry/path/path.h"

namespace batten::geometry {
namespace {

double cubed(double x) { return x * x * x; }

// The cube of 1 / feed at t, (s/mm)^3, so that the jerk's third root is taken once only.
double cubed_slowness(const CubicPolynomial& piece, double t, const KinematicLimits& limits) {
  const Vector3 d1 = piece.first(t);
  if (!(d1.norm() > 0)) return std::numeric_limits<double>::infinity();  // a cusp: no feed at all
  const LengthDerivatives x = by_length(d1, piece.second(t), piece.third());
  const double by_speed = x.first.cwiseAbs().cwiseQuotient(limits.speed).maxCoeff();
  const double by_acceleration = x.second.cwiseAbs().cwiseQuotient(limits.acceleration).maxCoeff();
  const double by_jerk = x.third.cwiseAbs().cwiseQuotient(limits.jerk).maxCoeff();
  return std::max({1 / cubed(limits.feed), cubed(by_speed),
                   by_acceleration * std::sqrt(by_acceleration), by_jerk});
}

// Even places, and more where the parameter runs slowly: there the derivatives by length have
// several peaks, as wide as the way in t on which the speed |C'| doubles.
std::vector<double> sampled_places(const CubicPolynomial& piece) {
  std::vector<double> slow;
  piece.append_speed_extrema(0, slow);
  std::vector<double> places;
  for (const double t : slow) {
    const double turn = piece.second(t).norm();
    const double width = turn > 0 ? piece.first(t).norm() / turn : 1;
    if (width * kPlacesPerSpan > 2) continue;  // even places are close enough
    for (int k = -12; k <= 12; ++k) places.push_back(std::clamp(t + k * width / 4, 0.0, 1.0));
  }
  return with_even_places(std::move(places), 0, 1, kPlacesPerSpan);
}

}  // namespace

// With sigma = |C'| and its derivatives by the parameter.
LengthDerivatives by_length(const Vector3& d1, const Vector3& d2, const Vector3& d3) {
  const double sigma = d1.norm();
  const double sigma1 = d1.dot(d2) / sigma;
  const double sigma2 = (d2.squaredNorm() + d1.dot(d3) - sigma1 * sigma1) / sigma;
  const Vector3 n = sigma * d2 - sigma1 * d1;
  const double cube = cubed(sigma);
  return {d1 / sigma, n / cube,
          ((sigma * d3 - sigma2 * d1) / cube - 3 * sigma1 / (cube * sigma) * n) / sigma};
}

double feed_estimate(const BsplineCurve& curve, const KinematicLimits& limits) {
  double slowest = 1 / cubed(limits.feed);
  for (const CubicBezier& bezier : curve.bezier_pieces()) {
    const CubicPolynomial piece(bezier);
    const auto at = [&](double t) { return cubed_slowness(piece, t, limits); };
    slowest = std::max(slowest, greatest(at, sampled_places(piece), slowest).value);
  }
  return 1 / std::cbrt(slowest);
}

}  // namespace batten::geometry
