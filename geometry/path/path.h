// A path as a chain of exact pieces: straight lines, circular or helical arcs, cubic
// Bezier pieces. Each piece starts where the one before it ends.
//
// Every piece is a function of t in [0, 1]; `point_at` meets the ends exactly.
#pragma once

#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/basic/tolerance_kind.h"

namespace batten::geometry {

struct Line {
  Point3 start;
  Point3 end;
};

// An arc about the line through `center` along `axis`; a helix when the ends have
// different heights along it. The angle and the height are linear in t. So is the radius:
// printed numbers make the radii at the two ends differ in the last decimal, and the piece
// then is the spiral that meets both ends.
struct Arc {
  Point3 start;
  Point3 end;
  Point3 center;  // any height along the axis: only its place across the axis counts
  Vector3 axis;   // unit length
  double sweep;   // radians, positive: counter-clockwise seen from the tip of `axis`; never 0
};

struct CubicBezier {
  Point3 control[4];
};

using PathPiece = std::variant<Line, Arc, CubicBezier>;
using Path = std::vector<PathPiece>;

[[nodiscard]] Point3 start_point(const PathPiece& piece);
[[nodiscard]] Point3 end_point(const PathPiece& piece);
[[nodiscard]] Point3 point_at(const PathPiece& piece, double t);
[[nodiscard]] Point3 point_at(const CubicBezier& piece, double t);

// Unit direction of travel at t; the zero vector where the piece has none (zero length).
[[nodiscard]] Vector3 direction_at(const PathPiece& piece, double t);

// mm. Exact for lines and for arcs of constant radius; by quadrature (relative error
// below 1e-9) for spirals and Bezier pieces.
[[nodiscard]] double length_of(const PathPiece& piece);
[[nodiscard]] double length_of(std::span<const PathPiece> path);

// 1/mm at t. 0 on lines.
[[nodiscard]] double curvature_at(const PathPiece& piece, double t);

// Greatest |second derivative by t| over the piece: linear interpolation between the two
// ends of a sub-piece of width h in t is wrong by at most h * h / 8 times this (mm).
[[nodiscard]] double second_derivative_bound(const PathPiece& piece);

// The part of `piece` between two parameters, 0 <= t0 < t1 <= 1, again for t in [0, 1].
[[nodiscard]] PathPiece sub_piece(const PathPiece& piece, double t0, double t1);
[[nodiscard]] CubicBezier sub_piece(const CubicBezier& piece, double t0, double t1);

// The path beside another one: every place of it moved sideways by the same distance.
// Method: docs/algorithms/one_side.md.

// Unit, level, to the left of a direction seen from above; zero for one that is upright.
[[nodiscard]] Vector3 left_of(const Vector3& direction);

// `distance` (mm, > 0) to that side, at the same height. At a vertex it goes round it on an arc of
// that radius, forwards on the outside and backwards on the inside, so that each of its places
// belongs to one of the path, in order, and a disc of that radius about it touches the path there.
// Where the path goes straight up or down it stays beside the place where it was.
//
// Nothing for paths with Bezier pieces, or with arcs that do not turn about Z, and for
// Side::kBoth.
[[nodiscard]] std::optional<Path> parallel_path(std::span<const PathPiece> path, Side side,
                                                double distance);

}  // namespace batten::geometry
