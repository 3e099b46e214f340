// The corner that a machine runs fastest: a curve that swings to the outside before and after the
// vertex and to the inside at it, as far as the tolerance allows, timed so that the axes' limits
// are used all the way. Our own. Method: docs/algorithms/band_curve.md, section Corner.
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/path/kinematic_feed.h"
#include "geometry/path/path.h"

namespace batten::geometry {

struct TimeOptimalOptions {
  double tolerance = 0.01;  // mm, > 0
  ToleranceKind kind = ToleranceKind::kPath;
  // May be infinite, but for the feed and one of acceleration and jerk of each axis.
  KinematicLimits limits;
  // mm of each leg that the curve may take, all of it at most.
  double share_before = 0;
  double share_after = 0;
  int spans = 32;  // of the curve, 8 or more: more are nearer to the fastest, and cost as much more
};

struct TimeOptimalBlend {
  CornerBlend blend;  // its parameter is the time in s that the machine takes it in
  double before = 0;  // mm of the legs that it replaces
  double after = 0;
  double speed_before = 0;  // mm/s at its ends, along the legs, without acceleration there
  double speed_after = 0;
  double time = 0;  // s
  // The greatest of |acceleration| and |jerk| of an axis over its limit, in that time: about 1.
  double load = 0;
};

// The blend's deviation is not above the tolerance.
//
// Throws std::invalid_argument when an option is out of the range given above.
[[nodiscard]] std::variant<TimeOptimalBlend, NoBlend> time_optimal_corner(
    const Corner& corner, const TimeOptimalOptions& options);

// A polyline with a racing line (time_optimal_corner.h) in the place of each corner that a machine
// has to slow down for, and a five-point blend (guo_corner.h) in the place of each gentle one.
// Method: docs/algorithms/band_curve.md, section Paths of corners.

struct TimeOptimalPathOptions {
  double tolerance = 0.01;  // mm
  ToleranceKind kind = ToleranceKind::kPath;
  KinematicLimits limits;          // as for time_optimal_corner
  double keep_corner_angle = 3.2;  // radians: vertices that turn more stay (> pi: none)
  // Radians between the legs: sharper corners are held to ToleranceKind::kPath.
  double strict_sharper_than = 0;
  // Radians: vertices that turn less get the five-point blend, in closed form. A racing line would
  // win little there, and a smooth curve has thousands of them.
  double least_raced_turn = 0.1;
  // Corners, different ones, for which a racing line is searched; those behind them get the
  // five-point blend. Bounds the time for paths that are no paths of corners.
  int most_raced = 40;
};

struct TimeOptimalPathBlend {
  CornerBlend blend;
  bool raced = false;  // else the five points
};

using TimeOptimalPath = CornerPath<TimeOptimalPathBlend>;

// Segments are shared half and half where both ends are corners (shared_corners). Corners that are
// alike (directions of the legs, and shares where these are used up) are searched once. The path
// starts and ends in the given ends.
//
// Cost: linear, but each corner that has to be searched takes some ten convex problems. Throws
// std::invalid_argument when the tolerance is not a positive number, or the limits are not as
// time_optimal_corner needs them.
[[nodiscard]] TimeOptimalPath time_optimal_path(std::span<const Point3> points,
                                                const TimeOptimalPathOptions& options);

}  // namespace batten::geometry
