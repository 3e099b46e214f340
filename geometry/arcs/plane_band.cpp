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
    const double per_outside = 2 / (square - outside_ * outside_);
    const double low = std::max(range_.low, -greatest(-y, square, per_outside));
    const double high = std::min(range_.high, greatest(y, square, per_outside));
    if (low > high) return false;
    range_ = {low, high};
    squared_ = beyond;
    return true;
  }

  [[nodiscard]] const CurvatureRange& range() const { return range_; }
  [[nodiscard]] double width() const { return (range_.high - range_.low) * squared_ / 2; }

 private:
  // Curvature of an arc that passes a place so far to its left.
  [[nodiscard]] double greatest(double y, double square, double per_outside) const {
    if (y + outside_ >= 0) return per_outside * (y + outside_);
    if (y + inside_ >= 0) return 0;
    return 2 / (square - inside_ * inside_) * (y + inside_);
  }

  Point2 place_;
  Vector2 along_;
  double inside_;   // mm
  double outside_;  // mm
  CurvatureRange range_;
  double steepest_;
  double squared_ = 0;
};

// Radians, for |tangent| <= kSmallTangent: what the series leaves out is below rounding.
constexpr double kSmallTangent = 0.125;

double small_angle(double tangent) {
  const double t = tangent * tangent;
  const double tail = 1.0 / 11 + t * (-1.0 / 13 + t * (1.0 / 15 - t / 17));
  const double sum = -1.0 / 3 + t * (1.0 / 5 + t * (-1.0 / 7 + t * (1.0 / 9 - t * tail)));
  return tangent * (1 + t * sum);
}

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
    const double height = cross(sample.edge_way, arc_.center - sample.place) - turn_ * radius_;
    if (std::abs(height) <= tolerance) return true;
    double at = wrapped(turn_ * (sample.edge_angle - arc_.start_angle()));
    if (at < 0) at += 2 * kPi;
    return at * radius_ < from || at * radius_ > to;
  }

  [[nodiscard]] double length() const { return length_; }

 private:
  // How far the arc has turned where it passes this ray from its centre: from the ray before it
  // where that is near, for an arctangent costs more than all the rest.
  double angle_to(const Vector2& way) {
    const double across = cross(before_, way);
    const double ahead = before_.dot(way);
    if (std::abs(across) <= kSmallTangent * ahead && ahead > 0) {
      angle_ += turn_ * small_angle(across / ahead);
    } else {
      angle_ = turn_ * std::atan2(cross(first_, way), first_.dot(way));
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
  std::vector<double> angles(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) angles[i] = heading_of(points[i + 1] - points[i]);
  samples_.reserve(2 * n);
  samples_.push_back({points[0], 0, angles[0], 0, unit_vector(angles[0])});
  double turn_before = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double turn_after = i + 2 < n ? wrapped(angles[i + 1] - angles[i]) : 0;
    add_edge(points[i], points[i + 1], angles[i], turn_before, turn_after);
    turn_before = turn_after;
  }
}

void PlaneBand::add_edge(const Point2& from, const Point2& to, double angle, double turn_before,
                         double turn_after) {
  const Vector2 way = to - from;
  const double length = way.norm();
  const Vector2 edge_way = unit_vector(angle);
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
    samples_.push_back({from + (at / length) * way, start + at, angle, 0, edge_way});
    last = at;
  }
  samples_.push_back({to, start + length, angle, turn_after, edge_way});
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

std::optional<std::size_t> PlaneBand::passed(const BandEntry& entry, const PlaneArc& arc,
                                             const ArcSides& sides) const {
  if (!sides.any()) return std::nullopt;
  ArcMeter meter(arc);
  double at = 0;  // everything before is matched
  std::size_t i = entry.next;
  for (; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const ArcMeter::Foot foot = meter.foot(sample.place, sides);
    if (foot.along > meter.length() + kSamePlace) break;
    // Not passed by this arc: then it ends on the edge before the sample, which is asked below.
    if (foot.off > foot.most || at > foot.along + foot.half) break;
    const double to = std::max(at, foot.along - foot.half);
    if (!meter.bulges_within(sides.inside, at, to, sample)) return std::nullopt;
    at = to;
  }
  if (i == samples_.size()) {
    const bool meets = (arc.end - samples_.back().place).norm() <= sides.inside;
    return meets ? std::optional(i) : std::nullopt;
  }
  const Sample& next = samples_[i];
  if (distance_to_segment(arc.end, samples_[i - 1].place, next.place) > sides.inside ||
      !meter.bulges_within(sides.inside, at, meter.length(), next)) {
    return std::nullopt;
  }
  return i;
}

}  // namespace batten::geometry
