// The corner that a machine runs fastest: a curve that swings to the outside before and after the
// vertex and to the inside at it, as far as the tolerance allows, timed so that the axes' limits
// are used all the way. Our own. Method: docs/algorithms/band_curve.md, section Corner.
#pragma once

#include <span>
#include <variant>

#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/path/kinematic_feed.h"

namespace batten::geometry {

struct TimeOptimalOptions {
  double tolerance = 0.01;  // mm, > 0
  ToleranceKind kind = ToleranceKind::kPath;
  // May be infinite, but for the feed and one of acceleration and jerk of each axis.
  KinematicLimits limits;
  // mm of each leg that the curve may take, all of it at most.
  double share_before = 0;
  double share_after = 0;
};

struct TimeOptimalTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  int spans_each = 16;   // of the curve, to each side: more are faster by little, and dear
  double growth = 1.05;  // of spans from the apex outwards: all that is quick happens near it
  int watched = 4;       // samples per span where the band is held, and the bends are looked at
  // The speed may be above the feed by this part: the planner that runs the curve caps it, which
  // costs no more than that, and the ends, which have the feed itself, are strictly inside.
  double overspeed = 2e-4;
  double time_error = 2e-4;  // of what a stop costs: the time is found to this [at 0.1]
  int time_tries = 16;       // [<]
  // The lost time is between these parts of the ramps' and of a stop's: with a wide tolerance the
  // way is shorter, and time is won. First it is thought to be the third.
  double least_lost = -1.5;
  // [at 0.41: TimeOptimalCorner.KeepsTheToleranceTheLegsAndTheMachinesLimitsInItsTime]
  double most_lost = 1.2;
  double first_lost = 0.4;
  double from_ends = 0.05;  // of the interval of times: the next try keeps so far from its ends
  // Rounds of solving again further inside, since the band is held at samples only.
  int band_rounds = 4;  // [at 0: the same]
  double further_inside = 1e-4;
  // A curve that bends this many times as hard as the five points do is none: where there is
  // hardly any room (teeth of noise), the search ends with one that stops on its way.
  double sharper = 2;
};
inline constexpr TimeOptimalTuning kTimeOptimalTuning;

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

// A polyline with such a curve in the place of each corner that a machine has to slow down for, and
// a five-point blend (guo_corner.h) in the place of each gentle one.
// Method: docs/algorithms/band_curve.md, section Paths of corners.
struct TimeOptimalPathOptions : CornerPathOptions {
  KinematicLimits limits;  // as for time_optimal_corner
  // Radians: vertices that turn less get the five-point blend, in closed form. A search would win
  // little there, and a smooth curve has thousands of them.
  double least_raced_turn = 0.1;
  // Corners, different ones, that are searched; those after them get the five-point blend. Bounds
  // the time for paths that are no paths of corners.
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
