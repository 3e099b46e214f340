#include "geometry/band/tolerance_band.h"

#include <algorithm>
#include <cmath>

#include "geometry/band/tolerance_band_pairs.h"
#include "geometry/basic/require.h"
#include "geometry/basic/rounding.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {
namespace {

// A path without its repeated points, and where its edges came from.
struct Distinct {
  FlatEdges edges;
  std::vector<std::size_t> given;  // the edge of the given path, for each edge
};

Distinct distinct(std::span<const Point2> points) {
  Distinct result;
  std::size_t last = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (!result.edges.add(points[last], points[i])) continue;
    result.given.push_back(i - 1);
    last = i;
  }
  return result;
}

// tan of half the turn at the end of the edge; positive to the left. A turn right back counts as
// very great.
double half_turn(const FlatEdges& edges, std::size_t edge) {
  const Point2 in = (edges.to(edge) - edges.from(edge)).normalized();
  const Point2 out = (edges.to(edge + 1) - edges.from(edge + 1)).normalized();
  return cross(in, out) / std::max(1 + in.dot(out), kSameDirection);
}

std::vector<BandCusp> find_cusps(const Distinct& path, double tolerance) {
  std::vector<BandCusp> cusps;
  if (path.edges.size() < 3) return cusps;
  double at_end = half_turn(path.edges, 0);
  for (std::size_t i = 1; i + 1 < path.edges.size(); ++i) {
    const double at_start = at_end;
    at_end = half_turn(path.edges, i);
    if (!(at_start * at_end > 0)) continue;
    const double length = (path.edges.to(i) - path.edges.from(i)).norm();
    if (length > tolerance * std::abs(at_start + at_end)) continue;
    cusps.push_back({path.given[i], at_start > 0});
  }
  return cusps;
}

// Takes a pair into the overlap of its group.
void add_pair(std::optional<BandOverlap>& overlap, const FlatEdges& edges, const EdgePair& pair) {
  const double distance = edge_distance(edges, pair);
  const std::size_t first = pair.first;
  const std::size_t second = pair.second;
  if (!overlap) overlap = {first, first, second, second, distance, first, false};
  overlap->first_from = std::min(overlap->first_from, first);
  overlap->first_to = std::max(overlap->first_to, first);
  overlap->second_from = std::min(overlap->second_from, second);
  overlap->second_to = std::max(overlap->second_to, second);
  if (distance < overlap->distance) {
    overlap->distance = distance;
    overlap->edge = first;
  }
  overlap->meets_itself = overlap->meets_itself || edges_meet(edges, pair);
}

}  // namespace

std::optional<BandStructure> band_structure(std::span<const Point2> points, double tolerance) {
  require(tolerance > 0 && std::isfinite(tolerance), "band_structure: tolerance", tolerance,
          "a finite number above 0");
  const Distinct path = distinct(points);
  const double reach = 2 * tolerance;
  const auto pairs = near_pairs(path.edges, reach);
  if (!pairs) return {};
  const std::vector<std::size_t> groups = group_pairs(*pairs, path.edges, reach);
  std::vector<std::optional<BandOverlap>> found;
  for (std::size_t i = 0; i < pairs->size(); ++i) {
    if (groups[i] == 0) continue;
    found.resize(std::max(found.size(), groups[i]));
    add_pair(found[groups[i] - 1], path.edges, (*pairs)[i]);
  }
  BandStructure structure;
  for (const auto& group : found) {
    BandOverlap overlap = group.value();
    for (std::size_t* edge : {&overlap.first_from, &overlap.first_to, &overlap.second_from,
                              &overlap.second_to, &overlap.edge}) {
      *edge = path.given[*edge];
    }
    structure.overlaps.push_back(overlap);
  }
  structure.cusps = find_cusps(path, tolerance);
  return structure;
}

}  // namespace batten::geometry
