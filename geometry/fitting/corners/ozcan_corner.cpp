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

void require_decreasing(const OzcanLeg& leg) {
  if (leg[0] > leg[1] && leg[1] > leg[2] && leg[2] > 0) return;
  throw std::invalid_argument("ozcan_corner: points " + std::to_string(leg[0]) + ", " +
                              std::to_string(leg[1]) + ", " + std::to_string(leg[2]) +
                              " mm from the vertex, expected decreasing positive numbers");
}

// One corner with its legs and limits: what each place of P4 is worth.
struct Problem {
  CornerFrame frame;
  OzcanLeg leg;
  double tolerance;
  ToleranceKind kind;
  KinematicLimits limits;

  [[nodiscard]] double deviation(const BesideLeg& fourth) const {
    return measure_deviation(ozcan_curve(frame, leg, fourth), frame, kind);
  }

  [[nodiscard]] OzcanBlend blend(const BesideLeg& fourth) const {
    BsplineCurve curve = ozcan_curve(frame, leg, fourth);
    const BlendDeviation found = measure_blend(curve, frame);
    const double feed = feed_estimate(curve, limits);
    return {{std::move(curve), found}, fourth, feed};
  }

  // P4 between P3 and the vertex, on the leg or outside, so that the feet on the legs go forward.
  [[nodiscard]] bool goes_forward(const BesideLeg& fourth) const {
    return fourth.along >= 0 && fourth.along <= leg[2] &&
           fourth.outward * frame.cos_half >= -fourth.along * frame.sin_half;
  }

  // The search runs over how deep P4 and P5 pull the middle of the curve inside, along the
  // bisector, C(2.5) = (P3 + 23 P4 + 23 P5 + P6) / 48, and over their distance from the legs, since
  // the tolerance limits the one and the other.
  [[nodiscard]] std::vector<double> variables(const BesideLeg& fourth) const {
    const double c = frame.cos_half;
    const double s = frame.sin_half;
    return {(c * leg[2] + 23 * (c * fourth.along - s * fourth.outward)) / 24, fourth.outward};
  }

  [[nodiscard]] BesideLeg place(const std::vector<double>& v) const {
    const double c = frame.cos_half;
    const double s = frame.sin_half;
    return {((24 * v[0] - c * leg[2]) / 23 + s * v[1]) / c, v[1]};
  }

  // A tolerance in either variable, less where the leg is short for that.
  [[nodiscard]] std::vector<double> steps() const {
    return {std::min(tolerance, frame.cos_half * leg[2] / 2), std::min(tolerance, leg[2] / 2)};
  }

  // The paper's objective (11): the deviation, weighed so that it outdoes all else, where the
  // tolerance is broken; else the inverse of the feed.
  [[nodiscard]] double cost(const std::vector<double>& v) const {
    constexpr double kBroken = 1e6;  // s/mm^2; no feed is as slow as 1e-6 mm/s over 1 mm
    const BesideLeg fourth = place(v);
    if (!goes_forward(fourth)) return std::numeric_limits<double>::infinity();
    const BsplineCurve curve = ozcan_curve(frame, leg, fourth);
    const double off = measure_deviation(curve, frame, kind);
    if (off > tolerance) return kBroken * (1 + off);
    return 1 / feed_estimate(curve, limits);
  }
};

// The greatest t in [0, 1] for which P4 and P5 at t of P3 and P6 hold the tolerance; negative
// where none does.
double usual_part(const Problem& problem) {
  const auto holds = [&](double t) {
    return problem.deviation({t * problem.leg[2], 0}) <= problem.tolerance;
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
  return problem.blend({t * problem.leg[2], 0});
}

Problem checked_problem(const CornerFrame& frame, const OzcanLeg& leg, double tolerance,
                        ToleranceKind kind, const KinematicLimits& limits) {
  require_positive_tolerance(tolerance, "ozcan_corner");
  require_decreasing(leg);
  return {frame, leg, tolerance, kind, limits};
}

constexpr int kEvaluations = 600;

// Of the first step, about a tolerance: a ten-thousandth of it changes no feed by a thousandth.
constexpr double kFinest = 1e-4;

OzcanBlend searched(const Problem& problem, const OzcanBlend& from) {
  PatternSearchOptions options;
  options.steps = problem.steps();
  options.finest = kFinest;
  options.max_evaluations = kEvaluations;
  const auto found = pattern_search([&](const auto& v) { return problem.cost(v); },
                                    problem.variables(from.fourth), options);
  OzcanBlend best = problem.blend(problem.place(found.at));
  // The way from places to depths and back may lose the last digit of the start.
  const bool holds = deviation_of(best.blend.deviation, problem.kind) <= problem.tolerance;
  return holds && best.feed_estimate >= from.feed_estimate ? best : from;
}

}  // namespace

