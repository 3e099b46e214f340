#include "postproc/machine/planner/feed_estimate_parts.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

// Speeds this many times the feed are of no interest: bends that allow more do not matter.
constexpr double kEstimateAboveFeed = 2;

// On a line the feed alone is no reason for nodes, only how near a slow place is.
constexpr double kAboveFeedOnLines = 20;

// A part over which the shares of the limits change by more than this is cut further.
constexpr double kGreatestBend = 0.35;

// A part is cut in two at most so many times: a bend of a 250th of a piece is seen. Of a piece that
// does not run evenly quarters are looked at in any case.
constexpr int kMostCuts = 8;
constexpr int kUnevenCuts = 2;

// Of an arc: which axis is the slowest changes with its direction.
constexpr double kArcPart = 0.4;  // radians

// What a place asks for.
struct PlaceNeeds {
  double speed;  // mm/s, if the bend were held; no more than kEstimateAboveFeed times the feed
  Vector3 acceleration_share;  // of the limit, at 1 mm/s
  Vector3 jerk_share;
};

PlaceNeeds needs_of(const LengthDerivatives& x, const KinematicPathLimits& limits) {
  PlaceNeeds needs;
  needs.acceleration_share =
      x.second.cwiseQuotient(limits.acceleration.cwiseMin(limits.normal_acceleration));
  needs.jerk_share = x.third.cwiseQuotient(limits.jerk);
  const double curvature = x.second.norm();
  const double squared = std::max(needs.acceleration_share.cwiseAbs().maxCoeff(),
                                  curvature / limits.normal_acceleration);
  const double cubed = needs.jerk_share.cwiseAbs().maxCoeff();
  double v = kEstimateAboveFeed * limits_along(x.first, limits).speed;
  if (squared * v * v > 1) v = 1 / std::sqrt(squared);
  if (cubed * v * v * v > 1) v = 1 / std::cbrt(cubed);
  needs.speed = v;
  return needs;
}

double bend_between(const PlaceNeeds& a, const PlaceNeeds& b) {
  const double v = std::min(a.speed, b.speed);
  const double by_squared =
      (b.acceleration_share - a.acceleration_share).cwiseAbs().maxCoeff() * v * v;
  const double by_cubed = (b.jerk_share - a.jerk_share).cwiseAbs().maxCoeff() * v * v * v;
  return std::max(by_squared, by_cubed);
}

// From rest the acceleration grows with the speed until feed or acceleration limit are near.
double first_top(const Vector3& direction, const Potential& potential,
                 const KinematicPathLimits& limits) {
  const LimitsAlong along = limits_along(direction, limits);
  const bool jerk = !std::isinf(along.jerk);
  const double full = jerk ? along.acceleration * along.acceleration / along.jerk : along.speed;
  return potential.of_speed(std::min(along.speed, full));
}

void append_line(const PathPiece& piece, std::size_t number, const Vector3& direction,
                 const Potential& potential, const KinematicPathLimits& limits,
                 std::vector<EstimatePart>& parts) {
  EstimatePart part;
  part.piece = number;
  part.length = geometry::length_of(piece);
  part.cap = potential.of_speed(kAboveFeedOnLines * limits_along(direction, limits).speed);
  part.slope = potential.slope(direction, limits);
  part.top = first_top(direction, potential, limits);
  parts.push_back(part);
}

// A cubic whose control points are about as far from each other as that runs evenly: it has no
// sharp bend between the places that are looked at.
constexpr double kEvenLegs = 0.5;

bool runs_evenly(const geometry::CubicBezier& bezier) {
  double least = KinematicPathLimits::kNone;
  double most = 0;
  for (int i = 0; i < 3; ++i) {
    const double leg = (bezier.control[i + 1] - bezier.control[i]).norm();
    least = std::min(least, leg);
    most = std::max(most, leg);
  }
  return least > kEvenLegs * most;
}

// Cuts a cubic in two until its parts bend little.
class CubicCutter {
 public:
  CubicCutter(const PathPiece& piece, std::size_t number, const PieceEnds& ends,
              const Potential& potential, const KinematicPathLimits& limits,
              std::vector<EstimatePart>& parts)
      : piece_(piece), potential_(potential), limits_(limits), parts_(parts) {
    part_.piece = number;
    part_.straight = false;
    part_.slope = potential.slope(ends.start.first, limits);
    part_.top = first_top(ends.start.first, potential, limits);
  }

