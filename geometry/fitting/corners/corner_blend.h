// A corner where two straight legs meet, and a short curve in its place.
//
// All blends are cubic B-splines in the plane of the corner that start on the one leg and end
// on the other. Methods: docs/algorithms/guo.md, docs/algorithms/ozcan.md.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/basic/tolerance_kind.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::geometry {

struct Corner {
  Point3 before;
  Point3 vertex;
  Point3 after;
};

// Why a corner stays as it is.
enum class NoBlend {
  kNoLeg,     // a leg is no longer than rounding noise (kSamePlace)
  kStraight,  // the path goes straight on (half turn below kSameDirection)
  kReversal,  // the path goes back on itself: no curve inside the tolerance leads round
  kNoRoom,    // tolerance or shares of the legs leave less than rounding noise
  kKept,      // turns more than the caller allows
};

// A corner in its own directions.
struct CornerFrame {
  Point3 vertex;
  Vector3 a;  // unit, from the vertex along the leg that arrives, backwards
  Vector3 b;  // unit, from the vertex along the leg that leaves
  double length_a;
  double length_b;
  double sin_half;  // of half the angle between a and b: near 0 at a reversal,
  double cos_half;  // near 0 where the path goes straight on

  // Unit normals to the legs, in the plane of the corner and away from the other leg.
  [[nodiscard]] Vector3 outward_a() const;
  [[nodiscard]] Vector3 outward_b() const;
};

[[nodiscard]] std::variant<CornerFrame, NoBlend> frame_of(const Corner& corner);

// How far blend and corner are apart, mm.
struct BlendDeviation {
  double legs = 0;      // greatest distance of the blend from the nearer leg
  double corner = 0;    // least distance of the blend from the vertex
  double in_order = 0;  // greatest of: the blend up to its place nearest to the vertex from the
                        // one leg, after it from the other, and that place from the vertex
};

// What a tolerance of that kind has to be compared with.
[[nodiscard]] double deviation_of(const BlendDeviation& deviation, ToleranceKind kind);

// By samples that are refined around each extremum, among them every place where a distance has a
// kink; relative error below 1e-9.
//
// `in_order` is the distance taken in order where the feet of the blend on the legs go forward.
// Requires degree 3 or less.
[[nodiscard]] BlendDeviation measure_blend(const BsplineCurve& curve, const CornerFrame& frame);

// The same as deviation_of(measure_blend(curve, frame), kind), for less where only that is asked.
[[nodiscard]] double measure_deviation(const BsplineCurve& curve, const CornerFrame& frame,
                                       ToleranceKind kind);

struct CornerBlend {
  BsplineCurve curve;  // from the leg that arrives to the leg that leaves
  BlendDeviation deviation;
};

// Throws std::invalid_argument when the tolerance is not a positive number.
void require_positive_tolerance(double tolerance, std::string_view caller);

// A polyline with a short curve in the place of each corner: what all corner methods share,
// whatever the curve is.

struct CornerPathOptions {
  double tolerance = 0.01;  // mm
  ToleranceKind kind = ToleranceKind::kPath;
  double keep_corner_angle = 3.2;  // radians: vertices that turn more stay (> pi: none)
  // Radians between the legs: sharper corners are held to ToleranceKind::kPath.
  double strict_sharper_than = 0;
  Seam seam = Seam::kCorner;  // of a path that ends where it begins
};

// The points that are apart from the one before them.
struct DistinctVertices {
  std::vector<Point3> points;
  std::vector<std::size_t> indices;  // of each among the given points

  [[nodiscard]] std::size_t size() const { return points.size(); }
};

[[nodiscard]] DistinctVertices distinct_vertices(std::span<const Point3> points);

// A corner with what it may use of its legs, mm: half of a segment whose other end is a corner
// as well, the whole where the path ends there or the vertex stays as it is.
struct SharedCorner {
  std::size_t vertex;  // index among the distinct vertices
  Corner corner;
  std::variant<CornerFrame, NoBlend> frame;  // or why it stays
  ToleranceKind kind;                        // that it is held to
  double share_before = 0;
  double share_after = 0;
};

// Those of the inner vertices. Linear cost.
[[nodiscard]] std::vector<SharedCorner> shared_corners(std::span<const Point3> distinct,
                                                       const CornerPathOptions& options);

