#include "geometry/band/tolerance_band.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/band/tolerance_band_pairs.h"
#include "geometry/basic/rounding.h"

namespace batten::geometry {
namespace {

// A path without its repeated places, and where its edges came from.
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

double cross(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

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

// The overlap of one group of pairs.
class OverlapOfGroup {
 public:
  void add(const FlatEdges& edges, const EdgePair& pair) {
    const double distance = edge_distance(edges, pair);
    if (empty_) {
      found_ = {pair.first, pair.first, pair.second, pair.second, distance, pair.first, false};
      empty_ = false;
    }
    found_.first_from = std::min<std::size_t>(found_.first_from, pair.first);
    found_.first_to = std::max<std::size_t>(found_.first_to, pair.first);
    found_.second_from = std::min<std::size_t>(found_.second_from, pair.second);
    found_.second_to = std::max<std::size_t>(found_.second_to, pair.second);
    if (distance < found_.distance) {
      found_.distance = distance;
      found_.edge = pair.first;
    }
    found_.meets_itself = found_.meets_itself || edges_meet(edges, pair);
  }

  // In edges of the given path.
  [[nodiscard]] BandOverlap overlap(std::span<const std::size_t> given) const {
    BandOverlap result = found_;
    for (std::size_t* edge : {&result.first_from, &result.first_to, &result.second_from,
                              &result.second_to, &result.edge}) {
      *edge = given[*edge];
    }
    return result;
  }

 private:
  BandOverlap found_;
  bool empty_ = true;
};

}  // namespace

std::optional<BandStructure> band_structure(std::span<const Point2> points, double tolerance) {
  if (!(tolerance > 0) || !std::isfinite(tolerance)) {
    throw std::invalid_argument(fmt::format(
        "band_structure: tolerance {} mm, expected a finite number above 0", tolerance));
  }
  const Distinct path = distinct(points);
  const double reach = 2 * tolerance;
  const auto pairs = near_pairs(path.edges, reach);
  if (!pairs) return {};
  const std::vector<std::size_t> groups = group_pairs(*pairs, path.edges, reach);
  std::vector<OverlapOfGroup> found;
  for (std::size_t i = 0; i < pairs->size(); ++i) {
    if (groups[i] == 0) continue;
    found.resize(std::max(found.size(), groups[i]));
    found[groups[i] - 1].add(path.edges, (*pairs)[i]);
  }
  BandStructure structure;
  for (const OverlapOfGroup& group : found) structure.overlaps.push_back(group.overlap(path.given));
  structure.cusps = find_cusps(path, tolerance);
  return structure;
}

}  // namespace batten::geometry
