#include "postproc/smooth/methods/run_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/fitting/fair/fair_measure.h"
#include "geometry/fitting/one_sided/one_sided_fair.h"
#include "postproc/smooth/methods/curvature_profile.h"

namespace batten::postproc {

using geometry::Point3;
using geometry::SmoothCurve;
using geometry::Vector3;

namespace {

constexpr double kSecondsPerMinute = 60;

}  // namespace

geometry::KinematicLimits limits_of(const Machine& machine, double feed) {
  geometry::KinematicLimits limits;
  limits.feed = std::min(feed / kSecondsPerMinute, machine.max_velocity());
  limits.speed.setConstant(machine.max_velocity());
  limits.acceleration.setConstant(machine.max_acceleration());
  limits.jerk.setConstant(std::numeric_limits<double>::infinity());
  return limits;
}

std::optional<SmoothCurve> fair_curve(std::span<const Point3> run, const CurveRequest& request) {
  geometry::FairOptions options;
  options.tolerance = request.tolerance;
  options.rounding = request.rounding;
  options.keep_corner_angle = request.keep_corner_angle;
  options.feed = std::max(1.0, kSecondsPerMinute * request.limits.feed);
  options.acceleration = request.limits.acceleration.minCoeff();
  options.jerk = request.jerk;
  options.scatter = request.scatter;
  options.accurate = request.accurate;
  options.near = request.near;
  if (request.side == geometry::Side::kBoth) return geometry::fair_path(run, options);
  return geometry::one_sided_fair_path(run, {options, request.side, request.side_margin});
}

std::optional<RunCurve> curve_of(Method method, std::span<const Point3> run,
                                 const CurveRequest& request) {
  if (request.side != geometry::Side::kBoth && method != Method::kFair) return std::nullopt;
  const auto found = [&]() -> std::optional<SmoothCurve> {
    switch (method) {
      case Method::kFair:
        return fair_curve(run, request);
      case Method::kTimeOptimal:
        return time_optimal_curve(run, request);
      case Method::kNaseath:
        return naseath_curve(run, request, false);
      case Method::kNaseathLiteral:
        return naseath_curve(run, request, true);
      case Method::kGuo:
        return guo_curve(run, request, false);
      case Method::kGuoLiteral:
        return guo_curve(run, request, true);
      case Method::kOzcan:
        return ozcan_curve(run, request);
      case Method::kBest:
      case Method::kNone:
        break;
    }
    throw std::invalid_argument("curve_of: method " + std::string(name_of(method)) +
                                ", expected one that makes a curve");
  }();
  if (!found) return std::nullopt;
  return RunCurve{method, *found};
}

double greatest_curvature(std::span<const Point3> p) {
  double most = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Vector3 a = p[i] - p[i - 1];
    const Vector3 b = p[i + 1] - p[i];
    const double sides = a.norm() * b.norm() * (p[i + 1] - p[i - 1]).norm();
    if (sides > 0) most = std::max(most, 2 * a.cross(b).norm() / sides);
  }
  return most;
}

double greatest_curvature(const geometry::BsplineCurve& curve) {
  return CurvatureProfile(curve).greatest();
}

double chord_error(const Run& run, const SmoothCurve& meant, double rounding) {
  double squares = 0;
  geometry::SplineWalk curve(meant.curve.basis().knots(), meant.curve.control_points());
  for (std::size_t i = 0; i + 1 < run.points.size(); ++i) {
    const double u = 0.5 * (meant.vertex_parameters[i] + meant.vertex_parameters[i + 1]);
    const Point3 middle = 0.5 * (run.points[i] + run.points[i + 1]);
    const Vector3 off = curve.point_at(u) - middle;
    const Vector3 along = run.points[i + 1] - run.points[i];
    const double length = along.squaredNorm();
    const double slide = length > 0 ? off.dot(along) / length : 0;
    squares += (off - slide * along).squaredNorm();
  }
  const double chords = std::sqrt(squares / static_cast<double>(run.points.size() - 1));
  return meant.noise > 2 * rounding ? std::max(chords, meant.noise) : chords;
}

}  // namespace batten::postproc
