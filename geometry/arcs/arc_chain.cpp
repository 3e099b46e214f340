#include "geometry/arcs/arc_chain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "geometry/basic/operations.h"
#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"

namespace batten::geometry {
namespace {

constexpr ArcChainTuning kChain = kArcChainTuning;

Point2 in_plane(const Point3& p) { return p.head<2>(); }

// Looks for the farthest u in ]from, limit] where `holds`, beginning with a step of `guess`, down
// to `shortest`. Whoever asks remembers the farthest for which it said so.
template <typename Holds>
void search_farthest(double from, double limit, double guess, double shortest, double precision,
                     const Holds& holds) {
  double step = std::min(guess, limit - from);
  double good = from;
  double bad = from + step;
  if (holds(from + step >= limit ? limit : from + step)) {
    do {
      good = std::min(from + step, limit);
      if (good >= limit) return;
      step *= 2;
      bad = std::min(from + step, limit);
    } while (holds(bad));
  } else {
    do {
      bad = from + step;
      step /= 2;
      if (step < shortest) return;
    } while (!holds(from + step));
    good = from + step;
  }
  while (bad - good > precision * (bad - from)) {
    const double middle = (good + bad) / 2;
    (holds(middle) ? good : bad) = middle;
  }
}

// Where a cubic with these Bernstein coefficients goes from below 0 to above it, between two
// parameters: by Newton's method, which stays between the places known to be below and above.
double passed_at(const std::array<double, 4>& b, double below, double above) {
  constexpr double kNoise = 1e-7;  // of the cubic, far below what a joint may be off
  constexpr int kHalvings = 24;    // come to that, where Newton's method does not
  double t = (below + above) / 2;
  for (int step = 0; step < kHalvings; ++step) {
    const double s = 1 - t;
    const double value = s * s * (s * b[0] + 3 * t * b[1]) + t * t * (3 * s * b[2] + t * b[3]);
    const double slope =
        3 * (s * s * (b[1] - b[0]) + 2 * s * t * (b[2] - b[1]) + t * t * (b[3] - b[2]));
    (value < 0 ? below : above) = t;
    const double next = t - value / slope;
    const double before = t;
    t = next >= below && next <= above ? next : (below + above) / 2;
    if (std::abs(t - before) <= kNoise) break;
  }
  return t;
}

// Of `first` of a pair of arcs, relative to the value for which both are equal.
std::span<const double> joint_balances() {
  constexpr int kPlaces = kChain.joint_places;
  static const auto balances = [] {
    std::array<double, 2 * kPlaces + 1> all;
    for (int i = -kPlaces; i <= kPlaces; ++i) {
      all[i + kPlaces] = std::pow(kChain.widest_joint, static_cast<double>(i) / kPlaces);
    }
    return all;
  }();
  return balances;
}

struct ArcPair {
  PlaneArc first;
  PlaneArc second;
  Vector2 tangent;      // at the joint, before rounding
  double joint_u;       // where the curve passes the joint
  double joint_height;  // of the curve there, rounded
  ChainNode end;
};

class ArcChain {
 public:
  ArcChain(const PlaneCurve& curve, const ArcChainLimits& limits)
      : curve_(curve), limits_(limits) {}

  // The chain of the farthest steps.
  std::optional<std::vector<ChainPiece>> greedy(const ChainNode& start, const ChainNode& end,
                                                std::size_t at_most) const {
    struct OpenPair {  // whose joint is still to be chosen
      std::size_t first;
      ChainNode start;
      ArcPair found;
    };
    std::vector<ChainPiece> pieces;
    std::vector<OpenPair> open;
    ChainNode at = start;
    double guess = end.u - start.u;
    while (at.u < end.u) {
      auto step = next_step(at, end, end.u, guess);
      if (step && step->end.u < end.u &&
          end.u - step->end.u < kChain.remainder * (step->end.u - at.u)) {
        // A short remainder would be all rounding: halve what is left instead.
        const double half = (end.u - at.u) / 2;
        if (auto shorter = next_step(at, end, at.u + half, half)) step = std::move(shorter);
      }
      if (!step || pieces.size() + step->pieces.size() > at_most) return std::nullopt;
      if (step->pair) open.push_back({pieces.size(), at, *step->pair});
      pieces.insert(pieces.end(), step->pieces.begin(), step->pieces.end());
      guess = step->end.u - at.u;
      at = step->end;
      const double done = (at.u - start.u) / (end.u - start.u);
      const bool is_behind = static_cast<double>(pieces.size()) >
                             kChain.hopeless_pace * done * static_cast<double>(at_most);
      if ((done > kChain.pace_known && is_behind) || falls_behind(done, pieces.size(), at_most)) {
        return std::nullopt;
      }
    }
    // The chain goes the same way whichever joints its pairs have, and most chains are given up.
    for (const OpenPair& each : open) {
      std::ranges::copy(pieces_of(best_pair(each.start, each.found)),
                        pieces.begin() + static_cast<std::ptrdiff_t>(each.first));
    }
    return pieces;
  }

