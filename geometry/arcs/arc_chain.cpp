#include "geometry/arcs/arc_chain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"

namespace batten::geometry {
namespace {

// A single arc is taken instead of a pair when it reaches this part of the pair's length:
// one piece then covers more than a piece of the pair does.
constexpr double kSingleReach = 0.6;

// A step that is this much shorter than the one before may have failed by its end's tangent.
constexpr double kStumble = 0.5;

// What is left after a step, relative to it, that would make a last step too short.
constexpr double kRemainder = 0.3;

// Behind a fifth of the way a chain that has used up half as much again as its share of the pieces
// will not do with them.
constexpr double kPaceKnown = 0.2;
constexpr double kHopelessPace = 1.5;

// Nor will one that has used so many pieces more than that, however short the way was.
constexpr double kPiecesAhead = 64;

// Kink (radians) of a single arc at a fixed tangent that is noise of a fitted curve.
constexpr double kKinkNoise = 1e-5;

// 36 sqrt(12): see ArcChain::crossing_angle.
constexpr double kBestArc = 124.7;

// How much of that angle is used. With all of it only chains of just the best length hold,
// shorter ones swing too far, and the search would fall between; half of it already gives
// 16 % longer arcs than tangents of the curve, and holds at every length.
constexpr double kCrossingShare = 0.5;

// A single arc may miss the best crossing angle (10.4 T / L) by this much: more would cost
// the next arc.
constexpr double kCrossingNoise = 2;  // times T / L

// Greatest error of a helix' rise per mm against the curve's, so that the direction in
// space does not jump where heights are within their tolerance.
constexpr double kSlopeError = 5e-3;

// The deviation is narrowed by halving the doubt so often; only for chains so short that
// the last step can be a remainder that is worth spreading.
constexpr int kArcBalancingRounds = 5;
constexpr std::size_t kBalancedPieces = 60;

// Shortest step, in grid units: below, rounding turns a tangent by a tenth of a radian.
constexpr double kShortestInGrids = 10;
constexpr double kShortest = 1e-5;  // mm, without a grid

// A joint is about as far from the curve as the arcs that meet there. One that is farther away by
// this many times the deviation, and a step of the grid, is none, whatever noise there is.
constexpr double kJointOff = 10;

Point2 in_plane(const Point3& p) { return p.head<2>(); }

// The farthest u in ]from, limit] where `holds`, starting with a step of `guess`; `from`
// when none was found above `shortest`.
template <typename Holds>
double farthest(double from, double limit, double guess, double shortest, double precision,
                const Holds& holds) {
  double good = from;
  double bad = limit;
  double step = std::min(guess, limit - from);
  if (holds(from + step >= limit ? limit : from + step)) {
    for (;;) {
      good = std::min(from + step, limit);
      if (good >= limit) return limit;
      step *= 2;
      const double next = std::min(from + step, limit);
      if (!holds(next)) {
        bad = next;
        break;
      }
    }
  } else {
    for (;;) {
      bad = from + step;
      step /= 2;
      if (step < shortest) return from;
      if (holds(from + step)) {
        good = from + step;
        break;
      }
    }
  }
  while (bad - good > precision * (bad - from)) {
    const double middle = (good + bad) / 2;
    (holds(middle) ? good : bad) = middle;
  }
  return good;
}

}  // namespace

bool falls_behind(double done, std::size_t used, std::size_t most) {
  return static_cast<double>(used) >
         kPiecesAhead + kHopelessPace * done * static_cast<double>(most);
}

Point3 ArcChain::rounded(const Point3& place) const {
  if (limits_.grid <= 0) return place;
  return (place / limits_.grid).array().round().matrix() * limits_.grid;
}

// How the tangent of the best chain differs from the curve's where it crosses the curve.
// Where the curvature changes by k' per mm, the arcs of length L that deviate least cross
// the curve at their ends, turned there by -k' L^2 / 12, and deviate by T = k' L^3 / 124.7
// (a third of what arcs do that are tangent to the curve). L follows from T.
// On a circle L would have no end: there it is bounded by the length that the arc has.
double ArcChain::crossing_angle(double u, double reach, double arc_length) const {
  const double before = std::max(u - reach / 2, curve_.breaks().front());
  const double after = std::min(u + reach / 2, curve_.breaks().back());
  const double length = (curve_.point_at(after) - curve_.point_at(before)).head<2>().norm();
  if (length <= kSamePlace) return 0;
  const double change = (curve_.curvature_at(after) - curve_.curvature_at(before)) / length;
  const double best = std::cbrt(kBestArc * limits_.deviation / std::abs(change));
  const double used = std::min(best, 2 * arc_length);  // best is infinite on a circle
  return -kCrossingShare * change * used * used / 12;
}

ChainNode ArcChain::node_at(const ChainNode& start, double u, Tangent tangent) const {
  Point3 place = rounded(curve_.point_at(u));
  if (limits_.flat) place.z() = start.place.z();
  double angle = curve_.angle_at(u);
  if (tangent == Tangent::kCrossing) {
    const double length = (place - start.place).head<2>().norm();
    angle += crossing_angle(u, u - start.u, length / 2);
  }
  return {u, place, angle};
}

bool ArcChain::allowed(const PlaneArc& arc) const {
  return arc.is_line() ||
         (arc.radius >= limits_.min_radius && std::abs(arc.sweep) <= limits_.max_sweep);
}

bool ArcChain::heights_hold(const PlaneArc& arc, double from, double to, double from_height,
                            double to_height) const {
  const double length = arc.length();
  if (length <= kSamePlace) return false;
  const double slope = (to_height - from_height) / length;
  const double slope_error = kSlopeError + 2 * limits_.grid / length;
  const double inside = (to - from) * 1e-6;  // the slopes of this stretch, not of the next
  for (double u : {from + inside, to - inside}) {
    if (!(std::abs(curve_.slope_at(u) - slope) <= slope_error)) return false;
  }
  const auto way = [&arc](const Point2& p) {
    if (arc.is_line()) {
      const Vector2 chord = arc.end - arc.start;
      return (p - arc.start).dot(chord) / chord.squaredNorm();
    }
    const Vector2 r0 = arc.start - arc.center;
    const Vector2 r = p - arc.center;
    // From the middle of the arc, where no angle wraps.
    const Vector2 middle(std::cos(arc.sweep / 2) * r0.x() - std::sin(arc.sweep / 2) * r0.y(),
                         std::sin(arc.sweep / 2) * r0.x() + std::cos(arc.sweep / 2) * r0.y());
    return 0.5 + std::atan2(cross(middle, r), middle.dot(r)) / arc.sweep;
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
      if (std::abs(p.z() - expected) > 0.9 * limits_.height_deviation) return false;
    }
  }
  return true;
}

