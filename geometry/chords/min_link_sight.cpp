#include "geometry/chords/min_link_sight.h"

#include <algorithm>

namespace batten::geometry {
namespace {

// A line that crosses a gate's way by so little of its length (the sine of the angle) counts as
// running along the gate.
constexpr double kAlongGate = 1e-6;

double turn(const Point2& a, const Point2& b, const Point2& c) { return cross(b - a, c - b); }

}  // namespace

Offsets Offsets::common_with(const Offsets& other) const {
  return {std::max(low, other.low), std::min(high, other.high)};
}

Offsets Offsets::hull_with(const Offsets& other) const {
  if (empty()) return other;
  if (other.empty()) return *this;
  return {std::min(low, other.low), std::max(high, other.high)};
}

std::optional<double> SightLine::offset_on(const PlaneGate& gate) const {
  const Vector2 way = to - from;
  const double crossing = cross(way, gate.normal);
  if (!(crossing > kAlongGate * way.norm())) return std::nullopt;
  return cross(way, from - gate.center) / crossing;
}

Offsets SightLimits::seen_on(const PlaneGate& gate) const {
  const auto high = left.offset_on(gate);
  const auto low = right.offset_on(gate);
  if (!high || !low) return {};
  return gate.open.common_with({*low, *high});
}

void Sight::Chain::add(const Point2& end) {
  while (points.size() >= first + 2 &&
         side * turn(points[points.size() - 2], points.back(), end) <= 0) {
    points.pop_back();
  }
  points.push_back(end);
}

const Point2& Sight::Chain::support_of(const Point2& to) {
  while (first + 1 < points.size() && side * turn(points[first], to, points[first + 1]) <= 0) {
    ++first;
  }
  return points[first];
}

Sight::Sight(const PlaneGate& source, const Offsets& part)
    : left_{{source.at(part.high)}, 0, 1}, right_{{source.at(part.low)}, 0, -1} {}

Offsets Sight::pass(const PlaneGate& gate) {
  const Point2 left = gate.at(gate.open.high);
  const Point2 right = gate.at(gate.open.low);
  Offsets seen = gate.open;
  if (!started_) {
    limits_ = {{right_.points.front(), left}, {left_.points.front(), right}};
    if (!limits_.left.offset_on(gate) || !limits_.right.offset_on(gate)) return {};
    started_ = true;
  } else {
    seen = limits_.seen_on(gate);
    if (seen.empty()) return seen;
    if (seen.high >= gate.open.high) limits_.left = {right_.support_of(left), left};
    if (seen.low <= gate.open.low) limits_.right = {left_.support_of(right), right};
  }
  left_.add(left);
  right_.add(right);
  return seen;
}

Offsets BackwardSight::seen_on(const PlaneGate& gate, const Offsets& part) const {
  Offsets seen = part;
  if (bounds_) {
    const auto low = SightLine{bounds_->first, target_}.offset_on(gate);
    const auto high = SightLine{bounds_->second, target_}.offset_on(gate);
    if (!low || !high) return {};
    seen = part.common_with({*low, *high});
  }
  if (seen.low > seen.high && seen.low <= seen.high + 2 * noise_) {
    const double middle = std::clamp((seen.low + seen.high) / 2, part.low, part.high);
    return {middle, middle};
  }
  return seen;
}

bool BackwardSight::pass(const PlaneGate& gate) {
  const Offsets seen = seen_on(gate, {gate.open.low - noise_, gate.open.high + noise_});
  if (seen.empty()) return false;
  bounds_ = {gate.at(seen.low), gate.at(seen.high)};
  return true;
}

}  // namespace batten::geometry
