// What a feed plan costs: processor time per node on ever longer paths.
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <vector>

#include "geometry/bspline_curve.h"
#include "postproc/machine/feed_plan.h"

namespace {

using batten::geometry::BsplineBasis;
using batten::geometry::BsplineCurve;
using batten::geometry::Point3;
using batten::geometry::Vector3;

// A wavy row in space: bends of all sizes, none too sharp.
BsplineCurve wave(int points) {
  std::vector<Point3> control;
  std::vector<double> knots;
  for (int i = 0; i < points; ++i) {
    control.emplace_back(2.0 * i, 4 * std::sin(0.7 * i) + std::sin(2.3 * i), std::sin(1.1 * i));
    if (i + 2 < points) knots.push_back(i);
  }
  return {BsplineBasis::clamped(3, knots), control};
}

}  // namespace

int main() {
  batten::postproc::KinematicPathLimits limits;
  limits.feed = 100;
  limits.acceleration = Vector3::Constant(3000);
  limits.jerk = Vector3::Constant(50000);
  fmt::print("{:>8} {:>8} {:>9} {:>9} {:>10}\n", "pieces", "nodes", "time s", "ms", "nodes/s");
  for (const int points : {30, 100, 300, 1000, 3000, 10000, 30000}) {
    const BsplineCurve curve = wave(points);
    const std::clock_t start = std::clock();
    const auto plan = batten::postproc::plan_feed(curve, limits);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    fmt::print("{:8} {:8} {:9.4f} {:9.1f} {:10.0f}\n", points - 3, plan.nodes.size(), plan.time,
               1e3 * seconds, static_cast<double>(plan.nodes.size()) / seconds);
  }
}
