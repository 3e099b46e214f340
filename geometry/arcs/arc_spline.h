// Few arcs, each tangent to the next, in the tolerance band of a polyline: an arc spline.
// Method: docs/algorithms/arc_spline.md.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/arcs/biarc.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {

// How much the search for few arcs looks at. Thorough: some percent fewer arcs than quick for five
// times the work; brief: some percent more for a quarter of it.
enum class ArcEffort { kBrief, kQuick, kThorough };

struct ArcSplineOptions {
  double tolerance = 0.01;  // mm, both ways and in order; > 0
  double min_radius = 0.1;  // mm; a place that is tighter becomes a kink
  double max_radius = 1e4;  // mm; flatter arcs are lines
  double max_sweep = 3.0;   // radians, in ]0, pi[
  double grid = 0;          // mm: ends of arcs are multiples of it, but for the first and the
                            // last; > 0 where they will be printed
  double direction = 0;     // radians: in which the path starts, about
  std::optional<double> start_angle;  // radians: of the tangent in which it starts, exactly;
  std::optional<double> end_angle;    // and in which it ends. Free where there is none
  bool kinks = true;                  // whether the chain may turn where no arc fits
  ArcEffort effort = ArcEffort::kQuick;
};

struct ArcSplinePiece {
  PlaneArc arc;
  double station;  // length along the polyline where the arc ends, mm
};

struct ArcSpline {
  std::vector<ArcSplinePiece> pieces;  // a chain from the first point to the last
  int kinks = 0;                       // joints that are not tangent: no arc fits in the band there
};

// Requires two points or more, neighbours apart. Returns nothing when no chain was found.
//
// Neighbouring arcs are tangent but for kinks: each leaves along the tangent with which the one
// before it arrives, at the rounded place. A line is bent by the rounding of its end. Throws
// std::invalid_argument for a tolerance, radius or sweep out of range.
[[nodiscard]] std::optional<ArcSpline> fit_arc_spline(std::span<const Point2> points,
                                                      const ArcSplineOptions& options);

}  // namespace batten::geometry
