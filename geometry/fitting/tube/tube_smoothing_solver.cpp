#include "geometry/fitting/tube/tube_smoothing_solver.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "geometry/path/displacement.h"
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

}  // namespace

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
