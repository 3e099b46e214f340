#include "geometry/fitting/tube/tube_smoothing_solver.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/fitting/band_curve.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/parameter_samples.h"

namespace batten::geometry {

namespace {

// Places per span where the band is watched. What is missed between them, under a percent, is
// taken back by pulled_inside.
constexpr int kWatchedInTube = 6;

// Energies need not be nearer to the least than what is taken back.
constexpr double kGap = 1e-3;

// The bound on a displacement may be this part of the radius too high.
constexpr double kSlack = 1e-4;

std::vector<HeldPoint> held_ends(const BsplineCurve& curve, int held_points) {
  const auto& points = curve.control_points();
  const std::size_t last = points.size() - 1;
  if (held_points == 0) {
    return {HeldPoint::on_plane(0, points[0], curve.direction_at(curve.first())),
            HeldPoint::on_plane(last, points[last], curve.direction_at(curve.last()))};
  }
  std::vector<HeldPoint> held;
  const std::size_t most = std::min<std::size_t>(held_points, points.size() / 2);
  for (std::size_t i = 0; i < most; ++i) {
    held.push_back(HeldPoint::at(i, points[i]));
    held.push_back(HeldPoint::at(last - i, points[last - i]));
  }
  return held;
}

std::vector<BandSample> tube_samples(const BsplineCurve& curve, double radius) {
  std::vector<BandSample> samples;
  for (const ParameterSample& place : parameter_samples(curve, kWatchedInTube)) {
    BandSample sample;
    sample.parameter = place.parameter;
    sample.foot = curve.point_at(place.parameter);
    sample.radius = radius;
    samples.push_back(sample);
  }
  return samples;
}

BsplineCurve part_of_the_way(const BsplineCurve& from, const BsplineCurve& to, double part) {
  std::vector<Point3> points = from.control_points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] += part * (to.control_points()[i] - points[i]);
  }
  return {from.basis(), std::move(points)};
}

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

TubeSolver::TubeSolver(const BsplineCurve& curve, const TubeOptions& options)
    : original_(curve), radius_(options.radius), problem_{curve.basis(), 3, {}, {}, {}} {
  problem_.samples = tube_samples(curve, options.radius);
  problem_.held = held_ends(curve, options.held_points);
}

BsplineCurve TubeSolver::least(int energy, std::function<EnergyWeight(double)> weight) {
  problem_.energy = energy;
  problem_.weight = std::move(weight);
  BarrierOptions options;
  options.gap = kGap;
  return pulled_inside(solve_band(problem_, original_.control_points(), options).curve);
}

double TubeSolver::displacement(const BsplineCurve& moved) const {
  std::vector<Point3> moves = moved.control_points();
  for (std::size_t i = 0; i < moves.size(); ++i) moves[i] -= original_.control_points()[i];
  const auto bounds =
      displacement_bounds(BsplineCurve(original_.basis(), std::move(moves)), kSlack * radius_);
  return *std::max_element(bounds.begin(), bounds.end());
}

BsplineCurve TubeSolver::pulled_inside(const BsplineCurve& moved) const {
  const double far = displacement(moved);
  if (far <= radius_) return moved;
  // The bound of the shorter displacement is rounded again: a slack less is surely enough.
  return part_of_the_way(original_, moved, radius_ * (1 - kSlack) / far);
}

}  // namespace batten::geometry