bool ArcChain::holds(const PlaneArc& arc, double from, double to, double from_height,
                     double to_height) const {
  if (!allowed(arc) || !(to > from)) return false;
  for (std::size_t i = curve_.index_of(from); i < curve_.size(); ++i) {
    if (curve_.breaks()[i] >= to) break;
    if (!stays_near(curve_.part(i, from, to), arc, limits_.deviation)) return false;
  }
  return limits_.flat || heights_hold(arc, from, to, from_height, to_height);
}

// Where the curve passes the normal through the joint.
double ArcChain::joint_parameter(const Point2& joint, const Vector2& tangent, double from,
                                 double to) const {
  const auto before = [&](std::size_t piece, double u) {
    return (in_plane(curve_.point_in(piece, u)) - joint).dot(tangent) < 0;
  };
  const auto& breaks = curve_.breaks();
  std::size_t low = curve_.index_of(from);
  std::size_t high = curve_.index_of(to);
  while (low < high) {  // the last piece whose start is before the joint
    const std::size_t middle = (low + high + 1) / 2;
    if (breaks[middle] <= from || before(middle, breaks[middle])) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  double good = std::max(from, breaks[low]);
  double bad = std::min(to, breaks[low + 1]);
  constexpr int kSteps = 24;  // 1e-7 of a piece
  for (int step = 0; step < kSteps; ++step) {
    const double middle = (good + bad) / 2;
    (before(low, middle) ? good : bad) = middle;
  }
  return (good + bad) / 2;
}

std::optional<ArcPair> ArcChain::pair_between(const ChainNode& start, const ChainNode& end,
                                              double balance) const {
  const Point2 a = in_plane(start.place);
  const Point2 b = in_plane(end.place);
  if ((b - a).norm() <= kSamePlace) return std::nullopt;
  const auto joint = biarc_joint(a, start.angle, b, end.angle, balance);
  if (!joint) return std::nullopt;
  const Point2 middle = in_plane(rounded({joint->place.x(), joint->place.y(), 0}));
  ArcPair pair{arc_leaving(a, start.angle, middle, limits_.max_radius),
               arc_arriving(middle, b, end.angle, limits_.max_radius),
               joint->tangent,
               start.u,
               start.place.z(),
               0,
               end};
  if (!allowed(pair.first) || !allowed(pair.second)) return std::nullopt;
  // The pair turns as much as the curve does: no turn more or less.
  const double turn = pair.first.sweep + pair.second.sweep;
  if (std::abs(turn - (end.angle - start.angle)) > 1) return std::nullopt;
  pair.kink =
      std::abs(wrapped(pair.second.start_angle() - pair.first.start_angle() - pair.first.sweep));
  return pair;
}

// Whether the curve is there at u. Each arc of a pair is held against the part of the curve beside
// it and not against its own ends: where that part is no longer than the deviation, lines to a
// joint far away and back would pass.
bool ArcChain::is_passed(const Point2& joint, double u) const {
  const double off = (in_plane(curve_.point_at(u)) - joint).norm();
  return off <= kJointOff * limits_.deviation + limits_.grid;
}

bool ArcChain::holds(ArcPair& pair, const ChainNode& start) const {
  pair.joint_u = joint_parameter(pair.first.end, pair.tangent, start.u, pair.end.u);
  if (!is_passed(pair.first.end, pair.joint_u)) return false;
  if (!limits_.flat) pair.joint_height = rounded(curve_.point_at(pair.joint_u)).z();
  return holds(pair.first, start.u, pair.joint_u, start.place.z(), pair.joint_height) &&
         holds(pair.second, pair.joint_u, pair.end.u, pair.joint_height, pair.end.place.z());
}

std::optional<ArcPair> ArcChain::pair_to(const ChainNode& start, double u) const {
  auto pair = pair_between(start, node_at(start, u, Tangent::kCurve), 1);
  if (pair && !holds(*pair, start)) return std::nullopt;
  return pair;
}

// The joint may lie anywhere on a circle: choose the place where the circle passes nearest
// to a grid point, so that the two arcs meet without a kink.
ArcPair ArcChain::best_pair(const ChainNode& start, const ArcPair& found) const {
  if (limits_.grid <= 0) return found;
  constexpr int kPlaces = 40;
  constexpr double kWidest = 1.3;  // beyond, one arc is much shorter than the other
  std::vector<ArcPair> pairs;
  for (int i = -kPlaces; i <= kPlaces; ++i) {
    const double balance = std::pow(kWidest, static_cast<double>(i) / kPlaces);
    if (const auto pair = pair_between(start, found.end, balance)) pairs.push_back(*pair);
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const ArcPair& a, const ArcPair& b) { return a.kink < b.kink; });
  for (ArcPair& pair : pairs) {
    if (pair.kink >= found.kink) break;
    if (holds(pair, start)) return pair;
  }
  return found;
}

