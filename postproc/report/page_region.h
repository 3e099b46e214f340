// The region of the tolerance as the page draws it: all places within the tolerance of what was
// rewritten, as exact polygons with holes (geometry/band/tolerance_band.h). It shows where the band
// lies over itself: between neighbouring passes, in thin walls, in bends tighter than the
// tolerance.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::postproc {

// A page draws the region of so many edges of old paths, after those that are straight on are taken
// together. It costs up to 0.3 ms and some 20 bytes of the page for each.
inline constexpr std::size_t kMostRegionEdges = 10000;

struct PageRegion {
  // mm; outer ones counter-clockwise as seen against the axis of their plane, holes clockwise.
  std::vector<std::vector<geometry::Point3>> polygons;
  std::size_t edges = 0;     // of the old paths that they are about
  std::size_t drawn = 0;     // compared sections that have their region here
  std::size_t in_space = 0;  // that have none since they do not lie in one plane across an axis
  std::size_t left_out = 0;  // with which there would be more than `most_edges`
};

// Adds the region of the old path of a compared section, or counts why it has none.
void add_region(std::span<const geometry::PathPiece> before,
                std::span<const geometry::PathPiece> after, double tolerance_mm,
                std::size_t most_edges, PageRegion& region);

}  // namespace batten::postproc
