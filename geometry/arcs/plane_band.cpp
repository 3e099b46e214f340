#include "geometry/arcs/plane_band.h"

#include <algorithm>
#include <cmath>

#include "geometry/basic/operations.h"
#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"

namespace batten::geometry {
namespace {

constexpr PlaneBandTuning kBand = kPlaneBandTuning;

double heading_of(const Vector2& v) { return std::atan2(v.y(), v.x()); }

// A fan that closes sample by sample. An arc from the origin along the first axis with
// curvature k passes a place (x, y) at a distance of at most e when
//   k (x^2 + y^2 - e^2) lies between 2 (y - e) and 2 (y + e),
// from | |place - centre| - 1 / |k| | <= e. Where the place is farther from the centre, e is
// another one: above k = 0 in the upper bound, below it in the lower one.
class ClosingFan {
 public:
  ClosingFan(const BandEntry& entry, const PlaneBand::Limits& limits, double steepest)
      : place_(entry.place),
        along_(entry.along),
        inside_(kBand.fan_part * limits.tolerance),
        outside_(kBand.fan_part * std::min(limits.outside, limits.tolerance)),
        same_sides_(inside_ == outside_),
        range_{-limits.max_curvature, limits.max_curvature},
        steepest_(steepest) {}

  // False when no arc passes this place as well; the range stays as it was.
  bool narrow(const Point2& sample) {
    const Vector2 way = sample - place_;
    const double x = way.dot(along_);
    const double y = cross(along_, way);
    const double square = x * x + y * y;
    const double beyond = square - inside_ * inside_;
    if (beyond <= 0) return true;  // the start itself is near enough
    if (x <= 0 || std::abs(y) > steepest_ * x) return false;
    const double per_inside = 2 / beyond;
    const double per_outside = same_sides_ ? per_inside : 2 / (square - outside_ * outside_);
    const double low = std::max(range_.low, -greatest(-y, per_inside, per_outside));
    const double high = std::min(range_.high, greatest(y, per_inside, per_outside));
    if (low > high) return false;
    range_ = {low, high};
    squared_ = beyond;
    return true;
  }

  [[nodiscard]] const CurvatureRange& range() const { return range_; }
  [[nodiscard]] double width() const { return (range_.high - range_.low) * squared_ / 2; }

 private:
  // Curvature of an arc that passes a place so far to its left.
  [[nodiscard]] double greatest(double y, double per_inside, double per_outside) const {
    if (same_sides_) return per_inside * (y + inside_);
    if (y + outside_ >= 0) return per_outside * (y + outside_);
    return per_inside * std::min(0.0, y + inside_);
  }

