// A polyline with as few links as possible in the tolerance tube of a curve: its vertices may
// leave the curve. Method: docs/algorithms/min_link.md.
//
// What is promised, for every curve: each link is proved (control points, not samples) to be
// within `tolerance` of its part of the curve, both ways and in order; the ends are the curve's
// own; there are not more links than greedy chords with vertices on the curve have
// (geometry/chords/linearize.h).
//
// What "minimum" means. The tube is read as a strip: a polyline goes through the curve's normal
// sections in order, at most the tolerance from the curve. Where the tolerance is below the
// curve's radius, that is all that both ways and in order allow, but for the ends. In the plane
// the count is the minimum for a strip that is narrower on the inside of bends by
// 2 / gates_per_link^2 of the tolerance (2e-3 for the default 32), with vertices on the gates and
// at the farthest place that each number of links gets to: exact where the bend does not change its
// side from one link to the next; where it does, a link is at most a gate's distance from the
// longest possible. A link's length goes with the square root of the tolerance, so the count is
// right to within a part of 1e-3, and a curve whose minimum is just met may get one link more.
//
// In space links are as long as they can be from the vertex before them, chosen among a few
// places with one look ahead; no minimum is claimed. On a plane curve that bends to one side
// this is the minimum too.
//
// Where the tolerance is above the curve's radius the strip is cut at nine tenths of the radius,
// which allows less than the tube; corners are always vertices.
#pragma once

#include <span>
#include <vector>

#include "geometry/chords/min_link_gates.h"
#include "geometry/chords/min_link_plane.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct MinLinkOptions {
  double tolerance = 0.01;  // mm, > 0
  int gates_per_link = 32;  // places along a link where it is held against the curve; >= 8
  // With as many links, the last not a short remainder and the others nearer to the curve.
  bool balanced = true;
};

// Vertices with places of the curve that they stand for, parameters not decreasing; the first and
// the last are the curve's places at `from` and `to`.
//
// Requires degree 3 or less and first() <= from < to <= last(). Throws std::invalid_argument when
// an option is outside its range.
[[nodiscard]] std::vector<LinkVertex> min_link_vertices(const BsplineCurve& curve, double from,
                                                        double to, const MinLinkOptions& options);

// Few links in the tolerance tube of a curve in space, each as long as it can be.
// Method: docs/algorithms/min_link.md.

// Links from `start`, near the first gate's centre, to the centre of the last one, through all
// gates in order, each inside a polygon of 16 corners in the circle of radius `width` (mm) about
// the gate's centre; a corner points to where the curve bends.
//
// Where the curve bends so closely that no link gets on, the way goes over the next of `places`:
// parameters of the curve, increasing, between which chords are known to be near it. The last of
// them is the last gate's.
[[nodiscard]] std::vector<LinkVertex> few_links_in_space(const GateChain& gates,
                                                         const Point3& start, double width,
                                                         std::span<const double> places);

}  // namespace batten::geometry
