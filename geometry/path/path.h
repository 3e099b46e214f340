// A path as a chain of exact pieces: lines, circular or helical arcs, cubic Bezier pieces. Each
// starts where the one before it ends. A piece is a function of t in [0, 1]; `point_at` meets the
// ends exactly.
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

// An arc about the line through `center` along `axis`; a helix when the ends have different heights
// along it. Angle, height and radius are linear in t: printed numbers make the radii at the ends
// differ in the last decimal, and the piece then is the spiral that meets both.
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
[[nodiscard]] Vector3 direction_at(const CubicBezier& b, double t);

[[nodiscard]] double radius_of(const Arc& arc);  // mm, at its start

// mm. Exact for lines and arcs of constant radius; else by quadrature (relative error below 1e-9).
[[nodiscard]] double length_of(const PathPiece& piece);

// 1/mm at t. 0 on lines.
[[nodiscard]] double curvature_at(const PathPiece& piece, double t);

// Greatest |second derivative by t| over the piece: a chord of width h in t is wrong by at most
// h * h / 8 times this (mm).
[[nodiscard]] double second_derivative_bound(const PathPiece& piece);

// The part of `piece` between two parameters, 0 <= t0 < t1 <= 1, again for t in [0, 1].
[[nodiscard]] PathPiece sub_piece(const PathPiece& piece, double t0, double t1);
[[nodiscard]] CubicBezier sub_piece(const CubicBezier& piece, double t0, double t1);

// Unit, level, to the left of a direction seen from above; zero for one that is upright.
[[nodiscard]] Vector3 left_of(const Vector3& direction);

// The path moved by `distance` (mm, > 0) to that side, at the same height. At a vertex it goes
// round it on an arc of that radius, forwards on the outside and backwards on the inside, so that
// each position belongs to one of the path, in order, and a disc of that radius about it touches
// the path there. It stays where it is while the path goes straight up or down. Nothing for
// paths with Bezier pieces or arcs that do not turn about Z, and for Side::kBoth. Method:
// docs/algorithms/one_side.md.
[[nodiscard]] std::optional<Path> parallel_path(std::span<const PathPiece> path, Side side,
                                                double distance);

}  // namespace batten::geometry