  // `forced` times in any case, `most` at the most.
  void cut(double t0, const PlaceNeeds& from, double t1, const PlaceNeeds& to, int forced,
           int most) {
    const double t = 0.5 * (t0 + t1);
    const PlaceNeeds middle = needs_of(derivatives_by_length(piece_, t), limits_);
    const double bend = bend_between(from, middle) + bend_between(middle, to);
    if (forced > 0 || (most > 0 && bend > kGreatestBend)) {
      cut(t0, from, t, middle, forced - 1, most - 1);
      cut(t, middle, t1, to, forced - 1, most - 1);
      return;
    }
    part_.t0 = t0;
    part_.t1 = t1;
    part_.length = length_between(piece_, t0, t1);
    part_.cap = potential_.of_speed(std::max(middle.speed, std::min(from.speed, to.speed)));
    part_.bend = bend;
    parts_.push_back(part_);
  }

 private:
  const PathPiece& piece_;
  const Potential& potential_;
  const KinematicPathLimits& limits_;
  std::vector<EstimatePart>& parts_;
  EstimatePart part_;
};

// A long arc has more than its parts of a cubic; its needs are found one part after the other.
void append_arc(const PathPiece& piece, std::size_t number, double sweep,
                const Potential& potential, const KinematicPathLimits& limits,
                std::vector<EstimatePart>& parts) {
  const int count = std::max(1, static_cast<int>(std::ceil(std::abs(sweep) / kArcPart)));
  for (int i = 0; i < count; ++i) {
    EstimatePart part;
    part.piece = number;
    part.t0 = static_cast<double>(i) / count;
    part.t1 = static_cast<double>(i + 1) / count;
    part.length = length_between(piece, part.t0, part.t1);
    const LengthDerivatives middle = derivatives_by_length(piece, 0.5 * (part.t0 + part.t1));
    part.cap = potential.of_speed(needs_of(middle, limits).speed);
    part.slope = potential.slope(middle.first, limits);
    part.top = first_top(middle.first, potential, limits);
    part.straight = false;
    parts.push_back(part);
  }
}

}  // namespace

PieceEnds ends_of(const PathPiece& piece) {
  const LengthDerivatives start = derivatives_by_length(piece, 0);
  if (std::holds_alternative<geometry::Line>(piece)) return {start, start};
  return {start, derivatives_by_length(piece, 1)};
}

void append_parts(const PathPiece& piece, std::size_t number, const PieceEnds& ends,
                  const Potential& potential, const KinematicPathLimits& limits,
                  std::vector<EstimatePart>& parts) {
  if (std::holds_alternative<geometry::Line>(piece)) {
    return append_line(piece, number, ends.start.first, potential, limits, parts);
  }
  if (const auto* arc = std::get_if<geometry::Arc>(&piece)) {
    return append_arc(piece, number, arc->sweep, potential, limits, parts);
  }
  const bool even = runs_evenly(std::get<geometry::CubicBezier>(piece));
  CubicCutter(piece, number, ends, potential, limits, parts)
      .cut(0, needs_of(ends.start, limits), 1, needs_of(ends.end, limits), even ? 0 : kUnevenCuts,
           kMostCuts);
}

void PartChain::find_potentials(double start_speed, double end_speed, const Potential& potential) {
  const std::size_t n = parts.size();
  w.assign(n + 1, 0);
  w[0] = std::min(potential.of_speed(start_speed), parts.front().cap);
  for (std::size_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;
    const double bound = potential.of_speed(last ? end_speed : parts[i].end_bound);
    const double rising = w[i] + parts[i].slope * parts[i].length;
    w[i + 1] = std::min({parts[i].cap, bound, rising});
    if (!last) w[i + 1] = std::min(w[i + 1], parts[i + 1].cap);
  }
  for (std::size_t i = n; i-- > 0;) {
    w[i] = std::min(w[i], w[i + 1] + parts[i].slope * parts[i].length);
  }
}

std::vector<std::size_t> PartChain::slow_joints(double times, const Potential& potential) const {
  const double much = potential.of_speed(times);
  std::vector<std::size_t> joints;
  double highest = 0;         // since the last joint whose bound the envelope meets
  std::size_t candidate = 0;  // that joint, if what is before it is fast enough
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const EstimatePart& part = parts[i];
    const double top = std::min(part.cap, 0.5 * (w[i] + w[i + 1] + part.slope * part.length));
    highest = std::max(highest, top);
    if (candidate > 0 && highest >= much * w[candidate]) {
      joints.push_back(candidate);
      candidate = 0;
    }
    // Of rounding: w came from that bound or from a slope.
    if (!(w[i + 1] >= potential.of_speed(part.end_bound) * (1 - 1e-9))) continue;
    candidate = highest >= much * w[i + 1] ? i + 1 : 0;
    highest = 0;
  }
  return joints;
}

}  // namespace batten::postproc