  bool reaches(double from, double to) const {
    const ChainNode start{from, rounded(curve_.point_at(from)), curve_.angle_at(from)};
    auto pair = pair_between(start, node_at(start, to, Tangent::kCurve), 1);
    return pair && holds(*pair, start);
  }

 private:
  struct Step {
    std::vector<ChainPiece> pieces;
    ChainNode end;
    std::optional<ArcPair> pair;  // that the two pieces are
  };

  // What the chain's tangent is taken from where it meets the curve.
  enum class Tangent { kCurve, kCrossing };

  Point3 rounded(const Point3& place) const { return rounded_to(limits_.grid, place); }

  Point2 rounded_in_plane(const Point2& place) const {
    return in_plane(rounded({place.x(), place.y(), 0}));
  }

  ChainNode node_at(const ChainNode& start, double u, Tangent tangent) const {
    Point3 place = rounded(curve_.point_at(u));
    if (limits_.flat) place.z() = start.place.z();
    double angle = curve_.angle_at(u);
    if (tangent == Tangent::kCrossing) {
      const double length = (place - start.place).head<2>().norm();
      angle += crossing_angle(u, u - start.u, length / 2);
    }
    return {u, place, angle};
  }

  ChainNode node_before(const ChainNode& start, const ChainNode& end, double u,
                        Tangent tangent) const {
    return u >= end.u ? end : node_at(start, u, tangent);
  }

  // How the tangent of the best chain differs from the curve's where it crosses the curve.
  // Where the curvature changes by k' per mm, the arcs of length L that deviate least cross
  // the curve at their ends, turned there by -k' L^2 / 12, and deviate by T = k' L^3 / 124.7
  // (a third of what arcs do that are tangent to the curve). L follows from T.
  // On a circle L would have no end: there it is bounded by the length that the arc has.
  double crossing_angle(double u, double reach, double arc_length) const {
    const double before = std::max(u - reach / 2, curve_.breaks().front());
    const double after = std::min(u + reach / 2, curve_.breaks().back());
    const double length = (curve_.point_at(after) - curve_.point_at(before)).head<2>().norm();
    if (length <= kSamePlace) return 0;
    const double change = (curve_.curvature_at(after) - curve_.curvature_at(before)) / length;
    const double best = std::cbrt(kChain.best_arc * limits_.deviation / std::abs(change));
    const double used = std::min(best, 2 * arc_length);  // best is infinite on a circle
    return -kChain.crossing_share * change * used * used / 12;
  }

  bool allowed(const PlaneArc& arc) const {
    return arc.is_line() ||
           (arc.radius >= limits_.min_radius && std::abs(arc.sweep) <= limits_.max_sweep);
  }

  bool slopes_hold(const PlaneArc& arc, double from, double to, double from_height,
                   double to_height) const {
    if (limits_.flat) return true;
    const double length = arc.length();
    if (length <= kSamePlace) return false;
    const double slope = (to_height - from_height) / length;
    const double slope_error = kChain.slope_error + 2 * limits_.grid / length;
    const double inside = (to - from) * 1e-6;  // the slopes of this section, not of the next
    for (double u : {from + inside, to - inside}) {
      if (!(std::abs(curve_.slope_at(u) - slope) <= slope_error)) return false;
    }
    return true;
  }

