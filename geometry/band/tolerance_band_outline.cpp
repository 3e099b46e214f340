#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_set_2.h>

#include <cmath>
#include <cstddef>
#include <iterator>
#include <new>
#include <numbers>

#include "geometry/band/tolerance_band.h"
#include "geometry/basic/require.h"
#include "geometry/basic/rounding.h"

namespace batten::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Polygon = CGAL::Polygon_2<Kernel>;
using PolygonSet = CGAL::Polygon_set_2<Kernel>;
using PolygonWithHoles = CGAL::Polygon_with_holes_2<Kernel>;

constexpr int kSidesOfRound = 12;  // of half a circle: 15 degrees each

// Half a circle of corners about `center` that starts in direction `angle`, counter-clockwise.
void add_round(Polygon& polygon, const Point2& center, double angle, double radius) {
  for (int k = 0; k <= kSidesOfRound; ++k) {
    const double a = angle + std::numbers::pi * k / kSidesOfRound;
    polygon.push_back({center.x() + radius * std::cos(a), center.y() + radius * std::sin(a)});
  }
}

// All places within the tolerance of the edge.
Polygon capsule(const Point2& from, const Point2& to, double tolerance) {
  // The polygon lies around its circle: its corners outside by 0.9 % of the radius.
  const double radius = tolerance / std::cos(std::numbers::pi / (2 * kSidesOfRound));
  const Point2 along = to - from;
  const double angle = std::atan2(along.y(), along.x());
  Polygon polygon;
  add_round(polygon, to, angle - std::numbers::pi / 2, radius);
  add_round(polygon, from, angle + std::numbers::pi / 2, radius);
  return polygon;
}

// The exact numbers of an edge took 9 kB of memory where 10,000 were joined; and the stack grows.
constexpr std::size_t kBytesPerEdge = 20'000;
constexpr std::size_t kBytesBeside = 8'000'000;

// Exact numbers end the process where there is no memory for them. So it is asked for before, by
// calls that nothing leaves out: throws std::bad_alloc where it is missing.
void require_memory(std::size_t edges) {
  ::operator delete(::operator new(kBytesBeside + kBytesPerEdge * edges));
}

std::vector<Point2> corners_of(const Polygon& polygon) {
  std::vector<Point2> corners;
  for (const auto& p : polygon.vertices()) {
    corners.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()));
  }
  return corners;
}

}  // namespace

std::vector<std::vector<Point2>> band_outline(std::span<const Point2> points, double tolerance) {
  require(tolerance > 0 && std::isfinite(tolerance), "band_outline: tolerance", tolerance,
          "a finite number above 0");
  require_memory(points.size());
  std::vector<Polygon> capsules;
  std::size_t last = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if ((points[i] - points[last]).norm() <= kSamePlace) continue;
    capsules.push_back(capsule(points[last], points[i], tolerance));
    last = i;
  }
  PolygonSet band;
  band.join(capsules.begin(), capsules.end());
  std::vector<PolygonWithHoles> parts;
  band.polygons_with_holes(std::back_inserter(parts));
  std::vector<std::vector<Point2>> outline;
  for (const PolygonWithHoles& part : parts) {
    outline.push_back(corners_of(part.outer_boundary()));
    for (const Polygon& hole : part.holes()) outline.push_back(corners_of(hole));
  }
  return outline;
}

}  // namespace batten::geometry
