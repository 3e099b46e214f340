#include "geometry/band/self_proximity.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/band/tolerance_band_pairs.h"
#include "geometry/basic/rounding.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {
namespace {

// A cluster is copied as a whole where it has to be.
constexpr std::size_t kMostOfACluster = 64;

// Crossings are excused by what the old path does within four tolerances of them, which are within
// one of it: all that has to do with one is within ten.
constexpr double kTolerancesOfReach = 10;

Vector2 turned(const Vector2& v, double sine, double cosine) {
  return {cosine * v.x() - sine * v.y(), sine * v.x() + cosine * v.y()};
}

// Along which most of the length lies, to within quarters of a turn: hatches have it, and boxes
// around edges are slim in its frame.
Vector2 main_direction(const std::vector<SegmentCluster>& clusters) {
  Vector2 sum(0, 0);
  for (const SegmentCluster& cluster : clusters) {
    const Vector2 along = cluster.to - cluster.from;
    const double length = along.norm();
    if (!(length > 0)) continue;
    const Vector2 unit = along / length;
    const Vector2 twice(unit.x() * unit.x() - unit.y() * unit.y(), 2 * unit.x() * unit.y());
    sum +=
        length * Vector2(twice.x() * twice.x() - twice.y() * twice.y(), 2 * twice.x() * twice.y());
  }
  const double angle = std::atan2(sum.y(), sum.x()) / 4;
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

double reach_between_parts(double width, double tolerance) {
  return 2 * width + kTolerancesOfReach * tolerance;
}

std::uint32_t part_of(std::uint32_t label, std::span<const std::uint32_t> cuts) {
  return static_cast<std::uint32_t>(std::ranges::upper_bound(cuts, label) - cuts.begin());
}

void ClusterCover::clear() {
  clusters_.clear();
  edges_ = 0;
  of_last_ = 0;
}

void ClusterCover::add(const Point3& from, const Point3& to, std::uint32_t label) {
  if (std::abs(from[axis_] - to[axis_]) > kSamePlace) return;
  const Point2 begin = across(from, axis_);
  const Point2 end = across(to, axis_);
  if ((begin - end).norm() <= kSamePlace) return;
  ++edges_;
  if (clusters_.size() > kMostClusters) return;
  const double height = plane_height(from[axis_]);
  if (goes_on(begin, end, height)) {
    clusters_.back().to = end;
    clusters_.back().last = label;
    ++of_last_;
  } else {
    clusters_.push_back({begin, end, height, label, label});
    of_last_ = 1;
    right_.reset();
    left_.reset();
  }
  narrow(end);
}

// Each vertex is further from the begin than the one before it, so none is beyond the chord.
bool ClusterCover::goes_on(const Point2& from, const Point2& to, double height) const {
  if (clusters_.empty() || of_last_ >= kMostOfACluster) return false;
  const SegmentCluster& last = clusters_.back();
  if (last.height != height || (last.to - from).norm() > kSamePlace) return false;
  const Vector2 reached = to - last.from;
  if (reached.squaredNorm() <= (last.to - last.from).squaredNorm()) return false;
  return (!right_ || cross(*right_, reached) >= 0) && (!left_ || cross(reached, *left_) >= 0);
}

void ClusterCover::narrow(const Point2& to) {
  const Vector2 reached = to - clusters_.back().from;
  const double distance = reached.norm();
  if (distance <= width_) return;
  const double sine = width_ / distance;
  const double cosine = std::sqrt(1 - sine * sine);
  const Vector2 right = turned(reached, -sine, cosine);
  const Vector2 left = turned(reached, sine, cosine);
  if (!right_ || cross(*right_, right) > 0) right_ = right;
  if (!left_ || cross(left, *left_) > 0) left_ = left;
}

std::optional<std::vector<SegmentCluster>> ClusterCover::clusters() const {
  if (clusters_.size() > kMostClusters) return {};
  return clusters_;
}

std::vector<SegmentCluster> clusters_near_other_parts(const std::vector<SegmentCluster>& clusters,
                                                      std::span<const std::uint32_t> cuts,
                                                      double reach) {
  struct Plane {
    FlatEdges edges;
    std::vector<std::size_t> clusters;  // for each edge
  };
  const Vector2 along = main_direction(clusters);
  std::map<double, Plane> planes;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const SegmentCluster& cluster = clusters[i];
    Plane& plane = planes[cluster.height];
    const Point2 from = turned(cluster.from, -along.y(), along.x());
    const Point2 to = turned(cluster.to, -along.y(), along.x());
    if (plane.edges.add(from, to)) plane.clusters.push_back(i);
  }
  std::vector<bool> is_near;
  is_near.reserve(clusters.size());
  for (const SegmentCluster& cluster : clusters) {
    is_near.push_back(part_of(cluster.first, cuts) != part_of(cluster.last, cuts));
  }
  for (const auto& [height, plane] : planes) {
    const auto pairs = near_pairs(plane.edges, reach);
    if (!pairs) continue;
    for (const EdgePair& pair : *pairs) {
      const std::size_t first = plane.clusters[pair.first];
      const std::size_t second = plane.clusters[pair.second];
      if (part_of(clusters[first].first, cuts) == part_of(clusters[second].first, cuts)) continue;
      is_near[first] = true;
      is_near[second] = true;
    }
  }
  std::vector<SegmentCluster> near;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    if (is_near[i]) near.push_back(clusters[i]);
  }
  return near;
}

std::vector<PartEdge> edges_near(const std::vector<PartEdge>& edges,
                                 std::span<const SegmentCluster> clusters, double distance) {
  const auto overlap = [&](const SegmentCluster& cluster, const PartEdge& edge) {
    if (std::abs(cluster.height - edge.height) > kSamePlace / 2) return false;
    const Point2 low = cluster.from.cwiseMin(cluster.to).array() - distance;
    const Point2 high = cluster.from.cwiseMax(cluster.to).array() + distance;
    const Point2 from = edge.from.cwiseMin(edge.to);
    const Point2 to = edge.from.cwiseMax(edge.to);
    return from.x() <= high.x() && to.x() >= low.x() && from.y() <= high.y() && to.y() >= low.y();
  };
  std::vector<PartEdge> near;
  auto last = clusters.begin();  // both go along one path: begun with the cluster found last
  for (const PartEdge& edge : edges) {
    const auto is_near = [&](const SegmentCluster& cluster) { return overlap(cluster, edge); };
    auto found = std::find_if(last, clusters.end(), is_near);
    if (found == clusters.end()) {
      found = std::find_if(clusters.begin(), last, is_near);
      if (found == last) continue;
    }
    last = found;
    near.push_back(edge);
  }
  return near;
}

}  // namespace batten::geometry
