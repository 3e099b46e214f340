// A second way to see whether a new path is where it may be. It shares nothing with the distance of
// two paths (geometry/distance/path_distance): the region of the tolerance about a flat path, as
// polygons with holes by exact arithmetic. Method: docs/algorithms/tolerance_band.md.
//
// A path within the tolerance of another one, in order, lies in the region of that one and passes
// each hole of it on the same side: both can be drawn over each other without leaving the region.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// Two paths in one plane across an axis, as chains of chords seen along that axis.
struct FlatPaths {
  int axis = 2;
  double height = 0;  // mm, of the plane along the axis
  std::vector<Point2> before;
  std::vector<Point2> after;

  // A place of the plane.
  [[nodiscard]] Point3 in_space(const Point2& flat) const;
};

// With the chords of arcs and Bezier pieces at most `max_error` (mm, > 0) off. Nothing where the
// paths do not lie in one plane across an axis, or one of them has no length. Linear cost.
[[nodiscard]] std::optional<FlatPaths> flat_paths(std::span<const PathPiece> before,
                                                  std::span<const PathPiece> after,
                                                  double max_error);

struct RegionCheck {
  bool is_inside = true;          // the new path leaves the region nowhere
  bool passes_alike = true;       // each hole on the side on which the old path passes it
  Point3 place = Point3::Zero();  // where it leaves the region, or a corner of the hole
  std::size_t holes = 0;          // of the region

  [[nodiscard]] bool holds() const { return is_inside && passes_alike; }
};

// Of the region of all places within `tolerance` (mm, > 0) of the old path. It may be too great by
// 6 % of the tolerance, for arcs and Bezier pieces that count as chords and for the polygons about
// round ends. The new path starts and ends within the tolerance of the starts and ends of the old
// one.
//
// Nothing where flat_paths gives nothing. Throws std::invalid_argument when the tolerance is not a
// positive number. Cost: that of band_outline (geometry/band/tolerance_band.h).
[[nodiscard]] std::optional<RegionCheck> check_in_region(std::span<const PathPiece> before,
                                                         std::span<const PathPiece> after,
                                                         double tolerance);

}  // namespace batten::geometry