std::optional<ChainPiece> ArcChain::single_to(const ChainNode& start, const ChainNode& end) const {
  const PlaneArc arc =
      arc_leaving(in_plane(start.place), start.angle, in_plane(end.place), limits_.max_radius);
  const double length = arc.length();
  if (length <= kSamePlace) return std::nullopt;
  const double turned = end.angle - start.angle;
  if (std::abs(arc.sweep - turned) > 1) return std::nullopt;
  if (!holds(arc, start.u, end.u, start.place.z(), end.place.z())) return std::nullopt;
  return ChainPiece{arc, end.place.z(), end.u};
}

// No arc holds: the place is tighter than the least radius. A short chord across it.
std::optional<ArcChain::Step> ArcChain::line_step(const ChainNode& start,
                                                  const ChainNode& end) const {
  const double longest = std::max(4 * limits_.min_radius, kShortestInGrids * limits_.grid);
  const auto line_to = [&](double u) {
    const ChainNode node = u >= end.u ? end : node_at(start, u, Tangent::kCurve);
    return PlaneArc{in_plane(start.place), in_plane(node.place)};
  };
  const auto height_of = [&](double u) {
    return u >= end.u ? end.place.z() : node_at(start, u, Tangent::kCurve).place.z();
  };
  const auto line_holds = [&](double u) {
    const PlaneArc line = line_to(u);
    return line.length() > kSamePlace && line.length() <= longest &&
           holds(line, start.u, u, start.place.z(), height_of(u));
  };
  const double all = end.u - start.u;
  const double reach = farthest(start.u, end.u, all, 1e-9 * all, limits_.precision, line_holds);
  if (reach <= start.u) return std::nullopt;
  const ChainNode node = reach >= end.u ? end : node_at(start, reach, Tangent::kCurve);
  return Step{{ChainPiece{line_to(reach), node.place.z(), reach}}, node, {}};
}

