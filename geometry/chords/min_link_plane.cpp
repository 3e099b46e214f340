#include "geometry/chords/min_link_plane.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "geometry/basic/operations.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {
namespace {

// Gates are entered this part narrower than allowed: above the rounding of many crossings of
// lines, which is 1e-16 of the coordinates.
constexpr double kWayNoise = 1e-8;

// How often the last point of a link is halved out: to 1e-12 of the way between two gates.
constexpr int kEndHalvings = 40;

// A line that crosses a gate's way by so little of its length (the sine of the angle) counts as
// running along the gate.
constexpr double kAlongGate = 1e-6;

// Offsets from a gate's centre along its normal, to the left positive; empty when low > high.
struct Offsets {
  double low = 1;
  double high = -1;

  [[nodiscard]] bool empty() const { return low > high; }

  [[nodiscard]] Offsets common_with(const Offsets& other) const {
    return {std::max(low, other.low), std::min(high, other.high)};
  }

  [[nodiscard]] Offsets hull_with(const Offsets& other) const {
    if (empty()) return other;
    if (other.empty()) return *this;
    return {std::min(low, other.low), std::max(high, other.high)};
  }
};

struct PlaneGate {
  Point2 center;
  Vector2 normal;  // unit length, to the left of the way
  Offsets open;
  int side = 0;  // to which the curve bends: +1 left, -1 right; 0: straight

  [[nodiscard]] Point2 at(double offset) const { return center + offset * normal; }
};

// A directed line.
struct SightLine {
  Point2 from;
  Point2 to;

  // Where the line crosses the gate's line, from right to left as seen from the front; nothing
  // when it turns from the gate's way by nearly a right angle or more.
  [[nodiscard]] std::optional<double> offset_on(const PlaneGate& gate) const {
    const Vector2 way = to - from;
    const double crossing = cross(way, gate.normal);
    if (!(crossing > kAlongGate * way.norm())) return std::nullopt;
    return cross(way, from - gate.center) / crossing;
  }
};

// What lies between two lines, of `part` of the gate.
Offsets between_lines(const SightLine& low_line, const SightLine& high_line, const PlaneGate& gate,
                      const Offsets& part) {
  const auto low = low_line.offset_on(gate);
  const auto high = high_line.offset_on(gate);
  return low && high ? part.common_with({*low, *high}) : Offsets{};
}

// The two lines that bound what is seen: on every gate ahead, lines through all gates so far
// end between them.
struct SightLimits {
  SightLine left;   // turns most to the left: past a gate's right end first, a left end then
  SightLine right;  // the other way round

  // What is seen of a gate ahead of the others.
  [[nodiscard]] Offsets seen_on(const PlaneGate& gate) const {
    return between_lines(right, left, gate, gate.open);
  }
};

// All straight ways from a part of one gate through the gates after it. Each gate costs
// a few operations, amortised: J. O'Rourke, An on-line algorithm for fitting straight lines
// between data ranges, Communications of the ACM 24 (1981) 574-578.
class Sight {
 public:
  Sight(const PlaneGate& source, const Offsets& part)
      : left_{{source.at(part.high)}, 0, 1}, right_{{source.at(part.low)}, 0, -1} {}

  // What is seen of the next gate; nothing is changed when that is empty.
  Offsets pass(const PlaneGate& gate) {
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

  [[nodiscard]] const SightLimits& limits() const { return limits_; }

 private:
  // Ends of the gates on one side as a chain that is convex towards the way; what lies before
  // `first` is never a support again.
  struct Chain {
    std::vector<Point2> points;
    std::size_t first = 0;
    double side;  // +1: left ends, -1: right ends

    // Whether the way from a over b to c turns away from the side, or goes straight on.
    [[nodiscard]] bool turns_off(const Point2& a, const Point2& b, const Point2& c) const {
      return side * cross(b - a, c - b) <= 0;
    }

    void add(const Point2& end) {
      while (points.size() >= first + 2 &&
             turns_off(points[points.size() - 2], points.back(), end)) {
        points.pop_back();
      }
      points.push_back(end);
    }

    // The support of the line that ends in `to` and passes all points on its inner side.
    const Point2& support_of(const Point2& to) {
      while (first + 1 < points.size() && turns_off(points[first], to, points[first + 1])) ++first;
      return points[first];
    }
  };

  Chain left_;
  Chain right_;
  SightLimits limits_;
  bool started_ = false;
};

// The straight ways that end in one point, followed backwards through the gates before it. Gates
// are taken wider by `noise` (mm), so that a way along their very ends is not lost to rounding.
class BackwardSight {
 public:
  BackwardSight(Point2 target, double noise) : target_(std::move(target)), noise_(noise) {}

  // From where on the gate the target is seen; the middle of a gap no wider than the noise.
  [[nodiscard]] Offsets seen_on(const PlaneGate& gate, const Offsets& part) const {
    Offsets seen = part;
    if (bounds_) {
      seen = between_lines({bounds_->first, target_}, {bounds_->second, target_}, gate, part);
    }
    if (seen.low > seen.high && seen.low <= seen.high + 2 * noise_) {
      const double middle = std::clamp((seen.low + seen.high) / 2, part.low, part.high);
      return {middle, middle};
    }
    return seen;
  }

