#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/numeric.h"
#include "geometry/plane_curve.h"
#include "geometry/tolerance_band_pairs.h"
#include "geometry/tolerance_band_parts.h"

namespace batten::geometry {
namespace {

// A strand is copied as a whole where it has to be.
constexpr std::size_t kMostOfAStrand = 64;

// Crossings are excused by what the old path does within four tolerances of them, which are within
// one of it: all that has to do with one is within ten.
constexpr double kTolerancesOfReach = 10;

Point2 beside_axis(const Point3& place, int axis) {
  return {place[axis == 0 ? 1 : 0], place[axis == 2 ? 1 : 2]};
}

Vector2 turned(const Vector2& v, double sine, double cosine) {
  return {cosine * v.x() - sine * v.y(), sine * v.x() + cosine * v.y()};
}

// Along which most of the length lies, to within quarters of a turn: hatches have it, and boxes
// around edges are slim in its frame.
Vector2 main_direction(const std::vector<Strand>& strands) {
  Vector2 sum(0, 0);
  for (const Strand& strand : strands) {
    const Vector2 along = strand.to - strand.from;
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

struct Plane {
  FlatEdges edges;
  std::vector<std::size_t> strands;  // for each edge
};

bool is_in_two_parts(const Strand& strand, std::span<const std::uint32_t> cuts) {
  return part_of(strand.first, cuts) != part_of(strand.last, cuts);
}

}  // namespace

double reach_between_parts(double width, double tolerance) {
  return 2 * width + kTolerancesOfReach * tolerance;
}

std::uint32_t part_of(std::uint32_t label, std::span<const std::uint32_t> cuts) {
  return static_cast<std::uint32_t>(std::ranges::upper_bound(cuts, label) - cuts.begin());
}

void StrandCover::clear() {
  strands_.clear();
  edges_ = 0;
  of_last_ = 0;
}

void StrandCover::add(const Point3& from, const Point3& to, std::uint32_t label) {
  if (std::abs(from[axis_] - to[axis_]) > kSamePlace) return;
  const Point2 begin = beside_axis(from, axis_);
  const Point2 end = beside_axis(to, axis_);
  if ((begin - end).norm() <= kSamePlace) return;
  ++edges_;
  if (strands_.size() > kMostStrands) return;
  const double height = std::round(from[axis_] / kSamePlace) * kSamePlace;
  if (goes_on(begin, end, height)) {
    strands_.back().to = end;
    strands_.back().last = label;
    ++of_last_;
  } else {
    strands_.push_back({begin, end, height, label, label});
    of_last_ = 1;
    right_.reset();
    left_.reset();
  }
  narrow(end);
}

// Each vertex is further from the begin than the one before it, so none is beyond the chord.
bool StrandCover::goes_on(const Point2& from, const Point2& to, double height) const {
  if (strands_.empty() || of_last_ >= kMostOfAStrand) return false;
  const Strand& last = strands_.back();
  if (last.height != height || (last.to - from).norm() > kSamePlace) return false;
  const Vector2 reached = to - last.from;
  if (reached.squaredNorm() <= (last.to - last.from).squaredNorm()) return false;
  return (!right_ || cross(*right_, reached) >= 0) && (!left_ || cross(reached, *left_) >= 0);
}

void StrandCover::narrow(const Point2& to) {
  const Vector2 reached = to - strands_.back().from;
  const double distance = reached.norm();
  if (distance <= width_) return;
  const double sine = width_ / distance;
  const double cosine = std::sqrt(1 - sine * sine);
  const Vector2 right = turned(reached, -sine, cosine);
  const Vector2 left = turned(reached, sine, cosine);
  if (!right_ || cross(*right_, right) > 0) right_ = right;
  if (!left_ || cross(left, *left_) > 0) left_ = left;
}

std::optional<std::vector<Strand>> StrandCover::strands() const {
  if (strands_.size() > kMostStrands) return {};
  return strands_;
}

std::vector<Strand> strands_near_other_parts(const std::vector<Strand>& strands,
                                             std::span<const std::uint32_t> cuts, double reach) {
  const Vector2 along = main_direction(strands);
  std::map<double, Plane> planes;
  for (std::size_t i = 0; i < strands.size(); ++i) {
    const Strand& strand = strands[i];
    Plane& plane = planes[strand.height];
    const Point2 from = turned(strand.from, -along.y(), along.x());
    const Point2 to = turned(strand.to, -along.y(), along.x());
    if (plane.edges.add(from, to)) plane.strands.push_back(i);
  }
  std::vector<bool> is_near(strands.size(), false);
  for (std::size_t i = 0; i < strands.size(); ++i) {
    is_near[i] = is_in_two_parts(strands[i], cuts);
  }
  for (const auto& [height, plane] : planes) {
    const auto pairs = near_pairs(plane.edges, reach);
    if (!pairs) continue;
    for (const EdgePair& pair : *pairs) {
      const std::size_t first = plane.strands[pair.first];
      const std::size_t second = plane.strands[pair.second];
      if (part_of(strands[first].first, cuts) == part_of(strands[second].first, cuts)) continue;
      is_near[first] = true;
      is_near[second] = true;
    }
  }
  std::vector<Strand> near;
  for (std::size_t i = 0; i < strands.size(); ++i) {
    if (is_near[i]) near.push_back(strands[i]);
  }
  return near;
}

std::vector<PartEdge> edges_near(const std::vector<PartEdge>& edges,
                                 std::span<const Strand> strands, double distance) {
  const auto overlap = [&](const Strand& strand, const PartEdge& edge) {
    if (std::abs(strand.height - edge.height) > kSamePlace / 2) return false;
    const Point2 low = strand.from.cwiseMin(strand.to).array() - distance;
    const Point2 high = strand.from.cwiseMax(strand.to).array() + distance;
    const Point2 from = edge.from.cwiseMin(edge.to);
    const Point2 to = edge.from.cwiseMax(edge.to);
    return from.x() <= high.x() && to.x() >= low.x() && from.y() <= high.y() && to.y() >= low.y();
  };
  std::vector<PartEdge> near;
  std::size_t last = 0;  // both go along one path
  for (const PartEdge& edge : edges) {
    for (std::size_t i = 0; i < strands.size(); ++i) {
      const std::size_t strand = (last + i) % strands.size();
      if (!overlap(strands[strand], edge)) continue;
      last = strand;
      near.push_back(edge);
      break;
    }
  }
  return near;
}

}  // namespace batten::geometry
