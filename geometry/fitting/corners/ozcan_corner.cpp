#include "geometry/fitting/corners/ozcan_corner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/numeric/extrema.h"

namespace batten::geometry {
namespace {

void require_decreasing(const std::array<double, 3>& leg) {
  if (leg[0] > leg[1] && leg[1] > leg[2] && leg[2] > 0) return;
  throw std::invalid_argument("ozcan_corner: points " + std::to_string(leg[0]) + ", " +
                              std::to_string(leg[1]) + ", " + std::to_string(leg[2]) +
                              " mm from the vertex, expected decreasing positive numbers");
}

// One corner with its legs and limits: what each pair of middle points is worth.
struct Problem {
  CornerFrame frame;
  OzcanLegs legs;
  double tolerance;
  ToleranceKind kind;
  KinematicLimits limits;

  [[nodiscard]] double deviation(const BesideLeg& fourth, const BesideLeg& fifth) const {
    return measure_deviation(ozcan_curve(frame, legs, fourth, fifth), frame, kind);
  }

  [[nodiscard]] OzcanBlend blend(const BesideLeg& fourth, const BesideLeg& fifth,
                                 int evaluations) const {
    BsplineCurve curve = ozcan_curve(frame, legs, fourth, fifth);
    const BlendDeviation found = measure_blend(curve, frame);
    const double feed = feed_estimate(curve, limits);
    return {{std::move(curve), found}, fourth, fifth, feed, evaluations};
  }
};

// The middle points between P3 and the vertex, on the leg or outside, so that the feet on the
// legs go forward.
bool goes_forward(const CornerFrame& frame, const BesideLeg& middle, double third) {
  return middle.along >= 0 && middle.along <= third &&
         middle.outward * frame.cos_half >= -middle.along * frame.sin_half;
}

// How deep a middle point pulls the middle of the curve inside, along the bisector, if the
// other side did the same: C(2.5) = (P3 + 23 P4 + 23 P5 + P6) / 48. The search runs over this
// depth and the distance from the leg, since the tolerance limits the one and the other.
struct DepthAndOutward {
  double depth;
  double outward;
};

DepthAndOutward depth_of(const CornerFrame& frame, const BesideLeg& middle, double third) {
  const double c = frame.cos_half;
  const double s = frame.sin_half;
  return {(c * third + 23 * (c * middle.along - s * middle.outward)) / 24, middle.outward};
}

BesideLeg place_of(const CornerFrame& frame, const DepthAndOutward& d, double third) {
  const double c = frame.cos_half;
  const double s = frame.sin_half;
  return {((24 * d.depth - c * third) / 23 + s * d.outward) / c, d.outward};
}

// The search's variables: one depth and distance for mirrored points, two for free ones.
class MiddlePoints {
 public:
  MiddlePoints(const Problem& problem, bool mirrored) : problem_(problem), mirrored_(mirrored) {}

  std::vector<double> variables(const BesideLeg& fourth, const BesideLeg& fifth) const {
    const DepthAndOutward one = depth_of(problem_.frame, fourth, problem_.legs.before[2]);
    if (mirrored_) return {one.depth, one.outward};
    const DepthAndOutward other = depth_of(problem_.frame, fifth, problem_.legs.after[2]);
    return {one.depth, one.outward, other.depth, other.outward};
  }

  std::pair<BesideLeg, BesideLeg> places(const std::vector<double>& v) const {
    const BesideLeg fourth = place_of(problem_.frame, {v[0], v[1]}, problem_.legs.before[2]);
    if (mirrored_) return {fourth, fourth};
    return {fourth, place_of(problem_.frame, {v[2], v[3]}, problem_.legs.after[2])};
  }

  // A tolerance in either variable, less where the leg is short for that.
  std::vector<double> steps() const {
    const CornerFrame& frame = problem_.frame;
    const auto pair = [&](double third) {
      return std::pair{std::min(problem_.tolerance, frame.cos_half * third / 2),
                       std::min(problem_.tolerance, third / 2)};
    };
    const auto [depth, outward] = pair(problem_.legs.before[2]);
    if (mirrored_) return {depth, outward};
    const auto [depth5, outward5] = pair(problem_.legs.after[2]);
    return {depth, outward, depth5, outward5};
  }