  // Only ways through this gate from now on. False when there are none.
  bool pass(const PlaneGate& gate) {
    const Offsets seen = seen_on(gate, {gate.open.low - noise_, gate.open.high + noise_});
    if (seen.empty()) return false;
    bounds_ = {gate.at(seen.low), gate.at(seen.high)};
    return true;
  }

 private:
  Point2 target_;
  double noise_;
  std::optional<std::pair<Point2, Point2>> bounds_;  // rightmost, leftmost point passed
};

// What so many links reach: of the gates `first` and on, and of a position beyond the last of them
// that only the farthest links get to.
struct Layer {
  std::size_t first = 0;
  std::vector<Offsets> reached;
  std::optional<PlaneGate> end = {};  // between gate last() and the next
  double end_part = 0;
  Offsets end_reached = {};

  [[nodiscard]] std::size_t last() const { return first + reached.size() - 1; }
  [[nodiscard]] const Offsets& on(std::size_t i) const { return reached[i - first]; }

  void extend(std::size_t i, const Offsets& seen) {
    if (i < first) return;
    if (i > last()) reached.resize(i - first + 1);
    Offsets& all = reached[i - first];
    all = all.hull_with(seen);
  }
};

// A vertex of a path: on gate `gate`, or (beyond) between it and the next.
struct GateTurn {
  std::size_t gate = 0;
  bool beyond = false;
  double part = 0;  // of the parameter to the next gate, if beyond
  double offset = 0;
};

class GateSweep {
 public:
  GateSweep(const GateChain& gates, const Vector3& normal, const Point3& start, double width)
      : chain_(gates), width_(width * (1 - 2 * kWayNoise)), noise_(width * kWayNoise) {
    const Vector3 first = gates[0].along - gates[0].along.dot(normal) * normal;
    axes_.row(0) = first.normalized();
    axes_.row(1) = normal.cross(first).normalized();
    gates_.reserve(gates.size());
    for (std::size_t i = 0; i < gates.size(); ++i) gates_.push_back(plane_gate(gates[i]));
    const double offset = (start - gates[0].center).dot(in_space(gates_.front().normal));
    layers_.push_back({.first = 0, .reached = {{offset, offset}}});
  }

  std::optional<std::vector<LinkVertex>> fewest_links(const Point3& start) {
    while (!end_is_seen_) {
      if (!grow()) return std::nullopt;
    }
    // From the end back to the start.
    std::vector<LinkVertex> vertices = {{chain_.back().center, chain_.back().parameter}};
    GateTurn turn{last_gate(), false, 0, 0};
    for (std::size_t k = layers_.size(); k-- > 0;) {
      const auto before = turn_before(turn, layers_[k]);
      if (!before) return std::nullopt;
      turn = *before;
      vertices.push_back(k > 0 ? vertex_at(turn) : LinkVertex{start, chain_[0].parameter});
    }
    std::ranges::reverse(vertices);
    return vertices;
  }

 private:
  [[nodiscard]] std::size_t last_gate() const { return gates_.size() - 1; }

  [[nodiscard]] Vector3 in_space(const Vector2& v) const { return axes_.transpose() * v; }

  [[nodiscard]] PlaneGate plane_gate(const Gate& gate) const {
    PlaneGate plane;
    plane.center = axes_ * (gate.center - chain_[0].center);
    const Vector2 along = (axes_ * gate.along).normalized();
    plane.normal = Vector2(-along.y(), along.x());
    const double bend = plane.normal.dot(axes_ * gate.bend);
    const double inside = width_ - gate.gap;
    plane.open = {bend < 0 ? -inside : -width_, bend > 0 ? inside : width_};
    plane.side = bend == 0 ? 0 : (bend < 0 ? -1 : 1);
    return plane;
  }

  // Whether the curve bends to one side only from gate `first` to gate `last`.
  [[nodiscard]] bool keeps_side(std::size_t first, std::size_t last) const {
    int side = 0;
    for (std::size_t i = first; i <= last; ++i) {
      if (gates_[i].side * side < 0) return false;
      if (gates_[i].side != 0) side = gates_[i].side;
    }
    return true;
  }

  // Calls `see(sight, next gate)` for every part of a gate where a link may start after this layer:
  // on the last gate where it is still in reach. On the gate after that it is not, which leaves few
  // ways. It returns the gate that is seen no more: where the curve keeps its side up to there, the
  // best turn is as far as the layer gets.
  template <typename See>
  void from_each_start(const Layer& layer, const See& see) const {
    std::size_t unseen = layer.last() + 1;
    if (layer.end) unseen = see(Sight(*layer.end, layer.end_reached), layer.last() + 1);
    see(Sight(gates_[layer.last()], layer.on(layer.last())), layer.last() + 1);
    if (layer.end && keeps_side(layer.first, std::min(unseen, last_gate()))) return;
    for (std::size_t i = layer.last(); i-- > layer.first;) {
      if (layer.on(i).empty()) continue;
      const Offsets open = gates_[i + 1].open;
      const Offsets& reached = layer.on(i + 1);
      for (const Offsets& part : {Offsets{open.low, reached.low}, {reached.high, open.high}}) {
        if (!(part.low < part.high)) continue;
        PlaneGate next = gates_[i + 1];
        next.open = part;
        Sight sight(gates_[i], layer.on(i));
        if (!sight.pass(next).empty()) see(sight, i + 2);
      }
    }
  }

