#include "geometry/fitting/tube/tube_smoothing_knots.h"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace batten::geometry {

namespace {

constexpr std::size_t kTubeDegree = 3;

std::vector<double> halved(const std::vector<double>& knots) {
  std::vector<double> more;
  more.reserve(2 * knots.size());
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (i > 0 && knots[i - 1] < knots[i]) more.push_back(0.5 * (knots[i - 1] + knots[i]));
    more.push_back(knots[i]);
  }
  return more;
}

// The value at three arguments of the symmetric polynomial, affine in each of them, that is the
// curve's where all three are equal (L. Ramshaw 1987).
Point3 blossom(const BsplineCurve& curve, std::size_t span, const double* arguments) {
  const auto& t = curve.basis().knots();
  std::array<Point3, kTubeDegree + 1> d;
  for (std::size_t j = 0; j <= kTubeDegree; ++j)
    d[j] = curve.control_points()[span - kTubeDegree + j];
  for (std::size_t r = 1; r <= kTubeDegree; ++r) {
    for (std::size_t j = kTubeDegree; j >= r; --j) {
      const double low = t[span - kTubeDegree + j];
      const double high = t[span + 1 + j - r];
      const double part = (arguments[r - 1] - low) / (high - low);
      d[j] = (1 - part) * d[j - 1] + part * d[j];
    }
  }
  return d[kTubeDegree];
}

BsplineCurve halved_once(const BsplineCurve& curve) {
  std::vector<double> knots = halved(curve.basis().knots());
  std::vector<Point3> points;
  points.reserve(knots.size() - kTubeDegree - 1);
  for (std::size_t i = 0; i + kTubeDegree + 1 < knots.size(); ++i) {
    // Control point i is the blossom of the knots behind i, on any span that they surround.
    const double inside = 0.5 * (knots[i + 1] + knots[i + 3]);
    points.push_back(blossom(curve, curve.basis().find_span(inside), &knots[i + 1]));
  }
  return {BsplineBasis(static_cast<int>(kTubeDegree), std::move(knots)), std::move(points)};
}

}  // namespace

BsplineCurve with_spans_halved(const BsplineCurve& curve, int times) {
  BsplineCurve made = curve;
  for (int i = 0; i < times; ++i) made = halved_once(made);
  return made;
}

}  // namespace batten::geometry
