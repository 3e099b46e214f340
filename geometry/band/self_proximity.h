// A long flat path in parts that are smoothed for themselves: where parts come so near to each
// other that their new paths may cross, and whether they do where the old ones did not: what
// new_crossings (tolerance_band.h) says of a path as a whole, without holding the whole. Method:
// docs/algorithms/tolerance_band.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/band/tolerance_band.h"
#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// Some edges of a path that lie in one plane across an axis and within the width of their cover of
// a chord. Points are those of the two other axes, in order.
struct SegmentCluster {
  Point2 from;
  Point2 to;
  double height = 0;        // mm, rounded: along the axis
  std::uint32_t first = 0;  // labels of its edges, inclusive
  std::uint32_t last = 0;
};

// The flat edges of a path as clusters, some twenty edges of a curve each. Edges between which the
// path leaves the plane are not together in one.
class ClusterCover {
 public:
  // `width`: mm, > 0. `axis`: 0, 1 or 2.
  ClusterCover(int axis, double width) : axis_(axis), width_(width) {}

  // Labels never fall along the path.
  void add(const Point3& from, const Point3& to, std::uint32_t label);
  void clear();

  [[nodiscard]] std::size_t edges() const { return edges_; }  // that are flat
  // Nothing where there are more than kMostClusters.
  [[nodiscard]] std::optional<std::vector<SegmentCluster>> clusters() const;

  static constexpr std::size_t kMostClusters = std::size_t{1} << 20;

 private:
  [[nodiscard]] bool goes_on(const Point2& from, const Point2& to, double height) const;
  void narrow(const Point2& to);

  int axis_;
  double width_;
  std::size_t edges_ = 0;
  std::vector<SegmentCluster> clusters_;
  std::size_t of_last_ = 0;  // edges of the last cluster
  // Directions from its begin that pass all of its vertices within the width; nothing: all.
  std::optional<Vector2> right_;
  std::optional<Vector2> left_;
};

// Those that are no further than `reach` (mm) from one of another part of the path, or are in two
// parts themselves; in order. `cuts`: labels at which parts begin, but the first, increasing. None
// where the path lies in a heap (kMostPairs).
[[nodiscard]] std::vector<SegmentCluster> clusters_near_other_parts(
    const std::vector<SegmentCluster>& clusters, std::span<const std::uint32_t> cuts, double reach);

// The part that a label belongs to.
[[nodiscard]] std::uint32_t part_of(std::uint32_t label, std::span<const std::uint32_t> cuts);

struct PartEdge {  // in the plane of a cluster
  Point2 from;
  Point2 to;
  double height = 0;
  std::uint32_t label = 0;
  std::uint32_t part = 0;
};

// The edges of a path in planes across `axis`, arcs and Bezier pieces as chords within a hundredth
// of the tolerance, all with this label and part.
[[nodiscard]] std::vector<PartEdge> flat_edges(std::span<const PathPiece> path, int axis,
                                               double tolerance, std::uint32_t label,
                                               std::uint32_t part);

// Those edges that a path within `distance` (mm) of the edges of the clusters may have there.
[[nodiscard]] std::vector<PartEdge> edges_near(const std::vector<PartEdge>& edges,
                                               std::span<const SegmentCluster> clusters,
                                               double distance);

// Two parts that meet where the old ones did not, by labels of the old edges that are there.
struct PartCrossing {
  std::vector<std::uint32_t> labels;  // of both parts, increasing, each once
  Point2 place;
};

// As new_crossings, but wherever edges of different parts meet. `before` and `after`: the edges, in
// order along the path, that are near to clusters of other parts.
[[nodiscard]] std::vector<PartCrossing> new_crossings_of_parts(std::span<const PartEdge> before,
                                                               std::span<const PartEdge> after,
                                                               double tolerance);

// mm: how near clusters of a cover of this width must be for what happens between their edges to
// matter: twice the width, and ten tolerances.
[[nodiscard]] double reach_between_parts(double width, double tolerance);

}  // namespace batten::geometry