// Parameters run about with the length, in whatever unit: the whole stretch tells it.
double ArcChain::shortest_step(const ChainNode& start, const ChainNode& end) const {
  const double length = std::max(kShortest, kShortestInGrids * limits_.grid);
  const double span = (end.place - start.place).norm() + kSamePlace;
  constexpr double kPartOfStretch = 0.01;  // a closed stretch has no span
  return (end.u - start.u) * std::min(kPartOfStretch, length / span);
}

std::optional<ArcPair> ArcChain::farthest_pair(const ChainNode& start, const ChainNode& end,
                                               double limit, double guess, Tangent tangent) const {
  std::optional<ArcPair> best;
  const auto pair_holds = [&](double u) {
    auto pair = pair_between(start, u >= end.u ? end : node_at(start, u, tangent), 1);
    if (!pair || !holds(*pair, start)) return false;
    if (!best || pair->end.u > best->end.u) best = std::move(pair);
    return true;
  };
  (void)farthest(start.u, limit, guess, shortest_step(start, end), limits_.precision, pair_holds);
  return best;
}

// One arc that leaves `start` along its tangent and meets the curve again at about the best
// angle (at the end of the stretch: at the tangent there).
std::optional<ArcChain::Step> ArcChain::farthest_single(const ChainNode& start,
                                                        const ChainNode& end, double limit,
                                                        double least, double guess) const {
  std::optional<Step> best;
  const auto single_holds = [&](double u) {
    ChainNode node = u >= end.u ? end : node_at(start, u, Tangent::kCurve);
    const auto piece = single_to(start, node);
    if (!piece) return false;
    const double length = piece->arc.length();
    double wanted = node.angle;
    double most = kKinkNoise + 2 * limits_.grid / length;
    if (u < end.u) {
      wanted += crossing_angle(u, u - start.u, length);
      most = kCrossingNoise * limits_.deviation / length;
      node.angle = start.angle + piece->arc.sweep;
    }
    if (std::abs(start.angle + piece->arc.sweep - wanted) > most) return false;
    if (!best || u > best->end.u) best = Step{{*piece}, node, {}};
    return true;
  };
  if (least > start.u && !single_holds(least)) return std::nullopt;
  if (least < limit) {
    (void)farthest(start.u, limit, guess, shortest_step(start, end), limits_.precision,
                   single_holds);
  }
  return best;
}

std::optional<ArcChain::Step> ArcChain::next_step(const ChainNode& start, const ChainNode& end,
                                                  double limit, double guess) const {
  auto pair = farthest_pair(start, end, limit, guess, Tangent::kCrossing);
  if (!pair || pair->end.u - start.u < kStumble * guess) {
    // The crossing angles expect even changes of curvature; the curve's own tangents do not.
    auto other = farthest_pair(start, end, limit, guess, Tangent::kCurve);
    if (other && (!pair || other->end.u > pair->end.u)) pair = std::move(other);
  }
  if (!pair) {
    auto single = farthest_single(start, end, limit, start.u, guess);
    return single ? single : line_step(start, end);
  }
  const double reach = pair->end.u - start.u;
  const double least = pair->end.u >= limit ? limit : start.u + kSingleReach * reach;
  if (auto single = farthest_single(start, end, limit, least, kSingleReach * reach)) return single;
  return Step{pieces_of(*pair), pair->end, OpenPair{start, *pair}};
}

