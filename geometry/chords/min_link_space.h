// Few links in the tolerance tube of a curve in space, each as long as it can be.
// Method: docs/algorithms/min_link.md.
#pragma once

#include <span>
#include <vector>

#include "geometry/chords/min_link_gates.h"
#include "geometry/chords/min_link_plane.h"

namespace batten::geometry {

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
