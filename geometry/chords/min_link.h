// A polyline with as few links as possible in the tolerance tube of a curve: its vertices may
// leave the curve. Method: docs/algorithms/min_link.md.
//
// What is promised, for every curve: each link is proved (control points, not samples) to be
// within `tolerance` of its part of the curve, both ways and in order; the ends are the curve's
// own; there are not more links than greedy chords with vertices on the curve have
// (geometry/chords/linearize.h).
//
// In the plane the count is the minimum to within a part of 1e-3 for a strip that is narrower than
// the tube on the inside of bends by 2 / gates_per_link^2 of the tolerance (2e-3 for the default
// 32); a curve whose minimum is just met may get one link more. In space links are as long as they
// can be from the vertex before them, with one look ahead; no minimum is claimed. Where the
// tolerance is above the curve's radius the strip is cut at nine tenths of the radius, which allows
// less than the tube; corners are always vertices.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "geometry/chords/linearize.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct MinLinkOptions {
  double tolerance = 0.01;  // mm, > 0
  int gates_per_link = 32;  // along a link, where it is held against the curve; >= 8
  // With as many links, the last not a short remainder and the others nearer to the curve.
  bool balanced = true;
};

struct MinLinkTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  int least_gates = 8;  // fewer show no link [< MinLinkVertices.RefuseOptionsOutsideTheirRange]
  // Of the tolerance: a curve this near to a plane is taken as plane. Two points of a link and the
  // curve may be apart twice that across the plane, which costs 0.1 % of the tolerance.
  double flat = 0.02;  // [at 0: MinLinkCount.IsThatOfTheTable]
  // Balancing: rounds in search of the least tolerance that needs as many links, above this part
  // of it (9/16 needs a third more links), over the last links only: the cost does not grow with
  // the run. [rounds at 1: MinLinkVertices.AreNotFartherApartThanBalancedOnes]
  int balancing_rounds = 2;
  double narrowest = 9.0 / 16;
  // Above the tolerance with which the last link is expected to be as long as the others, as a part
  // of what it is below the whole: where a balanced polyline is looked for first.
  // [at 0.1: MinLinkVertices.AreNotFartherApartThanBalancedOnes]
  double above_needed = 0.05;
  std::size_t balanced = 40;
  // In space. Corners of the polygon in a gate's circle: between two of them it is 2 % narrower; to
  // where the curve bends, where the width is needed, it is not.
  static constexpr int corners = 16;
  std::size_t at_once = 8;  // circles that are passed together, for speed: any number sees as far
  // Of the last point of a link: to 1 % of the way between two gates.
  int end_halvings = 7;    // [at 1: MinLinkCount.OfAHelixIsThatOfItsBend]
  double same_bend = 0.5;  // cosine: bends that differ by less than 60 degrees are one
  double widest_view = 1;  // tangent: a link turns from the curve by less than 45 degrees [>]
  // Where a link may turn before the farthest point it gets to, as parts of its gates: there the
  // link after it may see more, when the curve begins to bend another way.
  std::array<double, 3> earlier_turns = {0.125, 0.25, 0.5};  // the last: [at 0.25]
};
inline constexpr MinLinkTuning kMinLinkTuning;

// Vertices with points of the curve that they are for, parameters not decreasing; the first and
// the last are the curve's points at `from` and `to`.
//
// Requires degree 3 or less and first() <= from < to <= last(). Throws std::invalid_argument when
// an option is outside its range.
[[nodiscard]] std::vector<LinkVertex> min_link_vertices(const BsplineCurve& curve, double from,
                                                        double to, const MinLinkOptions& options);

}  // namespace batten::geometry
