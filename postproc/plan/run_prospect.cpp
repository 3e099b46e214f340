#include "postproc/plan/run_prospect.h"

#include <algorithm>
#include <cmath>

#include "geometry/fair_measure.h"

namespace batten::postproc {

using geometry::Point3;
using geometry::Vector3;

namespace {

// What a path within `tolerance` of a corner can save by cutting it: a chord across the corner at
// the height h above it is 2 h tan(turn / 4) shorter than the legs. It joins the middles of the
// legs at most.
double saved_at(const Vector3& a, const Vector3& b, double tolerance,
                geometry::ToleranceKind kind) {
  const double turn = std::atan2(a.cross(b).norm(), a.dot(b));
  if (kind == geometry::ToleranceKind::kBand) {
    tolerance /= std::max(std::cos(turn / 2), std::sin(geometry::kSharpestCut / 2));
  }
  const double to_middles = 0.5 * (a.norm() + b.norm() - (a + b).norm());
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
    const double turn = std::atan2(a.cross(b).norm(), a.dot(b));
    if (turn * std::min(a.norm(), b.norm()) / 8 > tolerance) ++coarse;
  }
  return p.size() > 2 ? static_cast<double>(coarse) / static_cast<double>(p.size() - 2) : 0;
}

ExpectedChords::ExpectedChords(const geometry::FairPath& fair) {
  constexpr int kParts = 3;
  geometry::SplineWalk curve(fair.curve.basis().knots(), fair.curve.control_points());
  const std::vector<double> breaks = fair.curve.breakpoints();
  steps_.reserve(kParts * breaks.size());
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double step = (breaks[i + 1] - breaks[i]) / kParts;
    for (int k = 0; k < kParts; ++k) {
      // The parameter is about the length.
      steps_.push_back({step, std::sqrt(curve.curvature_at(breaks[i] + (k + 0.5) * step))});
    }
  }
}

double ExpectedChords::within(double deviation, double min_length) const {
  const double per_bend = 1 / std::sqrt(8 * deviation);
  double chords = 0;
  for (const Step& step : steps_) {
    const double per_mm = per_bend * step.bend;
    chords += step.length * (per_mm * min_length > 1 ? std::sqrt(0.5) * per_mm : per_mm);
  }
  return chords;
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
  constexpr std::size_t kMostSearched = 100;
  if (points > kMostSearched) return {Method::kGuo};
  return {Method::kGuo, Method::kOzcan, Method::kRacing};
}

}  // namespace batten::postproc
