// Few arcs, each tangent to the next, in the tolerance band of a polyline: an arc spline.
// Method: docs/algorithms/arc_spline.md.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "geometry/arcs/biarc.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {

// How much the search for few arcs looks at. Thorough: some percent fewer arcs than quick for five
// times the work; brief: some percent more for a quarter of it.
enum class ArcEffort { kBrief, kQuick, kThorough };

struct ArcSplineOptions : ArcRange {
  double tolerance = 0.01;            // mm, both ways and in order; > 0
  double direction = 0;               // radians: in which the path starts, about
  std::optional<double> start_angle;  // radians: of the tangent in which it starts, exactly;
  std::optional<double> end_angle;    // and in which it ends. Free where there is none
  bool kinks = true;                  // whether the chain may turn where no arc fits
  ArcEffort effort = ArcEffort::kQuick;
  // Chains that cost more arcs (a kink counts as several) are not looked for.
  std::size_t at_most = std::numeric_limits<std::size_t>::max() / 2;
};

struct ArcSplineTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  std::size_t kink_costs = 3;  // a kink counts as so many arcs
  std::size_t patience = 4;    // levels beyond a kink's that may pass without seeing farther [at 0]
  // Radians: vertices of the polyline that turn more may be kinks.
  double kink_turn = 0.2;  // [ArcSpline.OfAButterflyInBriefTakesFewArcsAndOneKink]
  // Samples before the reach's end: where such are looked for [at 0:
  // ArcSpline.LinesStayLinesAndTheirCornerAKink]
  std::size_t corner_back = 16;
  // Of a range of curvatures: arcs to a corner keep off its ends [at 0.4:
  // ArcSpline.OfAButterflyInBriefTakesFewArcsAndOneKink]
  double range_margin = 0.05;
  double same_turn = 1e-6;  // radians: what differs less is the same tangent [>]
  double two_reach = 1.5;   // two arcs get so much farther than one, at most [at 1e9]
  // Chains of no more arcs than `few` are tried again with a part of the tolerance: circles and
  // fillets come out with their own radius.
  std::size_t few = 8;    // [at 0: FitArcs.ACircleIsAFewArcsOfItsRadius]
  double nearer = 0.3;    // [>]
  int nearer_rounds = 3;  // [at 0: FitArcs.ACircleIsAFewArcsOfItsRadius]
};
inline constexpr ArcSplineTuning kArcSplineTuning;

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