  Point2 place_;
  Vector2 along_;
  double inside_;   // mm
  double outside_;  // mm
  bool same_sides_;
  CurvatureRange range_;
  double steepest_;
  double squared_ = 0;
};

// Radians from the ray before it: no turn is lost.
constexpr double kNearRay = 0.125;

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
      before_ = first_;
    }
  }

  struct Foot {
    double along;  // mm from the start, negative before it
    double off;    // mm
    double most;   // mm, that it may be on that side of the arc
    double half;   // mm, how far before and after the foot the arc is within the tolerance
  };

  // Quick where each place is near the one that was asked for before it.
  [[nodiscard]] Foot foot(const Point2& place, const ArcSides& sides) {
    if (arc_.is_line()) {
      const double tolerance = sides.inside;
      const Vector2 way = place - arc_.start;
      const double off = std::abs(cross(first_, way));
      return {way.dot(first_), off, tolerance,
              std::sqrt(std::max(0.0, tolerance * tolerance - off * off))};
    }
    const Vector2 way = place - arc_.center;
    const double distance = way.norm();
    const double off = std::abs(distance - radius_);
    const double tolerance = distance > radius_ ? sides.outside : sides.inside;
    const double room = std::max(0.0, tolerance * tolerance - off * off);
    return {angle_to(way) * radius_, off, tolerance,
            std::sqrt(room * radius_ / std::max(distance, kSamePlace))};
  }

  // Whether the part [from, to] bulges from the line through a sample's place along its edge by no
  // more than `tolerance`, its two ends being near enough.
  [[nodiscard]] bool bulges_within(double tolerance, double from, double to,
                                   const PlaneBand::Sample& sample) const {
    if (arc_.is_line()) return true;
    if (std::abs(height_over(sample)) <= tolerance) return true;
    double at = wrapped(turn_ * (heading_of(sample.edge_way) - arc_.start_angle()));
    if (at < 0) at += 2 * kPi;
    return at * radius_ < from || at * radius_ > to;
  }

  [[nodiscard]] double length() const { return length_; }

  // Where a sample is as soon as everything before it is plain: each sample within the sides, ahead
  // of the one before it and before the arc's end, and nowhere a bulge. Then whatever is matched
  // with them, no sample is refused, and no root or quotient is needed to see it.
  [[nodiscard]] std::size_t first_not_plain(std::span<const PlaneBand::Sample> samples,
                                            std::size_t next, const ArcSides& sides) const {
    if (arc_.is_line() || sides.inside >= radius_ || std::abs(arc_.sweep) >= kPi) return next;
    const double nearest = (radius_ - sides.inside) * (radius_ - sides.inside);
    const double farthest = (radius_ + sides.outside) * (radius_ + sides.outside);
    const Vector2 last = arc_.end - arc_.center;
    Vector2 before = first_;
    std::size_t i = next;
    for (; i < samples.size(); ++i) {
      const Vector2 way = samples[i].place - arc_.center;
      const double square = way.squaredNorm();
      const bool ahead = turn_ * cross(before, way) >= 0 && turn_ * cross(way, last) > 0;
      if (!ahead || square < nearest || square > farthest) break;
      if (std::abs(height_over(samples[i])) > sides.inside) break;
      before = way;
    }
    return i;
  }

  // True when the place is not within the sides of the circle; of a line nothing is said.
  [[nodiscard]] bool is_off(const Point2& place, const ArcSides& sides) const {
    if (arc_.is_line()) return false;
    const double distance = (place - arc_.center).norm();
    return distance < radius_ - sides.inside || distance > radius_ + sides.outside;
  }

  // True when the arc certainly ends before the place, and does not bulge from the edge there.
  [[nodiscard]] bool ends_plainly(const PlaneBand::Sample& sample, double tolerance) const {
    const Vector2 way = sample.place - arc_.center;
    const Vector2 last = arc_.end - arc_.center;
    return turn_ * cross(last, way) > kSamePlace * way.norm() && last.dot(way) > 0 &&
           std::abs(height_over(sample)) <= tolerance;
  }

 private:
  // Of the place where the arc's circle is parallel to the sample's edge, mm to the right of it.
  [[nodiscard]] double height_over(const PlaneBand::Sample& sample) const {
    return cross(sample.edge_way, arc_.center - sample.place) - turn_ * radius_;
  }

  // How far the arc has turned where it passes this ray from its centre: from the ray before it
  // where that is near.
  double angle_to(const Vector2& way) {
    const double more = turn_between(before_, way);
    if (std::abs(more) < kNearRay) {
      angle_ += turn_ * more;
    } else {
      angle_ = turn_ * turn_between(first_, way);
      if (angle_ < -(kPi - std::abs(arc_.sweep) / 2)) angle_ += 2 * kPi;
    }
    before_ = way;
    return angle_;
  }

  const PlaneArc& arc_;
  double length_;
  Vector2 first_ = Vector2::Zero();  // a line's direction; an arc's first radius
  double radius_ = 0;
  double turn_ = 1;
  Vector2 before_ = Vector2::Zero();  // the ray that was asked for last
  double angle_ = 0;                  // of it
};

}  // namespace

PlaneBand::PlaneBand(std::span<const Point2> points, const Limits& limits)
    : limits_(limits), steepest_(std::tan(limits.max_sweep / 2)) {
  const std::size_t n = points.size();
  samples_.reserve(2 * n);
  Vector2 way = (points[1] - points[0]).normalized();
  samples_.push_back({points[0], 0, 0, way});
  double turn_before = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Vector2 after = i + 2 < n ? (points[i + 2] - points[i + 1]).normalized() : way;
    const double turn_after = turn_between(way, after);
    add_edge(points[i], points[i + 1], way, turn_before, turn_after);
    turn_before = turn_after;
    way = after;
  }
}

