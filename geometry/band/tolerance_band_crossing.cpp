#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "geometry/band/self_proximity.h"
#include "geometry/band/tolerance_band.h"
#include "geometry/band/tolerance_band_pairs.h"
#include "geometry/basic/rounding.h"
#include "geometry/distance/chord_polyline.h"

namespace batten::geometry {
namespace {

using CrossingBox = CGAL::Box_intersection_d::Box_with_info_d<double, 2, std::size_t>;

// Chords may be this part of the tolerance off the pieces they stand for.
constexpr double kChordPart = 0.01;

// A loop that the old path makes within its own band moves by no more than some tolerances: it
// fits into a circle of twice the tolerance, and either of its sides moves by one.
constexpr double kSameLoop = 4;

// What an edge belongs to (PartEdge).
struct EdgeOwner {
  std::uint32_t label = 0;
  std::uint32_t part = 0;
};

// What lies in one plane across an axis.
struct Layer {
  FlatEdges edges;
  std::vector<EdgeOwner> owners;  // of each edge

  void add(const PartEdge& edge) {
    if (edges.add(edge.from, edge.to)) owners.push_back({edge.label, edge.part});
  }
};

using Layers = std::map<double, Layer>;  // by plane_height

Layers layers_of(std::span<const PartEdge> edges) {
  Layers layers;
  for (const PartEdge& edge : edges) layers[edge.height].add(edge);
  return layers;
}

bool is_flat(const ChordPolyline& chords, std::size_t edge, int axis) {
  return std::abs(chords.points[edge][axis] - chords.points[edge + 1][axis]) <= kSamePlace;
}

// Those in planes across the axis, with pieces as labels.
template <typename Take>
void each_flat_edge(const ChordPolyline& chords, int axis, const Take& take) {
  for (std::size_t i = 0; i < chords.edge_count(); ++i) {
    if (!is_flat(chords, i, axis)) continue;
    const Point3& from = chords.points[i];
    take(PartEdge{across(from, axis), across(chords.points[i + 1], axis), plane_height(from[axis]),
                  static_cast<std::uint32_t>(chords.pieces[i]), 0});
  }
}

// mm, of the chords of a path: as many as a path may have take them all together.
double chord_error_of(const PathSource& path, double tolerance) {
  double wanted = 0;
  for (std::size_t i = 0; i < path.size; ++i) {
    wanted += chords_wanted(path.piece(i), kChordPart * tolerance);
  }
  return affordable_error(wanted, kChordPart * tolerance);
}

// Calls `use` with some of its chords after the other, whose pieces are numbered from `first` on.
template <typename Use>
void each_part_in_chords(const PathSource& path, double max_error, const Use& use) {
  constexpr std::size_t kAtOnce = 256;
  std::vector<PathPiece> pieces;
  for (std::size_t first = 0; first < path.size; first += kAtOnce) {
    const std::size_t end = std::min(first + kAtOnce, path.size);
    const std::size_t from = first == 0 ? 0 : first - 1;  // a gap between two parts is a line
    pieces.clear();
    for (std::size_t i = from; i < end; ++i) pieces.push_back(path.piece(i));
    if (from < first) {
      const Point3 joint = end_point(pieces.front());
      pieces.front() = Line{joint, joint};
    }
    use(cut_into_chords(pieces, max_error), from);
  }
}

Layers layers_of(const PathSource& path, int axis, double max_error) {
  Layers layers;
  each_part_in_chords(path, max_error, [&](const ChordPolyline& chords, std::size_t first) {
    each_flat_edge(chords, axis, [&](PartEdge edge) {
      edge.label += static_cast<std::uint32_t>(first);
      layers[edge.height].add(edge);
    });
  });
  return layers;
}

// What the old path does where bands overlap.
class OldLayer {
 public:
  // Nothing when it lies in a heap.
  static std::optional<OldLayer> made_of(const FlatEdges& edges, double tolerance) {
    const double reach = 2 * (1 + kChordPart) * tolerance;
    auto pairs = near_pairs(edges, reach);
    if (!pairs) return {};
    std::vector<std::size_t> groups = group_pairs(*pairs, edges, reach);
    return OldLayer(edges, std::move(*pairs), std::move(groups), tolerance);
  }

