// Paths whose planned time is known, and what samples say about a plan.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/fitting/corners/guo_corner.h"
#include "geometry/fitting/corners/ozcan_corner.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/smooth/methods/method_table.h"
#include "tests/support/sampled_motion.h"

namespace batten::postproc {

// The machine of the corner A(0,0) C(13,13) B(26,0): F 25 mm/s, A 2500 and 3000 mm/s^2, J 5000
// mm/s^3 per axis, 1e4 and 1e5 along the path.
inline KinematicPathLimits corner_limits() { return TableSettings::ozcan_limits(); }

inline geometry::Corner wide_corner() { return {{0, 0, 0}, {13, 13, 0}, {26, 0, 0}}; }

// A blend and what it leaves of the legs.
inline geometry::Path with_legs(const geometry::BsplineCurve& blend) {
  const geometry::Corner corner = wide_corner();
  geometry::Path path = {geometry::Line{corner.before, blend.point_at(blend.first())}};
  for (const auto& piece : blend.bezier_pieces()) path.emplace_back(piece);
  path.emplace_back(geometry::Line{blend.point_at(blend.last()), corner.after});
  return path;
}

// The eight-point corner with P4 there and P5 its mirror image.
inline geometry::Path ozcan_path(double x, double y) {
  const auto frame = std::get<geometry::CornerFrame>(geometry::frame_of(wide_corner()));
  const double r = std::sqrt(2.0);
  const geometry::OzcanLeg leg = {3 * r, 2.25 * r, 1.5 * r};
  const geometry::Vector3 from = geometry::Point3(x, y, 0) - frame.vertex;
  const geometry::BesideLeg fourth = {from.dot(frame.a), from.dot(frame.outward_a())};
  return with_legs(geometry::ozcan_curve(frame, leg, fourth));
}

inline geometry::Path guo_path_of(double tolerance, geometry::GuoApex apex) {
  geometry::GuoRule rule;
  rule.tolerance = tolerance;
  rule.kind = geometry::ToleranceKind::kBand;
  rule.apex = apex;
  const auto outcome = geometry::guo_corner(wide_corner(), rule);
  return with_legs(std::get<geometry::GuoBlend>(outcome).blend.curve);
}

struct Use {
  double share = 0;   // of the limit, the greatest
  std::string where;  // which limit, and when
};

// The greatest share of any limit that samples of the plan use.
inline Use greatest_use(std::span<const geometry::PathPiece> path, const FeedPlan& plan,
                        LimitsOfPieces limits_of_pieces, double period) {
  Use use;
  for_each_sample(path, plan, period, [&](const MotionSample& m) {
    const KinematicPathLimits& limits = limits_of(limits_of_pieces, m.piece);
    const auto see = [&](double share, const char* name) {
      if (share <= use.share) return;
      use = {share, std::string(name) + " at " + std::to_string(m.time) + " s"};
    };
    see(m.speed / limits.feed, "feed");
    for (int i = 0; i < 3; ++i) {
      see(std::abs(m.velocity[i]) / limits.speed[i], "speed");
      see(std::abs(m.acceleration[i]) / limits.acceleration[i], "acceleration");
      see(std::abs(m.jerk[i]) / limits.jerk[i], "jerk");
    }
    see(std::abs(m.tangential_acceleration) / limits.tangential_acceleration, "tangential a");
    see(std::abs(m.tangential_jerk) / limits.tangential_jerk, "tangential jerk");
    const double along = m.tangential_acceleration;
    const double across = std::sqrt(std::max(0.0, m.acceleration.squaredNorm() - along * along));
    see(across / limits.normal_acceleration, "normal acceleration");
  });
  return use;
}

inline Use greatest_use(std::span<const geometry::PathPiece> path, const FeedPlan& plan,
                        const KinematicPathLimits& limits, double period) {
  return greatest_use(path, plan, LimitsOfPieces(&limits, 1), period);
}

// A cubic B-spline through nowhere in particular, of 5 to 14 control points, flat or in space.
// `x_first`: of the numbers of a point.
inline geometry::BsplineCurve random_curve(std::mt19937& random, bool x_first = false) {
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> count(5, 14);
  const int n = count(random);
  const double size = std::pow(10, 0.5 * normal(random));
  const bool flat = random() % 2 == 0;
  std::vector<geometry::Point3> points;
  for (int i = 0; i < n; ++i) {
    const double z = flat ? 0 : normal(random);
    double x = normal(random);
    double y = normal(random);
    if (!x_first) std::swap(x, y);
    points.push_back(size * geometry::Point3(1.5 * i + x, 2 * y, z));
  }
  std::vector<double> knots;
  for (int i = 0; i + 2 < n; ++i) knots.push_back(i);
  return {geometry::BsplineBasis::clamped(3, knots), points};
}

// Every limit is met somewhere on some of the paths.
inline KinematicPathLimits random_limits(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto about = [&](double value) { return value * std::exp(0.7 * normal(random)); };
  KinematicPathLimits limits;
  limits.feed = about(50);
  for (int i = 0; i < 3; ++i) {
    limits.speed[i] = about(60);
    limits.acceleration[i] = about(600);
    limits.jerk[i] = about(10000);
  }
  limits.tangential_acceleration = about(500);
  limits.tangential_jerk = about(12000);
  limits.normal_acceleration = about(800);
  return limits;
}

}  // namespace batten::postproc
