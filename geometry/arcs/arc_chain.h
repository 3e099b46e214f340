// One smooth section of a plane curve as a chain of arcs, greedily: each step takes the
// pair of arcs (or the single arc) that reaches farthest inside the allowed deviation.
// Method: docs/algorithms/arc_fit.md, steps 4 to 6.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "geometry/arcs/biarc.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {

struct ArcChainLimits : ArcRange {
  double deviation = 0;         // mm in the plane
  double height_deviation = 0;  // mm along the axis, at equal angles
  bool flat = true;             // heights play no part
  double precision = 3e-3;  // of a step: its end is searched to this; 100 steps lose a third of one
};

struct ArcChainTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  // A single arc is taken instead of a pair when it reaches this part of the pair's length:
  // one arc then covers more than each of the pair does.
  double single_reach = 0.6;
  double stumble = 0.5;    // of the step before: shorter ones may have failed by the end's tangent
  double remainder = 0.3;  // of a step: what is left after it would make a last step too short
  // Beyond `pace_known` of the way a chain that has used up `hopeless_pace` times its share of the
  // pieces will not do with them; nor one that is `pieces_ahead` beyond that, however short the
  // way.
  double pace_known = 0.2;
  double hopeless_pace = 1.5;
  double pieces_ahead = 64;  // [at 4]
  double kink_noise = 1e-5;  // radians, of a single arc at a fixed tangent of a fitted curve [>]
  // How much of the best crossing angle is used. With all of it only chains of just the best length
  // hold, shorter ones swing too far, and the search would fall between; half of it already gives
  // 16 % longer arcs than tangents of the curve, and holds at every length.
  double crossing_share = 0.5;
  double best_arc = 124.7;    // 36 sqrt(12): see ArcChain::crossing_angle
  double crossing_noise = 2;  // T / L: a single arc's miss of that angle; more costs the next arc
  // The error of a helix' rise per mm against the curve's, so that the direction in space does not
  // jump where heights are within their tolerance.
  double slope_error = 5e-3;
  double sampled_part = 0.9;  // of height_deviation; the rest is for what lies between samples
  // Radians that arcs and curve may turn apart: no loop more or less [at 0.1]
  double most_turned = 1;
  // The deviation is narrowed by halving the doubt so often; only for chains so short that
  // the last step can be a remainder that is worth spreading.
  int balancing_rounds = 5;
  std::size_t balanced_pieces = 60;
  double shortest_in_grids = 10;  // a shorter step's tangent is turned 0.1 radians by rounding
  double shortest = 1e-5;         // mm, without a grid [>]
  double part_of_section = 0.01;  // is short in any case: a closed section has no span [<]
  int joint_places = 40;          // to each side, that are tried for a joint near the grid
  double widest_joint = 1.3;      // balance: beyond, one arc is much shorter than the other
};
inline constexpr ArcChainTuning kArcChainTuning;

// A point that the chain passes with a known tangent.
struct ChainNode {
  double u;      // on the curve
  Point3 place;  // local coordinates of the curve, rounded to the grid
  double angle;  // of the tangent in the plane, on the count of PlaneCurve::angle_at
};

struct ChainPiece {
  PlaneArc arc;
  double end_height;
};

// Whether a chain that has used so many pieces on a part of its way (`done`, 0..1) is so far behind
// its pace that it will not do with `most` of them.
[[nodiscard]] bool falls_behind(double done, std::size_t used, std::size_t most);

// Few pieces from one node to the other. Nothing when neither arcs nor short lines hold, or when
// more than `at_most` would be needed.
[[nodiscard]] std::optional<std::vector<ChainPiece>> arc_chain(const PlaneCurve& curve,
                                                               const ArcChainLimits& limits,
                                                               const ChainNode& start,
                                                               const ChainNode& end,
                                                               std::size_t at_most);

// As many pieces as `chain` has between the same nodes or fewer, with the least deviation. A long
// chain as it is. Up to five times the work of the chain itself.
[[nodiscard]] std::vector<ChainPiece> balanced(const PlaneCurve& curve,
                                               const ArcChainLimits& limits, const ChainNode& start,
                                               const ChainNode& end, std::vector<ChainPiece> chain);

// Whether a pair of arcs leads from the curve at one parameter to the curve at another one.
[[nodiscard]] bool pair_of_arcs_holds(const PlaneCurve& curve, const ArcChainLimits& limits,
                                      double from, double to);

// To multiples of `grid`; where that is 0, not at all.
[[nodiscard]] Point3 rounded_to(double grid, const Point3& place);

}  // namespace batten::geometry
