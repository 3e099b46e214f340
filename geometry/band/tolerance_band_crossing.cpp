#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
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

// What of a path lies in one plane across an axis.
struct Layer {
  FlatEdges edges;
  std::vector<std::size_t> pieces;  // of the path, for each edge
  double height = 0;
};

// Heights are printed, so those of one plane are the same to within the noise of doubles.
using Layers = std::map<double, Layer>;

double rounded(double height) { return std::round(height / kSamePlace) * kSamePlace; }

Point2 across(const Point3& place, int axis) {
  return {place[axis == 0 ? 1 : 0], place[axis == 2 ? 1 : 2]};
}

bool is_flat(const ChordPolyline& chords, std::size_t edge, int axis) {
  return std::abs(chords.points[edge][axis] - chords.points[edge + 1][axis]) <= kSamePlace;
}

Layers layers_of(const ChordPolyline& chords, int axis) {
  Layers layers;
  auto last = layers.end();  // of the edge before: heights change seldom
  for (std::size_t i = 0; i < chords.edge_count(); ++i) {
    if (!is_flat(chords, i, axis)) continue;
    const Point3& from = chords.points[i];
    const double height = rounded(from[axis]);
    if (last == layers.end() || last->first != height) last = layers.try_emplace(height).first;
    Layer& layer = last->second;
    layer.height = from[axis];
    if (layer.edges.add(across(from, axis), across(chords.points[i + 1], axis))) {
      layer.pieces.push_back(chords.pieces[i]);
    }
  }
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

// Calls `found` with each meeting of the new path that the old one does not excuse, and with the
// edges of the old one that may be less than kSameLoop tolerances from it; until it returns false.
template <typename Function>
void each_new(const std::vector<Meeting>& met, const FlatEdges& before, double tolerance,
              const Function& found) {
  const auto old = OldLayer::made_of(before, tolerance);
  if (!old) return;
  std::vector<CrossingBox> places;
  for (std::size_t i = 0; i < met.size(); ++i) {
    const Point2& p = met[i].place;
    places.emplace_back(CGAL::Bbox_2(p.x(), p.y(), p.x(), p.y()), i);
  }
  std::vector<std::vector<std::size_t>> near(met.size());
  std::vector<CrossingBox> edges = old->boxes();
  CGAL::box_intersection_d(places.begin(), places.end(), edges.begin(), edges.end(),
                           [&](const CrossingBox& place, const CrossingBox& edge) {
                             near[place.info()].push_back(edge.info());
                           });
  for (std::size_t i = 0; i < met.size(); ++i) {
    std::sort(near[i].begin(), near[i].end());
    if (!old->meets_itself_at(met[i].place, near[i]) && !found(met[i], near[i])) return;
  }
}

std::optional<Meeting> first_new(const std::vector<Meeting>& met, const FlatEdges& before,
                                 double tolerance) {
  std::optional<Meeting> first;
  each_new(met, before, tolerance, [&](const Meeting& meeting, std::span<const std::size_t>) {
    first = meeting;
    return false;
  });
  return first;
}

// Edges of parts in one plane.
struct PartLayer {
  FlatEdges edges;
  std::vector<PartEdge> parts;  // for each edge
};

std::map<double, PartLayer> part_layers(std::span<const PartEdge> edges) {
  std::map<double, PartLayer> layers;
  for (const PartEdge& edge : edges) {
    PartLayer& layer = layers[edge.height];
    if (layer.edges.add(edge.from, edge.to)) layer.parts.push_back(edge);
  }
  return layers;
}

// Of the old edges about the meeting of two new ones, in their parts.
PartCrossing crossing_of(const PartLayer& old, const PartEdge& first, const PartEdge& second,
                         const Point2& place, std::span<const std::size_t> near, double tolerance) {
  PartCrossing crossing{{}, place};
  for (const std::size_t edge : near) {
    const std::uint32_t part = old.parts[edge].part;
    if (part != first.part && part != second.part) continue;
    if (edge_distance(old.edges, edge, place) > kSameLoop * tolerance) continue;
    crossing.labels.push_back(old.parts[edge].label);
  }
  if (crossing.labels.empty()) crossing.labels = {first.label, second.label};
  std::ranges::sort(crossing.labels);
  crossing.labels.erase(std::unique(crossing.labels.begin(), crossing.labels.end()),
                        crossing.labels.end());
  return crossing;
}

// The axis across which most of the chords lie; Z before Y before X.
int main_axis(const ChordPolyline& chords) {
  int axis = 2;
  std::size_t most = 0;
  for (const int candidate : {2, 1, 0}) {
    std::size_t flat = 0;
    for (std::size_t i = 0; i < chords.edge_count(); ++i) {
      if (is_flat(chords, i, candidate)) ++flat;
    }
    if (flat <= most) continue;
    most = flat;
    axis = candidate;
  }
  return axis;
}

}  // namespace

