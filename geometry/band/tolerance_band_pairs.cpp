#include "geometry/band/tolerance_band_pairs.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/basic/rounding.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {
namespace {

using PairKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Segment = PairKernel::Segment_2;
using PairBox = CGAL::Box_intersection_d::Box_with_info_d<double, 2, std::uint32_t>;

PairKernel::Point_2 to_cgal(const Point2& p) { return {p.x(), p.y()}; }

// A cell is so many boxes wide: most boxes are in one or two cells then. Cells for each box at
// most, for paths that fill little of the area around them.
constexpr double kBoxesPerCell = 2;
constexpr double kCellsPerBox = 2;

// Beyond these a grid is no help: cells that one box is in, and pairs that one box is asked for.
constexpr std::size_t kMostCellsPerBox = 8;
constexpr std::size_t kMostAskedPerBox = 64;

// Calls `found` once for each two boxes that overlap, in linear time where they are of about one
// size. False, without a call, where there are so many sizes or heaps that a grid would be slow.
template <typename Function>
bool each_pair_in_grid(std::span<const PairBox> boxes, const Function& found) {
  Point2 corner(boxes[0].min_coord(0), boxes[0].min_coord(1));
  Point2 end = corner;
  double sizes = 0;
  for (const PairBox& box : boxes) {
    const Point2 low(box.min_coord(0), box.min_coord(1));
    const Point2 high(box.max_coord(0), box.max_coord(1));
    corner = corner.cwiseMin(low);
    end = end.cwiseMax(high);
    sizes += (high - low).maxCoeff();
  }
  const Vector2 all = end - corner;
  const auto count = static_cast<double>(boxes.size());
  const double most_cells = kCellsPerBox * count;
  // In one direction alone and in both: no more cells than that.
  double size = std::max({kBoxesPerCell * sizes / count, std::sqrt(all.x() * all.y() / most_cells),
                          all.maxCoeff() / most_cells});
  if (!(size > 0)) size = 1;  // all are one point
  const auto index = [&](double at, int k) {
    return static_cast<std::size_t>((at - corner[k]) / size);
  };
  const std::size_t columns = index(end.x(), 0) + 1;
  const auto each_cell = [&](const PairBox& box, const auto& visit) {
    const std::size_t last_column = index(box.max_coord(0), 0);
    const std::size_t last_row = index(box.max_coord(1), 1);
    for (std::size_t row = index(box.min_coord(1), 1); row <= last_row; ++row) {
      for (std::size_t c = index(box.min_coord(0), 0); c <= last_column; ++c) {
        visit(row * columns + c);
      }
    }
  };
  std::vector<std::size_t> ends(columns * (index(end.y(), 1) + 1), 0);  // of the cells in `inside`
  std::size_t entries = 0;
  for (const PairBox& box : boxes) {
    each_cell(box, [&](std::size_t cell) { ++ends[cell], ++entries; });
    if (entries > kMostCellsPerBox * boxes.size()) return false;
  }
  std::size_t before = 0;
  std::size_t asked = 0;
  for (std::size_t& cell : ends) {  // for now where it begins
    asked += cell * cell / 2;
    before += std::exchange(cell, before);
  }
  if (asked > kMostAskedPerBox * boxes.size()) return false;
  std::vector<const PairBox*> inside(entries);
  for (const PairBox& box : boxes) {
    each_cell(box, [&](std::size_t cell) { inside[ends[cell]++] = &box; });
  }
  for (std::size_t cell = 0, i = 0; cell < ends.size(); ++cell) {
    for (; i < ends[cell]; ++i) {
      for (std::size_t k = i + 1; k < ends[cell]; ++k) {
        const PairBox& a = *inside[i];
        const PairBox& b = *inside[k];
        const double x = std::max(a.min_coord(0), b.min_coord(0));
        const double y = std::max(a.min_coord(1), b.min_coord(1));
        if (x > std::min(a.max_coord(0), b.max_coord(0))) continue;
        if (y > std::min(a.max_coord(1), b.max_coord(1))) continue;
        // They may be together in other cells too: this one has the lower corner of what they
        // share.
        if (index(y, 1) * columns + index(x, 0) == cell) found(a, b);
      }
    }
  }
  return true;
}

Segment segment_of(const FlatEdges& edges, std::size_t edge) {
  return {to_cgal(edges.from(edge)), to_cgal(edges.to(edge))};
}

bool share_a_vertex(const FlatEdges& edges, std::size_t a, std::size_t b) {
  return edges.to(a) == edges.from(b) || edges.to(b) == edges.from(a);
}

// Puts pairs together whose edges are neighbours.
class Grouping {
 public:
  Grouping(std::span<const EdgePair> pairs, const FlatEdges& edges, double reach)
      : pairs_(pairs), edges_(edges), reach_(reach), parent_(pairs.size()) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  // What of two edges is near to each other is a convex part of the square of their parameters. So
  // the parts of two pairs join where a vertex between them is near to the other edge.
  std::vector<std::size_t> run() {
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto [first, second] = pairs_[i];
      const auto after_first = edges_.after(first);
      const auto after_second = edges_.after(second);
      if (after_first == second || after_second == first) {
        if (beside_) join(*beside_, i);
        beside_ = i;
      }
      if (after_first && edge_distance(edges_, second, edges_.to(first)) <= reach_) {
        join(i, *after_first, second);
      }
      if (after_second && edge_distance(edges_, first, edges_.to(second)) <= reach_) {
        join(i, first, *after_second);
      }
    }
    return numbers();
  }