  // The paper's objective (11): the deviation, weighed so that it outdoes all else, where the
  // tolerance is broken; else the inverse of the feed.
  double cost(const std::vector<double>& v) const {
    constexpr double kBroken = 1e6;  // s/mm^2; no feed is as slow as 1e-6 mm/s over 1 mm
    const auto [fourth, fifth] = places(v);
    const CornerFrame& frame = problem_.frame;
    if (!goes_forward(frame, fourth, problem_.legs.before[2]) ||
        !goes_forward(frame, fifth, problem_.legs.after[2])) {
      return std::numeric_limits<double>::infinity();
    }
    const BsplineCurve curve = ozcan_curve(frame, problem_.legs, fourth, fifth);
    const double deviation = measure_deviation(curve, frame, problem_.kind);
    if (deviation > problem_.tolerance) return kBroken * (1 + deviation);
    return 1 / feed_estimate(curve, problem_.limits);
  }

 private:
  const Problem& problem_;
  bool mirrored_;
};

// The greatest t in [0, 1] for which P4 and P5 at t of P3 and P6 hold the tolerance; negative
// where none does.
double usual_part(const Problem& problem) {
  const auto holds = [&](double t) {
    return problem.deviation({t * problem.legs.before[2], 0}, {t * problem.legs.after[2], 0}) <=
           problem.tolerance;
  };
  if (!holds(0)) return -1;
  if (holds(1)) return 1;
  double low = 0;
  double high = 1;
  constexpr int kHalvings = 48;  // to rounding: the deviation is right to 1e-14 of the blend
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

std::variant<OzcanBlend, NoBlend> usual_of(const Problem& problem) {
  const double t = usual_part(problem);
  if (t < 0) return NoBlend::kNoRoom;
  return problem.blend({t * problem.legs.before[2], 0}, {t * problem.legs.after[2], 0}, 1);
}

Problem checked_problem(const CornerFrame& frame, const OzcanLegs& legs, double tolerance,
                        ToleranceKind kind, const KinematicLimits& limits) {
  require_positive_tolerance(tolerance, "ozcan_corner");
  require_decreasing(legs.before);
  require_decreasing(legs.after);
  return {frame, legs, tolerance, kind, limits};
}

// Mirrored points move by two numbers, free ones by four.
constexpr int kMirroredEvaluations = 600;
constexpr int kFreeEvaluations = 2400;

// Of the first step, about a tolerance: a ten-thousandth of it changes no feed by a thousandth.
constexpr double kFinest = 1e-4;

OzcanBlend searched(const Problem& problem, const OzcanBlend& from, bool mirrored) {
  const MiddlePoints points(problem, mirrored);
  PatternSearchOptions options;
  options.steps = points.steps();
  options.finest = kFinest;
  options.max_evaluations = mirrored ? kMirroredEvaluations : kFreeEvaluations;
  const auto found = pattern_search([&](const auto& v) { return points.cost(v); },
                                    points.variables(from.fourth, from.fifth), options);
  const auto [fourth, fifth] = points.places(found.at);
  OzcanBlend best = problem.blend(fourth, fifth, from.evaluations + found.evaluations);
  // The way from places to depths and back may lose the last digit of the start.
  const bool holds = deviation_of(best.blend.deviation, problem.kind) <= problem.tolerance;
  return holds && best.feed_estimate >= from.feed_estimate ? best : from;
}

OzcanBlend turned_back(const OzcanBlend& blend) {
  return {{blend.blend.curve.reversed(), blend.blend.deviation},
          blend.fifth,
          blend.fourth,
          blend.feed_estimate,
          blend.evaluations};
}

}  // namespace

OzcanLegs ozcan_legs(const CornerFrame& frame, double tolerance, ToleranceKind kind,
                     double share_before, double share_after) {
  require_positive_tolerance(tolerance, "ozcan_legs");
  // With P4 and P5 in the vertex and P3, P6 at d, the middle is d cos / 24 from the vertex, and
  // sin times that from the legs.
  // Of the tolerance. Where that curve uses more, the corner is cramped; where it uses less, the
  // curve has less length to turn on: docs/algorithms/ozcan.md has the table.
  constexpr double kSharpest = 0.35;
  const double sine = kind == ToleranceKind::kBand ? frame.sin_half : 1;
  const double third = 24 * kSharpest * tolerance / (frame.cos_half * sine);
  const auto leg = [&](double share, double length) -> std::array<double, 3> {
    const double reach = std::min({share, length, 2 * third});
    return {reach, 0.75 * reach, 0.5 * reach};
  };
  return {leg(share_before, frame.length_a), leg(share_after, frame.length_b)};
}

BsplineCurve ozcan_curve(const CornerFrame& frame, const OzcanLegs& legs, const BesideLeg& fourth,
                         const BesideLeg& fifth) {
  const Point3& q = frame.vertex;
  const auto& before = legs.before;
  const auto& after = legs.after;
  std::vector<Point3> points = {
      q + before[0] * frame.a,
      q + before[1] * frame.a,
      q + before[2] * frame.a,
      q + fourth.along * frame.a + fourth.outward * frame.outward_a(),
      q + fifth.along * frame.b + fifth.outward * frame.outward_b(),
      q + after[2] * frame.b,
      q + after[1] * frame.b,
      q + after[0] * frame.b,
  };
  return {BsplineBasis::clamped(3, {0, 1, 2, 3, 4, 5}), std::move(points)};
}

std::variant<OzcanBlend, NoBlend> ozcan_usual(const CornerFrame& frame, const OzcanLegs& legs,
                                              double tolerance, ToleranceKind kind,
                                              const KinematicLimits& limits) {
  return usual_of(checked_problem(frame, legs, tolerance, kind, limits));
}

std::variant<OzcanBlend, NoBlend> ozcan_optimum(const CornerFrame& frame, const OzcanLegs& legs,
                                                double tolerance, ToleranceKind kind,
                                                const KinematicLimits& limits) {
  // The longer leg first, so that a corner and the same corner reversed have one search.
  if (legs.before[2] < legs.after[2]) {
    auto other = ozcan_optimum(reversed(frame), {legs.after, legs.before}, tolerance, kind, limits);
    if (const auto* blend = std::get_if<OzcanBlend>(&other)) return turned_back(*blend);
    return other;
  }
  const Problem problem = checked_problem(frame, legs, tolerance, kind, limits);
  auto usual = usual_of(problem);
  const auto* start = std::get_if<OzcanBlend>(&usual);
  if (start == nullptr) return usual;
  return searched(problem, *start, legs.before == legs.after);
}

std::variant<OzcanBlend, NoBlend> ozcan_corner(const Corner& corner, double tolerance,
                                               ToleranceKind kind, const KinematicLimits& limits,
                                               double share_before, double share_after) {
  const auto framed = frame_of(corner);
  if (const auto* reason = std::get_if<NoBlend>(&framed)) return *reason;
  const auto& frame = std::get<CornerFrame>(framed);
  const OzcanLegs legs = ozcan_legs(frame, tolerance, kind, share_before, share_after);
  if (!(std::min(legs.before[2], legs.after[2]) > kSamePlace)) return NoBlend::kNoRoom;
  return ozcan_optimum(frame, legs, tolerance, kind, limits);
}

namespace {

// Corners whose reach (mm) and leg directions agree in these steps are alike. The curve that
// one of them gets is measured for each other one before it is taken.
constexpr double kAlike = 1e-6;

// Measured deviations of one blend at two places differ by rounding.
constexpr double kMeasuringNoise = 1e-9;

using Key = std::array<long long, 7>;

Key key_of(const CornerFrame& frame, double reach) {
  const auto steps = [](double x) { return std::llround(x / kAlike); };
  return {steps(reach),       steps(frame.a.x()), steps(frame.a.y()), steps(frame.a.z()),
          steps(frame.b.x()), steps(frame.b.y()), steps(frame.b.z())};
}

class PathBlender {
 public:
  explicit PathBlender(const OzcanOptions& options) : options_(options) {}