  // Whether the old path meets itself where two of its parts may have come to `place`. `near`: its
  // edges that may be less than kSameLoop tolerances from there, sorted.
  [[nodiscard]] bool meets_itself_at(const Point2& place, std::span<const std::size_t> near) const {
    for (std::size_t i = 0; i < near.size(); ++i) {
      const double first = edge_distance(edges_, near[i], place);
      if (first > kSameLoop * tolerance_) continue;
      for (std::size_t k = i + 1; k < near.size(); ++k) {
        const double second = edge_distance(edges_, near[k], place);
        if (second > kSameLoop * tolerance_) continue;
        const EdgePair pair{static_cast<std::uint32_t>(near[i]),
                            static_cast<std::uint32_t>(near[k])};
        if (excuses(pair, std::max(first, second))) return true;
      }
    }
    return false;
  }

  [[nodiscard]] std::vector<CrossingBox> boxes() const {
    std::vector<CrossingBox> result;
    const double margin = kSameLoop * tolerance_;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const Point2 low = edges_.from(i).cwiseMin(edges_.to(i));
      const Point2 high = edges_.from(i).cwiseMax(edges_.to(i));
      result.emplace_back(
          CGAL::Bbox_2(low.x() - margin, low.y() - margin, high.x() + margin, high.y() + margin),
          i);
    }
    return result;
  }

 private:
  OldLayer(const FlatEdges& edges, std::vector<EdgePair> pairs, std::vector<std::size_t> groups,
           double tolerance)
      : edges_(edges),
        pairs_(std::move(pairs)),
        groups_(std::move(groups)),
        meets_(groups_.size() + 1, false),
        tolerance_(tolerance) {
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (!edges_meet(edges_, pairs_[i])) continue;
      met_.push_back(pairs_[i]);
      if (groups_[i] > 0) meets_[groups_[i]] = true;
    }
  }

  // `distance`: of the place from the farther edge of the pair.
  [[nodiscard]] bool excuses(const EdgePair& pair, double distance) const {
    if (std::binary_search(met_.begin(), met_.end(), pair)) return true;
    if (distance > (1 + 2 * kChordPart) * tolerance_) return false;
    const auto found = std::lower_bound(pairs_.begin(), pairs_.end(), pair);
    if (found == pairs_.end() || *found != pair) return false;
    return meets_[groups_[static_cast<std::size_t>(found - pairs_.begin())]];
  }

  const FlatEdges& edges_;
  std::vector<EdgePair> pairs_;
  std::vector<std::size_t> groups_;
  std::vector<bool> meets_;    // by group: whether its two parts meet anywhere
  std::vector<EdgePair> met_;  // the pairs that do, sorted
  double tolerance_;
};

struct Meeting {
  EdgePair edges;
  Point2 place;
  std::vector<std::size_t> near = {};  // old edges that may be less than kSameLoop tolerances off
};

std::vector<Meeting> meetings_of(const FlatEdges& edges) {
  std::vector<Meeting> met;
  const auto touching = near_pairs(edges, 0);
  if (!touching) return met;
  for (const EdgePair& pair : *touching) {
    if (edges_meet(edges, pair)) met.push_back({pair, meeting_place(edges, pair)});
  }
  return met;
}

// Those of the new path that the old one does not excuse.
std::vector<Meeting> new_ones(std::vector<Meeting> met, const FlatEdges& before, double tolerance) {
  const auto old = OldLayer::made_of(before, tolerance);
  if (!old) return {};
  std::vector<CrossingBox> places;
  for (std::size_t i = 0; i < met.size(); ++i) {
    const Point2& p = met[i].place;
    places.emplace_back(CGAL::Bbox_2(p.x(), p.y(), p.x(), p.y()), i);
  }
  std::vector<CrossingBox> edges = old->boxes();
  CGAL::box_intersection_d(places.begin(), places.end(), edges.begin(), edges.end(),
                           [&](const CrossingBox& place, const CrossingBox& edge) {
                             met[place.info()].near.push_back(edge.info());
                           });
  std::erase_if(met, [&](Meeting& meeting) {
    std::ranges::sort(meeting.near);
    return old->meets_itself_at(meeting.place, meeting.near);
  });
  return met;
}

