#include "postproc/smooth/methods/curve_request.h"

#include <algorithm>
#include <cmath>

#include "geometry/fitting/one_sided/one_sided_fair.h"

namespace batten::postproc {

using geometry::Point3;
using geometry::SmoothCurve;

double greatest_feed(const Run& run) {
  double feed = 0;
  for (const FeedFrom& from : run.feeds) feed = std::max(feed, from.feed);
  return feed;
}

geometry::KinematicLimits limits_of(const Machine& machine, double feed) {
  geometry::KinematicLimits limits;
  limits.feed = std::min(feed / 60, machine.max_velocity());
  limits.speed.setConstant(machine.max_velocity());
  limits.acceleration.setConstant(machine.max_acceleration());
  limits.jerk.setConstant(std::numeric_limits<double>::infinity());
  return limits;
}

KinematicPathLimits plan_limits(const CurveRequest& request) {
  KinematicPathLimits limits(request.limits);
  limits.jerk = limits.jerk.cwiseMin(request.jerk);
  return limits;
}

bool can_race(const geometry::KinematicLimits& limits) {
  const auto given = limits.acceleration.array().isFinite() || limits.jerk.array().isFinite();
  return given.all() && std::isfinite(limits.feed) && limits.feed > 0;
}

std::optional<SmoothCurve> fair_curve(std::span<const Point3> run, const CurveRequest& request) {
  geometry::FairOptions options;
  options.tolerance = request.tolerance;
  options.rounding = request.rounding;
  options.keep_corner_angle = request.keep_corner_angle;
  options.keep_found_corner = request.keep_found_corner;
  options.feed = std::max(1.0, 60 * request.limits.feed);
  options.acceleration = request.limits.acceleration.minCoeff();
  options.jerk = request.jerk;
  options.scatter = request.scatter;
  options.accurate = request.accurate;
  options.near = request.near;
  if (request.side == geometry::Side::kBoth) return geometry::fair_path(run, options);
  return geometry::one_sided_fair_path(run, {options, request.side, request.side_margin});
}

}  // namespace batten::postproc