  std::variant<OzcanBlend, NoBlend> blend(const SharedCorner& shared) {
    const auto framed = frame_of(shared.corner);
    if (const auto* reason = std::get_if<NoBlend>(&framed)) return *reason;
    const auto& frame = std::get<CornerFrame>(framed);
    const double share = std::min(shared.share_before, shared.share_after);
    const ToleranceKind kind = kind_at(shared.corner, options_.kind, options_.strict_sharper_than);
    OzcanLegs legs = ozcan_legs(frame, options_.tolerance, kind, share, share);
    // Mirrored, whatever the legs lack: the search then has two variables instead of four.
    if (legs.before[0] < legs.after[0]) legs.after = legs.before;
    if (legs.after[0] < legs.before[0]) legs.before = legs.after;
    if (!(legs.before[2] > kSamePlace)) return NoBlend::kNoRoom;
    if (!turns_more(shared.corner, options_.least_searched_turn)) {
      return usual(frame, legs, kind);
    }
    return searched(frame, legs, kind);
  }

  [[nodiscard]] int searched_corners() const { return searched_; }

 private:
  // With mirrored legs both deviations are that of the middle, (P3 + 23 P4) cos / 24 from the
  // vertex, so P4 follows from the tolerance.
  [[nodiscard]] std::variant<OzcanBlend, NoBlend> usual(const CornerFrame& frame,
                                                        const OzcanLegs& legs,
                                                        ToleranceKind kind) const {
    const bool band = kind == ToleranceKind::kBand;
    const double allowed = options_.tolerance / (band ? frame.sin_half : 1);
    const double third = legs.before[2];
    const double along = std::min(third, (24 * allowed / frame.cos_half - third) / 23);
    if (along < 0) return NoBlend::kNoRoom;
    return blend_with(frame, legs, {along, 0}, {along, 0});
  }