void PlaneBand::add_edge(const Point2& from, const Point2& to, const Vector2& edge_way,
                         double turn_before, double turn_after) {
  const Vector2 way = to - from;
  const double length = way.norm();
  std::vector<double> inner;  // mm from the edge's start
  const double nearest = kBand.nearest * limits_.tolerance;
  const auto add_about = [&](double turn, bool at_end) {
    if (std::abs(turn) < kBand.tight_turn || length < kBand.room_for_tight * limits_.tolerance)
      return;
    for (double d = nearest; d < length / 2; d *= 2) inner.push_back(at_end ? length - d : d);
  };
  add_about(turn_before, false);
  add_about(turn_after, true);
  const double gentle =
      std::min(kBand.tight_turn, std::max(std::abs(turn_before), std::abs(turn_after)));
  const double sagitta = length * gentle / 8;
  const double least = length > kBand.long_edge * limits_.tolerance ? kBand.parts_of_long : 1;
  const double parts = std::clamp(
      std::ceil(std::sqrt(sagitta / (kBand.between * limits_.tolerance))), least, kBand.most_parts);
  for (int i = 1; i < static_cast<int>(parts); ++i) inner.push_back(length * i / parts);
  std::ranges::sort(inner);
  const double start = samples_.back().station;
  double last = 0;
  for (const double at : inner) {
    if (at - last < nearest / 2) continue;
    samples_.push_back({from + (at / length) * way, start + at, 0, edge_way});
    last = at;
  }
  samples_.push_back({to, start + length, turn_after, edge_way});
}

ArcFan PlaneBand::fan(const BandEntry& entry) const {
  ArcFan fan;
  ClosingFan closing(entry, limits_, steepest_);
  for (std::size_t i = entry.next; i < samples_.size(); ++i) {
    if (!closing.narrow(samples_[i].place)) break;
    fan.push_back(closing.range());
  }
  return fan;
}

ArcReach PlaneBand::reach(const BandEntry& entry) const {
  ClosingFan closing(entry, limits_, steepest_);
  std::size_t i = entry.next;  // the first sample that is not known to be passed
  for (std::size_t step = limits_.stride; step > 0; step = step > 1 ? 1 : 0) {
    while (i + step <= samples_.size() && closing.narrow(samples_[i + step - 1].place)) i += step;
  }
  count_operations(1 + (i - entry.next) / 4);
  return {i, closing.width()};
}

bool PlaneBand::may_reach(const BandEntry& entry, std::size_t end) const {
  const std::size_t strides = end > entry.next ? (end - entry.next) / limits_.stride : 0;
  if (strides == 0) return true;
  count_operations(1);
  ClosingFan closing(entry, limits_, steepest_);
  // The farthest one leaves the fewest arcs; most others are closed out half of the way.
  for (const std::size_t quarters : {4, 2, 3, 1}) {
    const std::size_t passed = std::max<std::size_t>(strides * quarters / 4, 1);
    if (!closing.narrow(samples_[entry.next + passed * limits_.stride - 1].place)) return false;
  }
  return true;
}

std::optional<std::size_t> PlaneBand::passed(const BandEntry& entry, const PlaneArc& arc,
                                             const ArcSides& sides) const {
  if (!sides.any()) return std::nullopt;
  ArcMeter meter(arc);
  const auto meets_last = [&]() -> std::optional<std::size_t> {
    if ((arc.end - samples_.back().place).norm() > sides.inside) return std::nullopt;
    return samples_.size();
  };
  const auto ends_beside_edge_to = [&](std::size_t next) {
    return distance_to_segment(arc.end, samples_[next - 1].place, samples_[next].place) <=
           sides.inside;
  };
  std::size_t i = meter.first_not_plain(samples_, entry.next, sides);
  if (i == samples_.size()) return meets_last();
  if (meter.ends_plainly(samples_[i], sides.inside)) {
    return ends_beside_edge_to(i) ? std::optional(i) : std::nullopt;
  }
  if (meter.is_off(samples_[i].place, sides) && !ends_beside_edge_to(i)) return std::nullopt;
  double at = 0;  // everything before is matched
  for (i = entry.next; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const ArcMeter::Foot foot = meter.foot(sample.place, sides);
    if (foot.along > meter.length() + kSamePlace) break;
    // Not passed by this arc: then it ends on the edge before the sample, which is asked below.
    if (foot.off > foot.most || at > foot.along + foot.half) break;
    const double to = std::max(at, foot.along - foot.half);
    if (!meter.bulges_within(sides.inside, at, to, sample)) return std::nullopt;
    at = to;
  }
  if (i == samples_.size()) return meets_last();
  if (!ends_beside_edge_to(i) ||
      !meter.bulges_within(sides.inside, at, meter.length(), samples_[i])) {
    return std::nullopt;
  }
  return i;
}

}  // namespace batten::geometry