std::vector<ChainPiece> ArcChain::pieces_of(const ArcPair& pair) {
  return {ChainPiece{pair.first, pair.joint_height, pair.joint_u},
          ChainPiece{pair.second, pair.end.place.z(), pair.end.u}};
}

ArcChain::Walk ArcChain::walk(const ChainNode& start, const ChainNode& end, double whole,
                              std::size_t at_most) const {
  Walk walk;
  const auto most = static_cast<double>(at_most);
  ChainNode at = start;
  double guess = end.u - start.u;
  while (at.u < end.u) {
    walk.reached = at.u;
    auto step = next_step(at, end, end.u, guess);
    if (step && end.u - step->end.u < kRemainder * (step->end.u - at.u) && step->end.u < end.u) {
      // A short remainder would be all rounding: halve what is left instead.
      const double half = (end.u - at.u) / 2;
      if (auto shorter = next_step(at, end, at.u + half, half)) step = std::move(shorter);
    }
    walk.outcome = Outcome::kStuck;
    if (!step) return walk;
    walk.outcome = Outcome::kBehind;
    if (walk.pieces.size() + step->pieces.size() > at_most) return walk;
    if (step->open) walk.open.emplace_back(walk.pieces.size(), *step->open);
    walk.pieces.insert(walk.pieces.end(), step->pieces.begin(), step->pieces.end());
    guess = step->end.u - at.u;
    at = step->end;
    const double done = (at.u - start.u) / (whole - start.u);
    const bool is_behind = static_cast<double>(walk.pieces.size()) > kHopelessPace * done * most;
    if ((done > kPaceKnown && is_behind) || falls_behind(done, walk.pieces.size(), at_most)) {
      return walk;
    }
  }
  walk.outcome = Outcome::kArrived;
  return walk;
}

bool ArcChain::fails_before(const ChainNode& start, const ChainNode& end, double whole,
                            std::size_t at_most) const {
  const Walk found = walk(start, end, whole, at_most);
  const bool far_from_end = found.reached < (start.u + end.u) / 2;
  return found.outcome == Outcome::kBehind || (found.outcome == Outcome::kStuck && far_from_end);
}

std::optional<std::vector<ChainPiece>> ArcChain::greedy(const ChainNode& start,
                                                        const ChainNode& end,
                                                        std::size_t at_most) const {
  Walk found = walk(start, end, end.u, at_most);
  if (found.outcome != Outcome::kArrived) return std::nullopt;
  // The chain goes the same way whichever joints its pairs have, and most chains are given up.
  for (const auto& [first, pair] : found.open) {
    std::ranges::copy(pieces_of(best_pair(pair.start, pair.found)),
                      found.pieces.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return std::move(found.pieces);
}

std::optional<std::vector<ChainPiece>> ArcChain::between(const ChainNode& start,
                                                         const ChainNode& end,
                                                         std::size_t at_most) const {
  auto best = greedy(start, end, at_most);
  if (best && best->size() <= kBalancedPieces) best = balanced(start, end, std::move(best));
  return best;
}

std::optional<std::vector<ChainPiece>> ArcChain::balanced(
    const ChainNode& start, const ChainNode& end,
    std::optional<std::vector<ChainPiece>> best) const {
  // With as many pieces, how much smaller can the deviation be?
  double good = 1;
  double small = 0;
  for (int round = 0; round < kArcBalancingRounds && best->size() > 2; ++round) {
    const double part = (good + small) / 2;
    ArcChainLimits narrower = limits_;
    narrower.deviation *= part;
    narrower.max_sweep *= std::cbrt(part);  // deviations grow with the cube of the length
    auto chain = ArcChain(curve_, narrower).greedy(start, end, best->size());
    if (chain) {
      best = std::move(chain);
      good = part;
    } else {
      small = part;
    }
  }
  return best;
}

}  // namespace batten::geometry
