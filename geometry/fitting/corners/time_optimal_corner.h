// The corner that a machine runs fastest: a curve that swings to the outside before and after the
// vertex and to the inside at it, as far as the tolerance allows, timed so that the axes' limits
// are used all the way. Our own. Method: docs/algorithms/band_curve.md, section Corner.
#pragma once

#include <functional>
#include <optional>
#include <variant>

#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/fitting/tube/tube_smoothing.h"
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

// The same with the room along the legs chosen by planned time: `timer` gets the whole corner,
// legs and all.
[[nodiscard]] std::variant<TimeOptimalBlend, NoBlend> time_optimal_corner(
    const Corner& corner, const TimeOptimalOptions& options, const CurveTimer& timer);

// The whole corner as one curve, from its `before` to its `after`.
[[nodiscard]] BsplineCurve with_legs(const TimeOptimalBlend& blend, const Corner& corner);

}  // namespace batten::geometry
