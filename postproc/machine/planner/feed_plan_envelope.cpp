#include "postproc/machine/planner/feed_plan_envelope.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

constexpr double kAboveFeed = 2.5;

// A joint whose speed the machine reaches from rest within this way is a stop: the way is a
// thousandth of the last printed decimal.
constexpr double kStopWay = 1e-6;  // mm

// Stands for "no limit at all in this direction"; w itself is 1e6 at 1e4 mm/s.
constexpr double kSteep = 1e9;

// The greatest speed that a bend allows if it were held.
double steady_speed(const LengthDerivatives& x, const KinematicPathLimits& limits) {
  double squared = KinematicPathLimits::kNone;
  double cubed = KinematicPathLimits::kNone;
  for (int axis = 0; axis < 3; ++axis) {
    const double second = std::abs(x.second[axis]);
    const double third = std::abs(x.third[axis]);
    if (second > 0) squared = std::min(squared, limits.acceleration[axis] / second);
    if (third > 0) cubed = std::min(cubed, limits.jerk[axis] / third);
  }
  const double curvature = x.second.norm();
  if (curvature > 0) squared = std::min(squared, limits.normal_acceleration / curvature);
  return std::min(std::sqrt(squared), std::cbrt(cubed));
}

// The greatest part of its limit that an axis changes by.
double change_of_share(const Vector3& from, const Vector3& to, const Vector3& limit) {
  return (to - from).cwiseAbs().cwiseQuotient(limit).maxCoeff();
}

int steps_of(const PathPiece& piece) {
  if (std::holds_alternative<geometry::Line>(piece)) return 1;
  if (const auto* arc = std::get_if<geometry::Arc>(&piece)) {
    // Which axis is the slowest changes with the direction: some eight steps per quarter turn.
    return std::max(2, static_cast<int>(std::ceil(std::abs(arc->sweep) / 0.2)));
  }
  return 8;  // third derivatives by length of a cubic have a few peaks
}

void append_piece(const PathPiece& piece, std::size_t number, const Potential& potential,
                  const KinematicPathLimits& limits, Envelope& envelope) {
  const int count = steps_of(piece);
  LengthDerivatives last = derivatives_by_length(piece, 0);
  double before = 0;
  for (int i = 0; i <= count; ++i) {
    const double t = static_cast<double>(i) / count;
    const LengthDerivatives x = derivatives_by_length(piece, t);
    const double fastest = kAboveFeed * limits_along(x.first, limits).speed;
    const double w = potential.of_speed(std::min(fastest, steady_speed(x, limits)));
    if (i == 0) {
      envelope.w.back() = std::min(envelope.w.back(), w);
    } else {
      EnvelopeStep step;
      step.piece = number;
      step.t0 = static_cast<double>(i - 1) / count;
      step.t1 = t;
      step.length = length_between(piece, step.t0, t);
      step.cap = std::max(before, w);
      step.slope = potential.slope(x.first, limits);
      step.by_squared_speed =
          std::max(change_of_share(last.second, x.second, limits.acceleration),
                   (x.second - last.second).norm() / limits.normal_acceleration);
      step.by_cubed_speed = change_of_share(last.third, x.third, limits.jerk);
      envelope.steps.push_back(step);
      envelope.w.push_back(w);
      envelope.bound.push_back(KinematicPathLimits::kNone);
    }
    before = w;
    last = x;
  }
}

void lower_to_slopes(Envelope& envelope) {
  const auto& steps = envelope.steps;
  auto& w = envelope.w;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    w[i + 1] = std::min(w[i + 1], w[i] + steps[i].slope * steps[i].length);
  }
  for (std::size_t i = steps.size(); i-- > 0;) {
    w[i] = std::min(w[i], w[i + 1] + steps[i].slope * steps[i].length);
  }
}

}  // namespace

Potential::Potential(const KinematicPathLimits& limits)
    : jerk_limited_(!std::isinf(std::min(limits.jerk.minCoeff(), limits.tangential_jerk))) {}

double Potential::of_speed(double v) const { return jerk_limited_ ? v * std::sqrt(v) : v * v; }

double Potential::speed(double w) const { return jerk_limited_ ? std::cbrt(w * w) : std::sqrt(w); }

double Potential::slope(const Vector3& direction, const KinematicPathLimits& limits) const {
  const LimitsAlong along = limits_along(direction, limits);
  return std::min(kSteep, jerk_limited_ ? std::sqrt(4.5 * along.jerk) : 2 * along.acceleration);
}

double Potential::rate() const { return jerk_limited_ ? 1 / std::sqrt(4.5) : 0.5; }

double passing_speed(const LengthDerivatives& before, const LengthDerivatives& after,
                     const Potential& potential, const KinematicPathLimits& limits) {
  const double speed = joint_speed(before, after, limits);
  if (std::isinf(speed)) return speed;
  // Rounding of control points looks like a jump, but a tiny one.
  if (speed >= limits_along(before.first, limits).speed) return KinematicPathLimits::kNone;
  const double slowest = potential.speed(potential.slope(before.first, limits) * kStopWay);
  return speed < slowest ? 0 : speed;
}

double EnvelopeStep::peak(double w0, double w1) const {
  return std::max({w0, w1, std::min(cap, 0.5 * (w0 + w1 + slope * length))});
}

Envelope speed_envelope(std::span<const PathPiece> pieces, std::span<const double> bounds,
                        const KinematicPathLimits& limits) {
  const Potential potential(limits);
  Envelope envelope;
  envelope.w.push_back(KinematicPathLimits::kNone);
  envelope.bound.push_back(bounds.front());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    append_piece(pieces[i], i, potential, limits, envelope);
    envelope.bound.back() = bounds[i + 1];
  }
  for (std::size_t i = 0; i < envelope.w.size(); ++i) {
    envelope.w[i] = std::min(envelope.w[i], potential.of_speed(envelope.bound[i]));
  }
  lower_to_slopes(envelope);
  return envelope;
}

}  // namespace batten::postproc