// Of the old edges about the meeting of two new ones, in their parts.
PartCrossing crossing_of(const Layer& old, const EdgeOwner& first, const EdgeOwner& second,
                         const Meeting& meeting, double tolerance) {
  PartCrossing crossing{{}, meeting.place};
  for (const std::size_t edge : meeting.near) {
    const auto [label, part] = old.owners[edge];
    if (part != first.part && part != second.part) continue;
    if (edge_distance(old.edges, edge, meeting.place) > kSameLoop * tolerance) continue;
    crossing.labels.push_back(label);
  }
  if (crossing.labels.empty()) crossing.labels = {first.label, second.label};
  std::ranges::sort(crossing.labels);
  crossing.labels.erase(std::unique(crossing.labels.begin(), crossing.labels.end()),
                        crossing.labels.end());
  return crossing;
}

// The axis across which most of the chords lie; Z before Y before X.
int main_axis(const PathSource& path, double max_error) {
  std::array<std::size_t, 3> flat{};
  each_part_in_chords(path, max_error, [&](const ChordPolyline& chords, std::size_t) {
    for (std::size_t axis = 0; axis < flat.size(); ++axis) {
      for (std::size_t i = 0; i < chords.edge_count(); ++i) {
        if (is_flat(chords, i, static_cast<int>(axis))) ++flat[axis];
      }
    }
  });
  int most = 2;
  for (const int axis : {1, 0}) {
    if (flat[static_cast<std::size_t>(axis)] > flat[static_cast<std::size_t>(most)]) most = axis;
  }
  return most;
}

}  // namespace

std::vector<NewCrossing> new_crossings(const PathSource& before, const PathSource& after,
                                       double tolerance) {
  const double max_error = chord_error_of(after, tolerance);
  const int axis = main_axis(after, max_error);
  // Of the old path only where the new one meets itself, which is seldom.
  std::optional<Layers> then;
  std::map<std::pair<std::size_t, std::size_t>, NewCrossing> all;  // by pieces
  for (const auto& [height, layer] : layers_of(after, axis, max_error)) {
    std::vector<Meeting> met = meetings_of(layer.edges);
    if (met.empty()) continue;
    if (!then) then = layers_of(before, axis, chord_error_of(before, tolerance));
    const auto old = then->find(height);
    if (old == then->end()) continue;
    for (const Meeting& meeting : new_ones(std::move(met), old->second.edges, tolerance)) {
      const auto [a, b] = meeting.edges;
      NewCrossing crossing{layer.owners[a].label, layer.owners[b].label};
      crossing.place[axis] = height;
      crossing.place[axis == 0 ? 1 : 0] = meeting.place.x();
      crossing.place[axis == 2 ? 1 : 2] = meeting.place.y();
      all.try_emplace({crossing.first_piece, crossing.second_piece}, crossing);
    }
  }
  std::vector<NewCrossing> sorted;
  sorted.reserve(all.size());
  for (const auto& [pieces, crossing] : all) sorted.push_back(crossing);
  return sorted;
}

std::vector<PartEdge> flat_edges(std::span<const PathPiece> path, int axis, double tolerance,
                                 std::uint32_t label, std::uint32_t part) {
  if (path.empty()) return {};
  std::vector<PartEdge> edges;
  each_flat_edge(cut_into_chords(path, kChordPart * tolerance), axis, [&](PartEdge edge) {
    edge.label = label;
    edge.part = part;
    edges.push_back(edge);
  });
  return edges;
}

std::vector<PartCrossing> new_crossings_of_parts(std::span<const PartEdge> before,
                                                 std::span<const PartEdge> after,
                                                 double tolerance) {
  std::vector<PartCrossing> crossings;
  const Layers then = layers_of(before);
  for (const auto& [height, layer] : layers_of(after)) {
    std::vector<Meeting> met = meetings_of(layer.edges);
    const auto& owners = layer.owners;
    std::erase_if(met, [&](const Meeting& meeting) {
      return owners[meeting.edges.first].part == owners[meeting.edges.second].part;
    });
    const auto old = then.find(height);
    if (met.empty() || old == then.end()) continue;
    for (const Meeting& meeting : new_ones(std::move(met), old->second.edges, tolerance)) {
      const auto& [a, b] = meeting.edges;
      crossings.push_back(crossing_of(old->second, owners[a], owners[b], meeting, tolerance));
    }
  }
  return crossings;
}

}  // namespace batten::geometry