std::optional<NewCrossing> new_crossing(std::span<const PathPiece> before,
                                        std::span<const PathPiece> after, double tolerance) {
  if (before.empty() || after.empty()) return {};
  const ChordPolyline chords = cut_into_chords(after, kChordPart * tolerance);
  const int axis = main_axis(chords);
  // Of the old path only where the new one meets itself, which is seldom.
  std::optional<Layers> then;
  std::optional<NewCrossing> first;
  for (const auto& [key, layer] : layers_of(chords, axis)) {
    const std::vector<Meeting> met = meetings_of(layer.edges);
    if (met.empty()) continue;
    if (!then) then = layers_of(cut_into_chords(before, kChordPart * tolerance), axis);
    const auto old = then->find(key);
    if (old == then->end()) continue;
    const auto found = first_new(met, old->second.edges, tolerance);
    if (!found) continue;
    NewCrossing crossing{layer.pieces[found->edges.first], layer.pieces[found->edges.second], {}};
    crossing.place[axis] = layer.height;
    crossing.place[axis == 0 ? 1 : 0] = found->place.x();
    crossing.place[axis == 2 ? 1 : 2] = found->place.y();
    if (!first || crossing.first_piece < first->first_piece) first = crossing;
  }
  return first;
}

std::vector<PartEdge> flat_edges(std::span<const PathPiece> path, int axis, double tolerance,
                                 std::uint32_t label, std::uint32_t part) {
  std::vector<PartEdge> edges;
  if (path.empty()) return edges;
  const ChordPolyline chords = cut_into_chords(path, kChordPart * tolerance);
  for (std::size_t i = 0; i < chords.edge_count(); ++i) {
    if (!is_flat(chords, i, axis)) continue;
    const Point3& from = chords.points[i];
    edges.push_back(
        {across(from, axis), across(chords.points[i + 1], axis), rounded(from[axis]), label, part});
  }
  return edges;
}

std::vector<PartCrossing> new_crossings_of_parts(std::span<const PartEdge> before,
                                                 std::span<const PartEdge> after,
                                                 double tolerance) {
  std::vector<PartCrossing> crossings;
  const auto then = part_layers(before);
  for (const auto& [height, layer] : part_layers(after)) {
    std::vector<Meeting> met = meetings_of(layer.edges);
    const auto& parts = layer.parts;
    std::erase_if(met, [&](const Meeting& meeting) {
      return parts[meeting.edges.first].part == parts[meeting.edges.second].part;
    });
    const auto old = then.find(height);
    if (met.empty() || old == then.end()) continue;
    each_new(met, old->second.edges, tolerance,
             [&](const Meeting& meeting, std::span<const std::size_t> near) {
               crossings.push_back(crossing_of(old->second, parts[meeting.edges.first],
                                               parts[meeting.edges.second], meeting.place, near,
                                               tolerance));
               return true;
             });
  }
  return crossings;
}

}  // namespace batten::geometry