OzcanLeg ozcan_leg(const CornerFrame& frame, double tolerance, ToleranceKind kind, double share) {
  require_positive_tolerance(tolerance, "ozcan_leg");
  // With P4 and P5 in the vertex and P3, P6 at d, the middle is d cos / 24 from the vertex, and
  // sin times that from the legs.
  // Of the tolerance. Where that curve uses more, the corner is cramped; where it uses less, the
  // curve has less length to turn on: docs/algorithms/ozcan.md has the table.
  constexpr double kSharpest = 0.35;
  const double sine = kind == ToleranceKind::kBand ? frame.sin_half : 1;
  const double third = 24 * kSharpest * tolerance / (frame.cos_half * sine);
  const double reach = std::min({share, frame.length_a, frame.length_b, 2 * third});
  return {reach, 0.75 * reach, 0.5 * reach};
}

BsplineCurve ozcan_curve(const CornerFrame& frame, const OzcanLeg& leg, const BesideLeg& fourth) {
  const Point3& q = frame.vertex;
  std::vector<Point3> points = {
      q + leg[0] * frame.a,
      q + leg[1] * frame.a,
      q + leg[2] * frame.a,
      q + fourth.along * frame.a + fourth.outward * frame.outward_a(),
      q + fourth.along * frame.b + fourth.outward * frame.outward_b(),
      q + leg[2] * frame.b,
      q + leg[1] * frame.b,
      q + leg[0] * frame.b,
  };
  return {BsplineBasis::clamped(3, {0, 1, 2, 3, 4, 5}), std::move(points)};
}

std::variant<OzcanBlend, NoBlend> ozcan_usual(const CornerFrame& frame, const OzcanLeg& leg,
                                              double tolerance, ToleranceKind kind,
                                              const KinematicLimits& limits) {
  return usual_of(checked_problem(frame, leg, tolerance, kind, limits));
}

std::variant<OzcanBlend, NoBlend> ozcan_optimum(const CornerFrame& frame, const OzcanLeg& leg,
                                                double tolerance, ToleranceKind kind,
                                                const KinematicLimits& limits) {
  const Problem problem = checked_problem(frame, leg, tolerance, kind, limits);
  auto usual = usual_of(problem);
  const auto* start = std::get_if<OzcanBlend>(&usual);
  if (start == nullptr) return usual;
  return searched(problem, *start);
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
    const OzcanLeg leg = ozcan_leg(frame, options_.tolerance, kind, share);
    if (!(leg[2] > kSamePlace)) return NoBlend::kNoRoom;
    if (!turns_more(shared.corner, options_.least_searched_turn)) return usual(frame, leg, kind);
    return searched(frame, leg, kind);
  }

  [[nodiscard]] int searched_corners() const { return searched_; }

 private:
  // Both deviations are that of the middle, (P3 + 23 P4) cos / 24 from the vertex, so P4 follows
  // from the tolerance.
  [[nodiscard]] std::variant<OzcanBlend, NoBlend> usual(const CornerFrame& frame,
                                                        const OzcanLeg& leg,
                                                        ToleranceKind kind) const {
    const bool band = kind == ToleranceKind::kBand;
    const double allowed = options_.tolerance / (band ? frame.sin_half : 1);
    const double third = leg[2];
    const double along = std::min(third, (24 * allowed / frame.cos_half - third) / 23);
    if (along < 0) return NoBlend::kNoRoom;
    return Problem{frame, leg, options_.tolerance, kind, options_.limits}.blend({along, 0});
  }

  std::variant<OzcanBlend, NoBlend> searched(const CornerFrame& frame, const OzcanLeg& leg,
                                             ToleranceKind kind) {
    const Problem problem{frame, leg, options_.tolerance, kind, options_.limits};
    const Key key = key_of(frame, leg[0]);
    const auto known = alike_.find(key);
    if (known != alike_.end()) {
      OzcanBlend again = problem.blend(known->second);
      const double off = deviation_of(again.blend.deviation, kind);
      if (off <= options_.tolerance * (1 + kMeasuringNoise)) return again;
    }
    ++searched_;
    auto found = ozcan_optimum(frame, leg, options_.tolerance, kind, options_.limits);
    if (const auto* blend = std::get_if<OzcanBlend>(&found)) alike_[key] = blend->fourth;
    return found;
  }

  const OzcanOptions& options_;
  std::map<Key, BesideLeg> alike_;
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
