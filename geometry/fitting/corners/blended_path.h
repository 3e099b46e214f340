// A polyline with a short curve in the place of each corner: what all corner methods share,
// whatever the curve is.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// The points that are apart from the one before them.
struct DistinctVertices {
  std::vector<Point3> points;
  std::vector<std::size_t> indices;  // of each among the given points

  [[nodiscard]] std::size_t size() const { return points.size(); }
};

// `ring`: the last point is the first one again and is left out.
[[nodiscard]] DistinctVertices distinct_vertices(std::span<const Point3> points, bool ring);

// A corner with what it may use of its legs, mm: half of a segment whose other end is a corner
// as well, the whole where the path ends there or the vertex stays as it is.
struct SharedCorner {
  std::size_t vertex;  // index among the distinct vertices
  Corner corner;
  double share_before;
  double share_after;
  bool stays = false;  // turns more than `keep_corner_angle`
};

// Those of the inner vertices; of all vertices of a ring. Linear cost.
[[nodiscard]] std::vector<SharedCorner> shared_corners(std::span<const Point3> distinct, bool ring,
                                                       double keep_corner_angle);

// Whether the legs turn by more than this (radians, 0 straight on, pi back).
[[nodiscard]] bool turns_more(const Corner& corner, double angle);

// The reading that a corner is held to where `kind` is asked for: sharper corners than
// `strict_sharper_than` (radians between the legs) are held to kPath.
[[nodiscard]] ToleranceKind kind_at(const Corner& corner, ToleranceKind kind,
                                    double strict_sharper_than);

struct BlendedPath {
  Path pieces;                   // lines and Bezier pieces, joined end to end
  std::vector<double> stations;  // mm along the polyline where they meet: one more than pieces
};

// `blends[i]` replaces vertex i; nothing: the vertex stays. Blends start and end on the segments
// beside their vertex and do not overlap. A ring whose first vertex is blended starts and ends in
// the middle of that blend, any other path in the first (and last) vertex.
//
// The middle of a blend's parameters is at the station of its vertex. Degree 3 or less.
[[nodiscard]] BlendedPath blended_path(std::span<const Point3> distinct,
                                       std::span<const std::optional<BsplineCurve>> blends,
                                       bool ring);

}  // namespace batten::geometry