  [[nodiscard]] OzcanBlend blend_with(const CornerFrame& frame, const OzcanLegs& legs,
                                      const BesideLeg& fourth, const BesideLeg& fifth) const {
    BsplineCurve curve = ozcan_curve(frame, legs, fourth, fifth);
    const BlendDeviation deviation = measure_blend(curve, frame);
    const double feed = feed_estimate(curve, options_.limits);
    return {{std::move(curve), deviation}, fourth, fifth, feed, 1};
  }

  std::variant<OzcanBlend, NoBlend> searched(const CornerFrame& frame, const OzcanLegs& legs,
                                             ToleranceKind kind) {
    const Key key = key_of(frame, legs.before[0]);
    const auto known = alike_.find(key);
    if (known != alike_.end()) {
      OzcanBlend again = blend_with(frame, legs, known->second.first, known->second.second);
      const double off = deviation_of(again.blend.deviation, kind);
      if (off <= options_.tolerance * (1 + kMeasuringNoise)) return again;
    }
    ++searched_;
    auto found = ozcan_optimum(frame, legs, options_.tolerance, kind, options_.limits);
    if (const auto* blend = std::get_if<OzcanBlend>(&found)) {
      alike_[key] = {blend->fourth, blend->fifth};
    }
    return found;
  }

  const OzcanOptions& options_;
  std::map<Key, std::pair<BesideLeg, BesideLeg>> alike_;
  int searched_ = 0;
};

}  // namespace

OzcanPath ozcan_path(std::span<const Point3> points, const OzcanOptions& options) {
  require_positive_tolerance(options.tolerance, "ozcan_path");
  PathBlender blender(options);
  OzcanPath path =
      path_with_blends<OzcanBlend>(points, options.keep_corner_angle,
                                   [&](const SharedCorner& each) { return blender.blend(each); });
  path.searched = blender.searched_corners();
  return path;
}

}  // namespace batten::geometry