  bool heights_hold(const PlaneArc& arc, double from, double to, double from_height,
                    double to_height) const {
    const Vector2 chord = arc.end - arc.start;
    const Vector2 r0 = arc.start - arc.center;
    // The middle of the arc, from which no angle wraps.
    const double cosine = std::cos(arc.sweep / 2);
    const double sine = std::sin(arc.sweep / 2);
    const Vector2 middle(cosine * r0.x() - sine * r0.y(), sine * r0.x() + cosine * r0.y());
    const auto way = [&](const Point2& p) {
      if (arc.is_line()) return (p - arc.start).dot(chord) / chord.squaredNorm();
      return 0.5 + turn_between(middle, p - arc.center) / arc.sweep;
    };
    // Samples: the ends and three places within each span; the error is a smooth function on
    // each, and the plan's tenth of a margin is left for what lies between.
    for (std::size_t i = curve_.index_of(from); i < curve_.size(); ++i) {
      const double a = std::max(from, curve_.breaks()[i]);
      const double b = std::min(to, curve_.breaks()[i + 1]);
      if (a >= to) break;
      for (double t : {0.25, 0.5, 0.75, 1.0}) {
        const Point3 p = curve_.point_in(i, a + t * (b - a));
        const double expected = from_height + (to_height - from_height) * way(in_plane(p));
        if (std::abs(p.z() - expected) > kChain.sampled_part * limits_.height_deviation)
          return false;
      }
    }
    return true;
  }

  bool holds(const PlaneArc& arc, double from, double to, double from_height,
             double to_height) const {
    if (!allowed(arc) || !(to > from)) return false;
    if (!slopes_hold(arc, from, to, from_height, to_height)) return false;
    const double length = std::hypot(arc.length(), to_height - from_height);
    const ArcSides sides = limits_.running.sides_of(arc, length, limits_.deviation, from, to);
    if (!sides.any()) return false;
    for (std::size_t i = curve_.index_of(from); i < curve_.size(); ++i) {
      if (curve_.breaks()[i] >= to) break;
      count_operations(2);
      if (!stays_near(curve_.part(i, from, to), arc, sides)) return false;
    }
    return limits_.flat || heights_hold(arc, from, to, from_height, to_height);
  }

  // Where the curve passes the normal through the joint.
  double joint_parameter(const Point2& joint, const Vector2& tangent, double from,
                         double to) const {
    const auto before = [&](std::size_t piece) {
      return (in_plane(curve_.piece(piece).control[0]) - joint).dot(tangent) < 0;
    };
    const auto& breaks = curve_.breaks();
    std::size_t low = curve_.index_of(from);
    std::size_t high = curve_.index_of(to);
    while (low < high) {  // the last piece whose start is before the joint
      const std::size_t middle = (low + high + 1) / 2;
      if (breaks[middle] <= from || before(middle)) {
        low = middle;
      } else {
        high = middle - 1;
      }
    }
    std::array<double, 4> ahead;  // of the joint: control points of the piece, mm
    for (std::size_t i = 0; i < 4; ++i) {
      ahead[i] = (in_plane(curve_.piece(low).control[i]) - joint).dot(tangent);
    }
    const double t = passed_at(ahead, curve_.local(low, from), curve_.local(low, to));
    return breaks[low] + t * (breaks[low + 1] - breaks[low]);
  }

  std::optional<ArcPair> pair_between(const ChainNode& start, const ChainNode& end,
                                      double balance) const {
    const Point2 a = in_plane(start.place);
    const Point2 b = in_plane(end.place);
    if ((b - a).norm() <= kSamePlace) return std::nullopt;
    const Vector2 leaving = unit_vector(start.angle);
    const Vector2 arriving = unit_vector(end.angle);
    count_operations(15);
    const auto joint = biarc_joint(a, leaving, b, arriving, balance);
    if (!joint) return std::nullopt;
    const Point2 middle = rounded_in_plane(joint->place);
    ArcPair pair{arc_leaving(a, leaving, middle, limits_.max_radius),
                 arc_arriving(middle, b, arriving, limits_.max_radius),
                 joint->tangent,
                 start.u,
                 start.place.z(),
                 end};
    if (!allowed(pair.first) || !allowed(pair.second)) return std::nullopt;
    const double turn = pair.first.sweep + pair.second.sweep;
    if (std::abs(turn - (end.angle - start.angle)) > kChain.most_turned) return std::nullopt;
    return pair;
  }

  // Whether the curve is there at u. Each arc of a pair is held against the part of the curve
  // beside it and not against its own ends: where that part is no longer than the deviation, lines
  // to a joint far away and back would pass.
  bool is_passed(const Point2& joint, double u) const {
    const double off = (in_plane(curve_.point_at(u)) - joint).norm();
    return off <= 2 * limits_.deviation + limits_.grid;
  }

