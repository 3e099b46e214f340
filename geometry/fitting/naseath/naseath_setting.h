// What Naseath's smoother (naseath.h) is asked for and works on, the same in every pass; how much
// of a move the curve follows, and the room that is left in the tube.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/fitting/naseath/naseath_polygon.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct NaseathRepairs {
  // The displacement is bounded, not looked at in `precision` places per span.
  bool exact_bound = true;
  // A stretch that touched the tube stops, the rest goes on. Needs exact_bound.
  bool local_stop = true;
  // Points go back where a pass would make the curve bend harder than the old one does in the
  // same span or the next to it; the rest goes on.
  bool guard_curvature = true;
  // Of all passes the one that bends least is returned, not the last one.
  bool keep_best = true;
  // With keep_best: passes without a better curve after which it ends. 0: no such end.
  int stall_passes = 30;
  // Sensitivities count as no less than this, since one tiny value makes all other moves tiny.
  // 0: no floor.
  double sensitivity_floor = 0.3;

  [[nodiscard]] static NaseathRepairs none() { return {false, false, false, false, 0, 0}; }
};

struct NaseathOptions {
  double radius = 0.01;    // mm: R, the tube's
  int precision = 5;       // p, places per span at which a displacement is measured
  double accuracy = 0.01;  // a: within this part of the radius is at it
  int max_passes = 2000;   // the literal method need not end by itself
  int held_points = 0;     // control points at each end that do not move:
                           // 1 keeps the ends, 2 the tangents, 3 the curvatures there as well
  NaseathRepairs repairs;
};

// Span j of a cubic hangs on the control points j to j + 3.
inline constexpr std::size_t kNaseathDegree = 3;

struct NaseathSetting {
  BsplineBasis basis;
  ControlPolygon original;
  EndLegs legs;
  std::vector<double> parameters;  // of influence, per point
  NaseathOptions options;

  [[nodiscard]] BsplineCurve curve_of(ControlPolygon polygon) const;
  [[nodiscard]] bool is_held(std::size_t i) const;
  [[nodiscard]] double at_tube() const { return options.accuracy * options.radius; }  // mm
};

// Throws as smooth_naseath says.
[[nodiscard]] NaseathSetting naseath_setting(const BsplineCurve& curve,
                                             const NaseathOptions& options);

// How much of a control point's move the curve follows (step 4 of docs/algorithms/naseath.md).
//
// The parameter at which a control point acts most, one per point: the middle knot of the five
// of its function; beside the ends, where that is the end itself, the middle of the first (last)
// span. Requires degree 3 and clamped knots.
[[nodiscard]] std::vector<double> parameters_of_influence(const BsplineBasis& basis);

// |D(t_i)| / move_i per point, where D is the spline of the moves as they were made and move_i
// (mm) the nominal size of one, counted even if its direction was null. Where the quotient is
// nothing, 1. Points with move_i = 0 keep their entry of `before`.
[[nodiscard]] std::vector<double> naseath_sensitivities(const BsplineCurve& moves,
                                                        const std::vector<double>& parameters,
                                                        const std::vector<double>& nominal,
                                                        const std::vector<double>& before);

// What is left of the tube's radius.
struct NaseathRoom {
  double least = 0;               // mm, over the whole curve
  std::vector<double> per_point;  // mm, over the spans that the point acts on
};

[[nodiscard]] NaseathRoom naseath_room(const NaseathSetting& setting,
                                       const ControlPolygon& polygon);

// mm: |moved - original| does not exceed it at any parameter, and is above the greatest by a
// ten-millionth of accuracy times radius at most.
[[nodiscard]] double naseath_displacement(const NaseathSetting& setting,
                                          const ControlPolygon& polygon);

}  // namespace batten::geometry
