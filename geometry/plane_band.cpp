#include "geometry/plane_band.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/angle.h"
#include "geometry/numeric.h"

namespace batten::geometry {
namespace {

// What a curve with the polyline's turns does between two samples is at most this part of the
// tolerance.
constexpr double kBetween = 0.02;
constexpr double kMostParts = 8;

// Edges longer than this many tolerances could hide an arc's bulge between their ends.
constexpr double kLongEdge = 200;
constexpr int kPartsOfLong = 4;

// About vertices that turn more, samples stand at distances that double from this part of the
// tolerance: arcs that round them are that small.
constexpr double kTightTurn = 0.1;
constexpr double kNearest = 0.5;
constexpr double kRoomForTight = 10;  // tolerances: a shorter edge is no leg of a corner

double angle_of(const Vector2& v) { return std::atan2(v.y(), v.x()); }

// A fan is made for this part of the tolerance; the rest is for what arcs do between samples
// and for the rounding of their ends.
constexpr double kFanPart = 0.97;

// A fan that closes sample by sample. An arc from the origin along the first axis with
// curvature k passes a place (x, y) at a distance of at most e when
//   k (x^2 + y^2 - e^2) lies between 2 (y - e) and 2 (y + e),
// from | |place - centre| - 1 / |k| | <= e.
class ClosingFan {
 public:
  ClosingFan(const BandEntry& entry, const PlaneBand::Limits& limits, double steepest)
      : place_(entry.place),
        along_(unit_vector(entry.angle)),
        tolerance_(kFanPart * limits.tolerance),
        range_{-limits.max_curvature, limits.max_curvature},
        steepest_(steepest) {}

  // False when no arc passes this place as well; the range stays as it was.
  bool narrow(const Point2& sample) {
    const Vector2 way = sample - place_;
    const double x = way.dot(along_);
    const double y = cross(along_, way);
    const double beyond = x * x + y * y - tolerance_ * tolerance_;
    if (beyond <= 0) return true;  // the start itself is near enough
    if (x <= 0 || std::abs(y) > steepest_ * x) return false;
    const double low = std::max(range_.low, 2 * (y - tolerance_) / beyond);
    const double high = std::min(range_.high, 2 * (y + tolerance_) / beyond);
    if (low > high) return false;
    range_ = {low, high};
    squared_ = beyond;
    return true;
  }

  [[nodiscard]] const CurvatureRange& range() const { return range_; }
  [[nodiscard]] double width() const { return (range_.high - range_.low) * squared_ / 2; }

 private:
  Point2 place_;
  Vector2 along_;
  double tolerance_;
  CurvatureRange range_;
  double steepest_;
  double squared_ = 0;
};

// Length along a line or an arc, and distance across it, of places near it.
class ArcMeter {
 public:
  explicit ArcMeter(const PlaneArc& arc) : arc_(arc), length_(arc.length()) {
    if (arc.is_line()) {
      first_ = (arc.end - arc.start).normalized();
    } else {
      first_ = arc.start - arc.center;
      radius_ = first_.norm();
      turn_ = arc.sweep > 0 ? 1 : -1;
    }
  }

  struct Foot {
    double along;  // mm from the start, negative before it
    double off;    // mm
    double half;   // mm, how far before and after the foot the arc is within the tolerance
  };

  [[nodiscard]] Foot foot(const Point2& place, double tolerance) const {
    if (arc_.is_line()) {
      const Vector2 way = place - arc_.start;
      const double off = std::abs(cross(first_, way));
      return {way.dot(first_), off, std::sqrt(std::max(0.0, tolerance * tolerance - off * off))};
    }
    const Vector2 way = place - arc_.center;
    double angle = turn_ * std::atan2(cross(first_, way), first_.dot(way));
    if (angle < -(kPi - std::abs(arc_.sweep) / 2)) angle += 2 * kPi;
    const double distance = way.norm();
    const double off = std::abs(distance - radius_);
    const double room = std::max(0.0, tolerance * tolerance - off * off);
    return {angle * radius_, off, std::sqrt(room * radius_ / std::max(distance, kSamePlace))};
  }

  // Whether the part [from, to] bulges from the line through `place` at `angle` by no more than
  // `tolerance`, its two ends being near enough.
  [[nodiscard]] bool bulges_within(double tolerance, double from, double to, const Point2& place,
                                   double angle) const {
    if (arc_.is_line()) return true;
    double at = wrapped(turn_ * (angle - start_angle()));
    if (at < 0) at += 2 * kPi;
    if (at * radius_ < from || at * radius_ > to) return true;
    const double height = cross(unit_vector(angle), arc_.center - place) - turn_ * radius_;
    return std::abs(height) <= tolerance;
  }