  bool holds(ArcPair& pair, const ChainNode& start) const {
    pair.joint_u = joint_parameter(pair.first.end, pair.tangent, start.u, pair.end.u);
    if (!is_passed(pair.first.end, pair.joint_u)) return false;
    if (!limits_.flat) pair.joint_height = rounded(curve_.point_at(pair.joint_u)).z();
    // The proof of the first one takes long.
    return slopes_hold(pair.second, pair.joint_u, pair.end.u, pair.joint_height,
                       pair.end.place.z()) &&
           holds(pair.first, start.u, pair.joint_u, start.place.z(), pair.joint_height) &&
           holds(pair.second, pair.joint_u, pair.end.u, pair.joint_height, pair.end.place.z());
  }

  // The joint may lie anywhere on a circle: choose the place where the circle passes nearest
  // to a grid point, so that the two arcs meet without a kink.
  ArcPair best_pair(const ChainNode& start, const ArcPair& found) const {
    if (limits_.grid <= 0) return found;
    struct Joint {
      double kink;
      double balance;
    };
    const Point2 a = in_plane(start.place);
    const Point2 b = in_plane(found.end.place);
    const Vector2 leaving = unit_vector(start.angle);
    const Vector2 arriving = unit_vector(found.end.angle);
    // The sine of the angle at the joint, which rounding forces.
    const auto kink_at = [&](const Point2& middle) {
      return std::abs(cross(mirrored(leaving, middle - a), mirrored(arriving, b - middle)));
    };
    const double most = kink_at(found.first.end);
    std::vector<Joint> joints;
    for (const double balance : joint_balances()) {
      const auto joint = biarc_joint(a, leaving, b, arriving, balance);
      if (!joint) continue;
      const double kink = kink_at(rounded_in_plane(joint->place));
      if (kink < most) joints.push_back({kink, balance});
    }
    std::ranges::stable_sort(joints, {}, &Joint::kink);
    for (const Joint& joint : joints) {
      auto pair = pair_between(start, found.end, joint.balance);
      if (pair && holds(*pair, start)) return *pair;
    }
    return found;
  }

  // No arc holds: the bend is tighter than the least radius. A short chord across it.
  std::optional<Step> line_step(const ChainNode& start, const ChainNode& end) const {
    const double longest =
        std::max(4 * limits_.min_radius, kChain.shortest_in_grids * limits_.grid);
    std::optional<Step> best;
    const auto line_holds = [&](double u) {
      const ChainNode node = node_before(start, end, u, Tangent::kCurve);
      const PlaneArc line{in_plane(start.place), in_plane(node.place)};
      if (line.length() <= kSamePlace || line.length() > longest ||
          !holds(line, start.u, u, start.place.z(), node.place.z())) {
        return false;
      }
      if (!best || u > best->end.u) best = Step{{ChainPiece{line, node.place.z()}}, node, {}};
      return true;
    };
    const double all = end.u - start.u;
    search_farthest(start.u, end.u, all, 1e-9 * all, limits_.precision, line_holds);
    return best;
  }

  // Parameters run about with the length, in whatever unit: the whole section says it.
  double shortest_step(const ChainNode& start, const ChainNode& end) const {
    const double length = std::max(kChain.shortest, kChain.shortest_in_grids * limits_.grid);
    const double span = (end.place - start.place).norm() + kSamePlace;
    return (end.u - start.u) * std::min(kChain.part_of_section, length / span);
  }

  std::optional<ArcPair> farthest_pair(const ChainNode& start, const ChainNode& end, double limit,
                                       double guess, Tangent tangent) const {
    std::optional<ArcPair> best;
    const auto pair_holds = [&](double u) {
      auto pair = pair_between(start, node_before(start, end, u, tangent), 1);
      if (!pair || !holds(*pair, start)) return false;
      if (!best || pair->end.u > best->end.u) best = std::move(pair);
      return true;
    };
    search_farthest(start.u, limit, guess, shortest_step(start, end), limits_.precision,
                    pair_holds);
    return best;
  }