// The corner where a path that ends where it begins has its seam, its leg that arrives being the
// last one; nothing where it stays as it is.
[[nodiscard]] std::optional<SharedCorner> shared_seam(std::span<const Point3> distinct,
                                                      const CornerPathOptions& options);

// A cubic through the vertex itself, as great as the tolerance and the lesser of the shares allow:
// for a seam, where the path begins and ends. Its first and last three control points are on the
// legs, so that it begins and ends with their direction and curvature 0; in the vertex, which is in
// the middle of its parameters, it is square to the bisector, after a swing to the outside of the
// leg. Knots 0 0 0 0 1 2 3 4 4 4 4.
[[nodiscard]] std::optional<CornerBlend> seam_blend(const SharedCorner& seam, double tolerance);

// Whether the legs turn by more than this (radians, 0 straight on, pi back).
[[nodiscard]] bool turns_more(const Corner& corner, double angle);

struct CornerTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  // Leg directions, and mm, that agree in these steps are alike [at 1e-13:
  // OzcanPath.TakesCornersAsAlikeToAMillionth]
  double alike = 1e-6;
  // Relative, of the deviations of one blend at two corners [at 0:
  // OzcanPath.SearchesCornersThatAreAlikeOnce]
  double measuring_noise = 1e-9;
};
inline constexpr CornerTuning kCornerTuning;

// The directions of the legs, in steps of CornerTuning::alike. A blend found for one corner is
// measured for each other one that is alike before it is taken there.
using AlikeLegs = std::array<long long, 6>;
[[nodiscard]] AlikeLegs alike_legs(const CornerFrame& frame);

struct BlendedPath {
  Path pieces;                   // lines and Bezier pieces, joined end to end
  std::vector<double> stations;  // mm along the polyline where they meet: one more than pieces
};

// `blends[i]` replaces vertex i; nothing: the vertex stays. Blends start and end on the segments
// beside their vertex and do not overlap. The path starts in the first vertex and ends in the last.
//
// The middle of a blend's parameters is at the station of its vertex. Degree 3 or less. `seam`:
// that begins with its second half and ends with its first one; of a path that ends where it
// begins.
[[nodiscard]] BlendedPath blended_path(std::span<const Point3> distinct,
                                       std::span<const std::optional<BsplineCurve>> blends,
                                       const CornerBlend* seam = nullptr);

// What a method makes of a path: `Blend` has its curve in `blend.curve`.
template <typename Blend>
struct CornerPath : BlendedPath {
  struct Corner {
    std::size_t vertex;  // index among the given points
    std::variant<Blend, NoBlend> outcome;
  };
  std::vector<Corner> corners;      // in order of their vertices
  std::optional<CornerBlend> seam;  // where the path begins and ends, if it is rounded there
  int searched = 0;                 // corners for which a blend was searched

  // The path with these corners, which are those of the inner vertices.
  void round(const DistinctVertices& vertices) {
    std::vector<std::optional<BsplineCurve>> blends(vertices.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto* blend = std::get_if<Blend>(&corners[i].outcome);
      if (blend != nullptr) blends[i + 1] = blend->blend.curve;
    }
    BlendedPath::operator=(blended_path(vertices.points, blends, seam ? &*seam : nullptr));
  }
};

// Points that are one place with the one before them are passed over and have no corner. The
// shares of two corners never overlap. `blend_of`: what becomes of a SharedCorner with a frame.
template <typename Blend, typename BlendOf>
[[nodiscard]] CornerPath<Blend> path_with_blends(std::span<const Point3> points,
                                                 const CornerPathOptions& options,
                                                 BlendOf&& blend_of) {
  CornerPath<Blend> path;
  const DistinctVertices vertices = distinct_vertices(points);
  for (const SharedCorner& each : shared_corners(vertices.points, options)) {
    const auto* frame = std::get_if<CornerFrame>(&each.frame);
    path.corners.push_back({vertices.indices[each.vertex], NoBlend::kKept});
    path.corners.back().outcome =
        frame != nullptr ? blend_of(each, *frame) : std::get<NoBlend>(each.frame);
  }
  if (const auto seam = shared_seam(vertices.points, options)) {
    path.seam = seam_blend(*seam, options.tolerance);
  }
  path.round(vertices);
  return path;
}

}  // namespace batten::geometry
