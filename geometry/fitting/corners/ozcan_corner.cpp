#include "geometry/fitting/corners/ozcan_corner.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "geometry/basic/operations.h"
#include "geometry/basic/rounding.h"
#include "geometry/numeric/extrema.h"

namespace batten::geometry {
namespace {

// What each place of P4 is worth.
struct Problem : OzcanProblem {
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

  // The paper's objective (11), the inverse of the feed; where the tolerance is broken, a weight
  // that outdoes all else.
  [[nodiscard]] double cost(const std::vector<double>& v) const {
    const BesideLeg fourth = place(v);
    if (!goes_forward(fourth)) return std::numeric_limits<double>::infinity();
    count_operations(200);
    const BsplineCurve curve = ozcan_curve(frame, leg, fourth);
    if (measure_deviation(curve, frame, kind) > tolerance) {
      return std::numeric_limits<double>::infinity();
    }
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
  for (int i = 0; i < kOzcanTuning.halvings; ++i) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

OzcanBlend searched(const Problem& problem, const OzcanBlend& from) {
  PatternSearchOptions options;
  options.steps = problem.steps();
  options.finest = kOzcanTuning.finest;
  options.max_evaluations = kOzcanTuning.evaluations;
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
  const double sine = kind == ToleranceKind::kBand ? frame.sin_half : 1;
  const double third = 24 * kOzcanTuning.sharpest * tolerance / (frame.cos_half * sine);
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

std::variant<OzcanBlend, NoBlend> ozcan_usual(const OzcanProblem& problem) {
  require_positive_tolerance(problem.tolerance, "ozcan_corner");
  assert(problem.leg[0] > problem.leg[1] && problem.leg[1] > problem.leg[2] && problem.leg[2] > 0);
  const double t = usual_part({problem});
  if (t < 0) return NoBlend::kNoRoom;
  return Problem{problem}.blend({t * problem.leg[2], 0});
}

std::variant<OzcanBlend, NoBlend> ozcan_optimum(const OzcanProblem& problem) {
  auto usual = ozcan_usual(problem);
  const auto* start = std::get_if<OzcanBlend>(&usual);
  return start != nullptr ? searched({problem}, *start) : usual;
}

namespace {

// Both deviations are that of the middle, (P3 + 23 P4) cos / 24 from the vertex, so P4 follows
// from the tolerance.
std::variant<OzcanBlend, NoBlend> usual_in_closed_form(const Problem& problem) {
  const CornerFrame& frame = problem.frame;
  const bool band = problem.kind == ToleranceKind::kBand;
  const double allowed = problem.tolerance / (band ? frame.sin_half : 1);
  const double third = problem.leg[2];
  const double along = std::min(third, (24 * allowed / frame.cos_half - third) / 23);
  if (along < 0) return NoBlend::kNoRoom;
  return problem.blend({along, 0});
}

}  // namespace

OzcanPath ozcan_path(std::span<const Point3> points, const OzcanOptions& options) {
  require_positive_tolerance(options.tolerance, "ozcan_path");
  std::map<std::pair<long long, AlikeLegs>, BesideLeg> found;  // by reach and legs
  int searches = 0;
  const auto blend_of = [&](const SharedCorner& shared,
                            const CornerFrame& frame) -> std::variant<OzcanBlend, NoBlend> {
    const double share = std::min(shared.share_before, shared.share_after);
    const OzcanLeg leg = ozcan_leg(frame, options.tolerance, shared.kind, share);
    if (!(leg[2] > kSamePlace)) return NoBlend::kNoRoom;
    const Problem problem{{frame, leg, options.tolerance, shared.kind, options.limits}};
    if (!turns_more(shared.corner, options.least_searched_turn)) {
      return usual_in_closed_form(problem);
    }
    const std::pair key{std::llround(leg[0] / kCornerTuning.alike), alike_legs(frame)};
    if (const auto known = found.find(key); known != found.end()) {
      OzcanBlend again = problem.blend(known->second);
      const double off = deviation_of(again.blend.deviation, shared.kind);
      if (off <= options.tolerance * (1 + kCornerTuning.measuring_noise)) return again;
    }
    ++searches;
    auto outcome = ozcan_optimum(problem);
    if (const auto* blend = std::get_if<OzcanBlend>(&outcome)) found[key] = blend->fourth;
    return outcome;
  };
  OzcanPath path = path_with_blends<OzcanBlend>(points, options, blend_of);
  path.searched = searches;
  return path;
}

}  // namespace batten::geometry