  // One link more. False when it gets no further.
  bool grow() {
    const Layer& now = layers_.back();
    Layer next;
    next.first = now.last();
    next.reached = {gates_[now.last()].open};  // by a link along the gate
    std::vector<SightLimits> farthest;         // what got to the last gate of `next`
    from_each_start(now, [&](Sight sight, std::size_t j) {
      for (; j <= last_gate(); ++j) {
        count_operations(1);
        const Offsets seen = sight.pass(gates_[j]);
        if (seen.empty()) break;
        if (j > next.last()) farthest.clear();
        next.extend(j, seen);
        if (j == last_gate() && seen.low <= 0 && seen.high >= 0) end_is_seen_ = true;
      }
      if (j == next.last() + 1 && j > now.last() + 1) farthest.push_back(sight.limits());
      return j;
    });
    if (end_is_seen_) return true;  // from the layer before
    if (next.last() == now.last()) return false;
    if (next.last() < last_gate()) find_end(farthest, next);
    layers_.push_back(std::move(next));
    // From the last gate the end is seen along the gate.
    end_is_seen_ = layers_.back().last() == last_gate();
    return true;
  }

  // How far between two gates the farthest links get.
  void find_end(const std::vector<SightLimits>& farthest, Layer& layer) const {
    for (const SightLimits& limits : farthest) {
      const auto seen_at = [&](double part) {
        return limits.seen_on(plane_gate(chain_.between(layer.last(), part)));
      };
      double good = layer.end_part;
      if (seen_at(good).empty() || good >= 1) continue;
      double bad = 1;
      for (int i = 0; i < kEndHalvings; ++i) {
        const double middle = (good + bad) / 2;
        (seen_at(middle).empty() ? bad : good) = middle;
      }
      if (!(good > layer.end_part)) continue;
      layer.end_part = good;
      layer.end = plane_gate(chain_.between(layer.last(), good));
      layer.end_reached = limits.seen_on(*layer.end);
    }
  }

  // The last point of the layer that sees this turn; there, the one nearest to the curve.
  [[nodiscard]] std::optional<GateTurn> turn_before(const GateTurn& turn,
                                                    const Layer& layer) const {
    if (!turn.beyond && turn.gate <= layer.last() && !layer.on(turn.gate).empty()) {
      const Offsets& part = layer.on(turn.gate);
      return GateTurn{turn.gate, false, 0, std::clamp(turn.offset, part.low, part.high)};
    }
    BackwardSight sight(point_of(turn), noise_);
    std::size_t i = turn.beyond ? turn.gate + 1 : turn.gate;  // one gate ahead of the next
    for (; i > layer.last() + 1; --i) {
      if (!sight.pass(gates_[i - 1])) return std::nullopt;
    }
    if (layer.end && turn.gate > layer.last()) {
      const Offsets part = sight.seen_on(*layer.end, layer.end_reached);
      if (!part.empty())
        return GateTurn{layer.last(), true, layer.end_part, nearest_to_curve(part)};
    }
    for (; i > layer.first; --i) {
      const Offsets part = sight.seen_on(gates_[i - 1], layer.on(i - 1));
      if (!part.empty()) return GateTurn{i - 1, false, 0, nearest_to_curve(part)};
      if (!sight.pass(gates_[i - 1])) return std::nullopt;
    }
    return std::nullopt;
  }

  [[nodiscard]] static double nearest_to_curve(const Offsets& part) {
    return std::clamp(0.0, part.low, part.high);
  }

  [[nodiscard]] Point2 point_of(const GateTurn& turn) const {
    return (turn.beyond ? plane_gate(chain_.between(turn.gate, turn.part)) : gates_[turn.gate])
        .at(turn.offset);
  }

  [[nodiscard]] LinkVertex vertex_at(const GateTurn& turn) const {
    const Gate gate = turn.beyond ? chain_.between(turn.gate, turn.part) : chain_[turn.gate];
    const Vector3 normal = in_space(plane_gate(gate).normal);
    return {gate.center + turn.offset * normal, gate.parameter};
  }

  const GateChain& chain_;
  double width_;  // mm, of a gate to each side
  double noise_;  // mm
  Eigen::Matrix<double, 2, 3> axes_;
  std::vector<PlaneGate> gates_;
  std::vector<Layer> layers_;
  bool end_is_seen_ = false;  // from the last layer
};

}  // namespace

std::optional<std::vector<LinkVertex>> min_link_in_plane(const GateChain& gates,
                                                         const Vector3& normal, const Point3& start,
                                                         double width) {
  return GateSweep(gates, normal, start, width).fewest_links(start);
}

}  // namespace batten::geometry