  // One arc that leaves `start` along its tangent and meets the curve again at about the best
  // angle (at the end of the section: at the tangent there).
  std::optional<Step> farthest_single(const ChainNode& start, const ChainNode& end, double limit,
                                      double least, double guess) const {
    std::optional<Step> best;
    const Vector2 leaving = unit_vector(start.angle);
    const auto single_holds = [&](double u) {
      ChainNode node = node_before(start, end, u, Tangent::kCurve);
      const PlaneArc arc =
          arc_leaving(in_plane(start.place), leaving, in_plane(node.place), limits_.max_radius);
      const double length = arc.length();
      if (length <= kSamePlace ||
          std::abs(arc.sweep - (node.angle - start.angle)) > kChain.most_turned) {
        return false;
      }
      double wanted = node.angle;
      double most = kChain.kink_noise + 2 * limits_.grid / length;
      if (u < end.u) {
        wanted += crossing_angle(u, u - start.u, length);
        most = kChain.crossing_noise * limits_.deviation / length;
        node.angle = start.angle + arc.sweep;
      }
      if (std::abs(start.angle + arc.sweep - wanted) > most ||
          !holds(arc, start.u, u, start.place.z(), node.place.z())) {
        return false;
      }
      if (!best || u > best->end.u) best = Step{{{arc, node.place.z()}}, node, {}};
      return true;
    };
    if (least > start.u && !single_holds(least)) return std::nullopt;
    if (least < limit) {
      search_farthest(start.u, limit, guess, shortest_step(start, end), limits_.precision,
                      single_holds);
    }
    return best;
  }

  std::optional<Step> next_step(const ChainNode& start, const ChainNode& end, double limit,
                                double guess) const {
    auto pair = farthest_pair(start, end, limit, guess, Tangent::kCrossing);
    if (!pair || pair->end.u - start.u < kChain.stumble * guess) {
      // The crossing angles expect even changes of curvature; the curve's own tangents do not.
      auto other = farthest_pair(start, end, limit, guess, Tangent::kCurve);
      if (other && (!pair || other->end.u > pair->end.u)) pair = std::move(other);
    }
    if (!pair) {
      auto single = farthest_single(start, end, limit, start.u, guess);
      return single ? single : line_step(start, end);
    }
    const double reach = pair->end.u - start.u;
    const double least = pair->end.u >= limit ? limit : start.u + kChain.single_reach * reach;
    if (auto single = farthest_single(start, end, limit, least, kChain.single_reach * reach))
      return single;
    return Step{pieces_of(*pair), pair->end, *pair};
  }

  static std::vector<ChainPiece> pieces_of(const ArcPair& pair) {
    return {ChainPiece{pair.first, pair.joint_height}, ChainPiece{pair.second, pair.end.place.z()}};
  }

  const PlaneCurve& curve_;
  const ArcChainLimits& limits_;
};

}  // namespace

bool falls_behind(double done, std::size_t used, std::size_t most) {
  return static_cast<double>(used) >
         kChain.pieces_ahead + kChain.hopeless_pace * done * static_cast<double>(most);
}

Point3 rounded_to(double grid, const Point3& place) {
  if (grid <= 0) return place;
  return (place / grid).array().round().matrix() * grid;
}

bool pair_of_arcs_holds(const PlaneCurve& curve, const ArcChainLimits& limits, double from,
                        double to) {
  return ArcChain(curve, limits).reaches(from, to);
}

std::optional<std::vector<ChainPiece>> arc_chain(const PlaneCurve& curve,
                                                 const ArcChainLimits& limits,
                                                 const ChainNode& start, const ChainNode& end,
                                                 std::size_t at_most) {
  return ArcChain(curve, limits).greedy(start, end, at_most);
}

std::vector<ChainPiece> balanced(const PlaneCurve& curve, const ArcChainLimits& limits,
                                 const ChainNode& start, const ChainNode& end,
                                 std::vector<ChainPiece> chain) {
  if (chain.size() > kChain.balanced_pieces) return chain;
  double good = 1;
  double small = 0;
  for (int round = 0; round < kChain.balancing_rounds && chain.size() > 2; ++round) {
    const double part = (good + small) / 2;
    ArcChainLimits narrower = limits;
    narrower.deviation *= part;
    narrower.max_sweep *= std::cbrt(part);  // deviations grow with the cube of the length
    auto found = ArcChain(curve, narrower).greedy(start, end, chain.size());
    if (found) {
      chain = std::move(*found);
      good = part;
    } else {
      small = part;
    }
  }
  return chain;
}

}  // namespace batten::geometry