  [[nodiscard]] double length() const { return length_; }

 private:
  [[nodiscard]] double start_angle() const { return arc_.start_angle(); }

  const PlaneArc& arc_;
  double length_;
  Vector2 first_ = Vector2::Zero();  // a line's direction; an arc's first radius
  double radius_ = 0;
  double turn_ = 1;
};

double distance_to_segment(const Point2& p, const Point2& a, const Point2& b) {
  const Vector2 d = b - a;
  const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (p - a - t * d).norm();
}

}  // namespace

PlaneBand::PlaneBand(std::span<const Point2> points, const Limits& limits)
    : limits_(limits), steepest_(std::tan(limits.max_sweep / 2)) {
  const std::size_t n = points.size();
  std::vector<double> turns(n, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    turns[i] = wrapped(angle_of(points[i + 1] - points[i]) - angle_of(points[i] - points[i - 1]));
  }
  samples_.reserve(2 * n);
  samples_.push_back({points[0], 0, angle_of(points[1] - points[0]), 0});
  for (std::size_t i = 1; i < n; ++i) add_edge(points[i - 1], points[i], turns[i - 1], turns[i]);
}

void PlaneBand::add_edge(const Point2& from, const Point2& to, double turn_before,
                         double turn_after) {
  const Vector2 way = to - from;
  const double length = way.norm();
  const double angle = angle_of(way);
  std::vector<double> places;
  const double nearest = kNearest * limits_.tolerance;
  const auto add_about = [&](double turn, bool at_end) {
    if (std::abs(turn) < kTightTurn || length < kRoomForTight * limits_.tolerance) return;
    for (double d = nearest; d < length / 2; d *= 2) places.push_back(at_end ? length - d : d);
  };
  add_about(turn_before, false);
  add_about(turn_after, true);
  const double gentle = std::min(kTightTurn, std::max(std::abs(turn_before), std::abs(turn_after)));
  const double sagitta = length * gentle / 8;
  double parts = std::ceil(std::sqrt(sagitta / (kBetween * limits_.tolerance)));
  parts =
      std::clamp(parts, length > kLongEdge * limits_.tolerance ? kPartsOfLong : 1.0, kMostParts);
  for (int i = 1; i < static_cast<int>(parts); ++i) places.push_back(length * i / parts);
  std::sort(places.begin(), places.end());
  const double start = samples_.back().station;
  double last = 0;
  for (const double place : places) {
    if (place - last < nearest / 2) continue;
    samples_.push_back({from + (place / length) * way, start + place, angle, 0});
    last = place;
  }
  samples_.push_back({to, start + length, angle, turn_after});
}

ArcFan PlaneBand::fan(const BandEntry& entry) const {
  ArcFan fan;
  ClosingFan closing(entry, limits_, steepest_);
  for (std::size_t i = entry.next; i < samples_.size() && closing.narrow(samples_[i].place); ++i) {
    fan.ranges.push_back(closing.range());
  }
  return fan;
}

ArcReach PlaneBand::reach(const BandEntry& entry) const {
  ClosingFan closing(entry, limits_, steepest_);
  std::size_t i = entry.next;  // the first sample that is not known to be passed
  for (std::size_t step = limits_.stride; step > 0; step = step > 1 ? 1 : 0) {
    while (i + step <= samples_.size() && closing.narrow(samples_[i + step - 1].place)) i += step;
  }
  return {i, closing.width()};
}

std::optional<std::size_t> PlaneBand::passed(const BandEntry& entry, const PlaneArc& arc) const {
  const ArcMeter meter(arc);
  const double tolerance = limits_.tolerance;
  double at = 0;  // everything before is matched
  std::size_t i = entry.next;
  for (; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const ArcMeter::Foot foot = meter.foot(sample.place, tolerance);
    if (foot.along > meter.length() + kSamePlace) break;
    // Not passed by this arc: then it ends on the edge before the sample, which is asked below.
    if (foot.off > tolerance || at > foot.along + foot.half) break;
    const double to = std::max(at, foot.along - foot.half);
    if (!meter.bulges_within(tolerance, at, to, sample.place, sample.edge_angle)) {
      return std::nullopt;
    }
    at = to;
  }
  if (i == samples_.size()) {
    const bool meets = (arc.end - samples_.back().place).norm() <= tolerance;
    return meets ? std::optional(i) : std::nullopt;
  }
  const Sample& next = samples_[i];
  if (distance_to_segment(arc.end, samples_[i - 1].place, next.place) > tolerance ||
      !meter.bulges_within(tolerance, at, meter.length(), next.place, next.edge_angle)) {
    return std::nullopt;
  }
  return i;
}

}  // namespace batten::geometry
