// Which edges of a flat path are near to each other, and which of these pairs belong together: for
// geometry/band/*.cpp only.
#pragma once

#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"

namespace batten::geometry {

// The two other coordinates.
[[nodiscard]] inline Point2 across(const Point3& place, int axis) {
  return {place[axis == 0 ? 1 : 0], place[axis == 2 ? 1 : 2]};
}

// Heights are printed, so those of one plane are the same to within the noise of doubles.
[[nodiscard]] inline double plane_height(double height) {
  return std::round(height / kSamePlace) * kSamePlace;
}

// Edges of a flat path in order. It may be in several chains: where it left the plane between.
class FlatEdges {
 public:
  // Goes on with the last chain where that ends at `from`, else starts another one. Returns whether
  // there is an edge: not where the two are one point.
  bool add(const Point2& from, const Point2& to);

  [[nodiscard]] std::size_t size() const { return chain_.size(); }
  [[nodiscard]] const Point2& from(std::size_t edge) const { return points_[edge + chain_[edge]]; }
  [[nodiscard]] const Point2& to(std::size_t edge) const {
    return points_[edge + chain_[edge] + 1];
  }

  // The edge that starts where this one ends, along the path or round a closed chain; also round a
  // path that ends where it began and left the plane between.
  [[nodiscard]] std::optional<std::size_t> after(std::size_t edge) const;

 private:
  [[nodiscard]] bool is_closed(std::size_t chain) const;

  std::vector<Point2> points_;        // of each chain one more than it has edges
  std::vector<std::uint32_t> chain_;  // of each edge
  std::vector<std::size_t> first_;    // edge of each chain
};

struct EdgePair {
  std::uint32_t first = 0;
  std::uint32_t second = 0;  // above `first`
  friend auto operator<=>(const EdgePair& a,
                          const EdgePair& b) = default;  // NOLINT(modernize-use-nullptr)
};

inline constexpr std::size_t kMostPairs = 200;  // for each edge; more are a heap

// All pairs of edges, neighbours too, whose distance is at most `reach` (mm), sorted. Nothing when
// there are more than kMostPairs for each edge.
[[nodiscard]] std::optional<std::vector<EdgePair>> near_pairs(const FlatEdges& edges, double reach);

// The number of the group of each pair of near_pairs with that reach, from 0 in order of the first
// pairs. Two are in one group when one can walk from one to the other along both edges without ever
// being further apart than `reach`. Group 0 holds all pairs of neighbours and what is reached from
// them: the path beside itself.
[[nodiscard]] std::vector<std::size_t> group_pairs(std::span<const EdgePair> pairs,
                                                   const FlatEdges& edges, double reach);

// Whether the edges of the pair have more in common than the vertex that neighbours share: they
// cross, touch, or run over each other. Exact.
[[nodiscard]] bool edges_meet(const FlatEdges& edges, const EdgePair& pair);

// mm, of the two edges, and of a point and an edge.
[[nodiscard]] double edge_distance(const FlatEdges& edges, const EdgePair& pair);
[[nodiscard]] double edge_distance(const FlatEdges& edges, std::size_t edge, const Point2& place);

// A point that both edges have; the middle where they run over each other. Requires edges_meet.
[[nodiscard]] Point2 meeting_place(const FlatEdges& edges, const EdgePair& pair);

}  // namespace batten::geometry
