#include "postproc/smooth/selection/run_bound.h"

#include <algorithm>
#include <cmath>

namespace batten::postproc {

using geometry::Point3;
using geometry::Vector3;

namespace {

// What a path within `tolerance` of a corner can save by cutting it: a chord across the corner at
// the height h above it is 2 h tan(turn / 4) shorter than the legs. It joins the middles of the
// legs at most.
double saved_at(const Vector3& a, const Vector3& b, double tolerance,
                geometry::ToleranceKind kind) {
  const double to_middles = 0.5 * (a.norm() + b.norm() - (a + b).norm());
  const double across = a.cross(b).norm();
  // A sine is less than its turn, and a tangent greater.
  const double sine = across / (a.norm() * b.norm());
  if (to_middles <= tolerance * sine / 2) return to_middles;
  const double turn = std::atan2(across, a.dot(b));
  if (kind == geometry::ToleranceKind::kBand) {
    tolerance /= std::max(std::cos(turn / 2), std::sin(geometry::kSharpestCut / 2));
  }
  return std::min(to_middles, 2 * tolerance * std::tan(turn / 4));
}

}  // namespace

double least_time(const Run& run, double tolerance, const Machine& machine,
                  geometry::ToleranceKind kind) {
  const auto& p = run.points;
  double time = 0;
  std::size_t next = 0;
  double speed = machine.max_velocity();
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    while (next < run.feeds.size() && run.feeds[next].vertex <= i) {
      speed = std::min(run.feeds[next++].feed / 60, machine.max_velocity());
    }
    double length = (p[i + 1] - p[i]).norm();
    if (i > 0) length -= saved_at(p[i] - p[i - 1], p[i + 1] - p[i], tolerance, kind);
    time += length / speed;
  }
  return time;
}

double coarse_part(const Run& run, double tolerance) {
  const auto& p = run.points;
  std::size_t coarse = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Vector3 a = p[i] - p[i - 1];
    const Vector3 b = p[i + 1] - p[i];
    const double across = a.cross(b).norm();
    const auto [shorter, longer] = std::minmax({a.norm(), b.norm()});
    // A turn of less than a right angle is less than 1.6 of its sine.
    if (a.dot(b) > 0 && 1.6 * across / 8 <= tolerance * longer) continue;
    if (std::atan2(across, a.dot(b)) * shorter / 8 > tolerance) ++coarse;
  }
  return p.size() > 2 ? static_cast<double>(coarse) / static_cast<double>(p.size() - 2) : 0;
}

double arcs_for(const geometry::MarkedPieces& curve) {
  return 3.0 * static_cast<double>(curve.straight_runs.size());
}

std::vector<Method> methods_worth_trying(double corners, std::size_t points, double least_time,
                                         double time) {
  // A run of corners: most of its vertices are coarser than any curve through them.
  constexpr double kCorners = 0.5;
  // The least that there must be left to win.
  constexpr double kWorthTrying = 0.02;
  if (corners < kCorners || least_time > (1 - kWorthTrying) * time) return {};
  // A racing line and the eight points are searches of their own for each corner.
  constexpr std::size_t kMostSearched = 50;
  if (points > kMostSearched) return {Method::kGuo};
  return {Method::kGuo, Method::kOzcan, Method::kTimeOptimal};
}

}  // namespace batten::postproc