 private:
  void join(std::size_t pair, std::size_t a, std::size_t b) {
    if (a == b) return;
    const EdgePair wanted{static_cast<std::uint32_t>(std::min(a, b)),
                          static_cast<std::uint32_t>(std::max(a, b))};
    const auto found = std::lower_bound(pairs_.begin(), pairs_.end(), wanted);
    if (found == pairs_.end() || *found != wanted) return;
    join(pair, static_cast<std::size_t>(found - pairs_.begin()));
  }

  // The root with the lower number stays, so that it is the first of its group.
  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  std::size_t root(std::size_t i) {
    for (; parent_[i] != i; i = parent_[i]) parent_[i] = parent_[parent_[i]];
    return i;
  }

  std::vector<std::size_t> numbers() {
    std::vector<std::size_t> result(pairs_.size(), 0);
    std::size_t next = 1;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const std::size_t of = root(i);
      if (beside_ && of == root(*beside_)) continue;
      result[i] = of == i ? next++ : result[of];
    }
    return result;
  }

  std::span<const EdgePair> pairs_;
  const FlatEdges& edges_;
  double reach_;
  std::vector<std::size_t> parent_;    // of pairs that belong together
  std::optional<std::size_t> beside_;  // a pair of neighbours
};

// The path turns right back at the vertex that two neighbours share.
bool folds(const FlatEdges& edges, std::size_t before, std::size_t after) {
  const PairKernel::Point_2 start = to_cgal(edges.from(before));
  const PairKernel::Point_2 vertex = to_cgal(edges.to(before));
  const PairKernel::Point_2 end = to_cgal(edges.to(after));
  return CGAL::collinear(start, vertex, end) && CGAL::angle(start, vertex, end) == CGAL::ACUTE;
}

}  // namespace

bool FlatEdges::add(const Point2& from, const Point2& to) {
  if ((from - to).norm() <= kSamePlace) return false;
  const bool goes_on = size() > 0 && (points_.back() - from).norm() <= kSamePlace;
  if (!goes_on) {
    first_.push_back(size());
    points_.push_back(from);
  }
  points_.push_back(to);
  chain_.push_back(static_cast<std::uint32_t>(first_.size() - 1));
  return true;
}

bool FlatEdges::is_closed(std::size_t chain) const {
  const std::size_t first = first_[chain];
  const std::size_t end = chain + 1 < first_.size() ? first_[chain + 1] : size();
  return end - first > 2 && (from(first) - to(end - 1)).norm() <= kSamePlace;
}

std::optional<std::size_t> FlatEdges::after(std::size_t edge) const {
  const std::size_t chain = chain_[edge];
  if (edge + 1 < size() && chain_[edge + 1] == chain) return edge + 1;
  if (is_closed(chain)) return first_[chain];
  // A ring that left the plane for a while is closed where its last chain meets the first one.
  const bool is_last = edge + 1 == size() && first_.size() > 1;
  if (is_last && (from(0) - to(edge)).norm() <= kSamePlace) return 0;
  return {};
}

std::optional<std::vector<EdgePair>> near_pairs(const FlatEdges& edges, double reach) {
  std::vector<EdgePair> pairs;
  if (edges.size() == 0) return pairs;
  std::vector<PairBox> boxes;
  boxes.reserve(edges.size());
  const Vector2 margin(reach / 2, reach / 2);
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    const Point2 low = edges.from(i).cwiseMin(edges.to(i)) - margin;
    const Point2 high = edges.from(i).cwiseMax(edges.to(i)) + margin;
    boxes.emplace_back(CGAL::Bbox_2(low.x(), low.y(), high.x(), high.y()), i);
  }
  struct TooMany {};  // ends a search that finds too much
  const auto found = [&](const PairBox& a, const PairBox& b) {
    const EdgePair pair{std::min(a.info(), b.info()), std::max(a.info(), b.info())};
    const bool neighbours = share_a_vertex(edges, pair.first, pair.second);
    if (!neighbours && edge_distance(edges, pair) > reach) return;
    pairs.push_back(pair);
    if (pairs.size() > kMostPairs * edges.size()) throw TooMany{};
  };
  try {
    if (!each_pair_in_grid(boxes, found)) {
      CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), found);
    }
  } catch (const TooMany&) {
    return {};
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<std::size_t> group_pairs(std::span<const EdgePair> pairs, const FlatEdges& edges,
                                     double reach) {
  return Grouping(pairs, edges, reach).run();
}

bool edges_meet(const FlatEdges& edges, const EdgePair& pair) {
  if (edges.after(pair.first) == pair.second) return folds(edges, pair.first, pair.second);
  if (edges.after(pair.second) == pair.first) return folds(edges, pair.second, pair.first);
  return CGAL::do_intersect(segment_of(edges, pair.first), segment_of(edges, pair.second));
}

double edge_distance(const FlatEdges& edges, const EdgePair& pair) {
  return std::sqrt(
      CGAL::squared_distance(segment_of(edges, pair.first), segment_of(edges, pair.second)));
}

double edge_distance(const FlatEdges& edges, std::size_t edge, const Point2& place) {
  return std::sqrt(CGAL::squared_distance(segment_of(edges, edge), to_cgal(place)));
}

Point2 meeting_place(const FlatEdges& edges, const EdgePair& pair) {
  const Segment a = segment_of(edges, pair.first);
  const auto common = CGAL::intersection(a, segment_of(edges, pair.second));
  PairKernel::Point_2 place = a.source();
  if (common) {
    if (const auto* point = boost::get<PairKernel::Point_2>(&*common)) {
      place = *point;
    } else {
      const auto& shared = boost::get<Segment>(*common);
      place = CGAL::midpoint(shared.source(), shared.target());
    }
  }
  return {place.x(), place.y()};
}

}  // namespace batten::geometry
