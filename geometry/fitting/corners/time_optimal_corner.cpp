#include "geometry/fitting/corners/time_optimal_corner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/band_curve.h"
#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/fitting/corners/guo_corner.h"

namespace batten::geometry {

namespace {

// Spans grow by this factor from the apex outwards: all that is quick happens near it.
constexpr double kGrowth = 1.05;

// Places per span where the band is watched.
constexpr int kWatchedBetween = 4;

// The speed may be above the feed by this part: the planner that runs the curve caps it, which
// costs no more than that, and the ends, which have the feed itself, are strictly inside.
constexpr double kOverspeed = 2e-4;

// The time is found to this part of what the corner costs.
constexpr double kTimeError = 2e-4;
constexpr int kTimeTries = 16;

// Rounds of solving again further inside, since the band is held at samples only.
constexpr int kBandRounds = 4;
constexpr double kFurtherInside = 1e-4;

// mm over which the speed changes between 0 and v along a leg without acceleration at both ends:
// constant jerk up and down, 2 sqrt(v/j) long, at v/2 in the mean.
double stopping_way(double v, double j) { return v * std::sqrt(v / j); }

// mm/s from which the machine can stop on that way.
double stopping_speed(double way, double j) { return std::cbrt(way * way * j); }

// The racing line through one corner: how fast a machine can take it on a given room.
class TimeOptimalLine {
 public:
  // Both must outlive it.
  TimeOptimalLine(const CornerFrame& frame, const TimeOptimalOptions& options);

  [[nodiscard]] bool has_room() const;

  // The fastest curve on `room` times the room that the machine needs to change its speed and to
  // swing from side to side, or on the shares of the legs, whichever is less.
  [[nodiscard]] std::optional<TimeOptimalBlend> fastest(double room) const;

 private:
  struct Leg {
    Vector3 away;   // unit, from the vertex
    double share;   // mm
    double needed;  // mm
    double jerk;    // mm/s^3 that the axes give along the leg
    double speed;   // mm/s that feed and axes give along the leg
  };
  // A curve whose time is given, and what the machine lacks for it.
  struct Timed {
    std::vector<Point3> points;
    double time = 0;
    double load = 0;
    bool inside = false;
  };
  struct Joint {
    Leg leg;
    double room;   // mm from the vertex
    double speed;  // mm/s along the leg
  };

  [[nodiscard]] Leg leg_of(const Vector3& away, double share) const;
  [[nodiscard]] Joint joint_of(const Leg& leg, double room) const;
  [[nodiscard]] std::vector<double> breakpoints(const Joint& in, const Joint& out,
                                                double lost) const;
  [[nodiscard]] BandProblem problem(const Joint& in, const Joint& out, double lost,
                                    double tolerance) const;
  void add_band(BandProblem& made, const std::vector<double>& breaks, double tolerance) const;
  void add_limits(BandProblem& made) const;
  [[nodiscard]] Timed solved(const Joint& in, const Joint& out, double lost, double tolerance,
                             const std::vector<Point3>& start) const;
  [[nodiscard]] std::optional<Timed> quickest(const Joint& in, const Joint& out,
                                              double tolerance) const;

  const CornerFrame& frame_;
  const TimeOptimalOptions& options_;
  Leg before_;
  Leg after_;
};

TimeOptimalLine::TimeOptimalLine(const CornerFrame& frame, const TimeOptimalOptions& options)
    : frame_(frame),
      options_(options),
      before_(leg_of(frame.a, std::min(options.share_before, frame.length_a))),
      after_(leg_of(frame.b, std::min(options.share_after, frame.length_b))) {}

TimeOptimalLine::Leg TimeOptimalLine::leg_of(const Vector3& away, double share) const {
  const KinematicLimits& limits = options_.limits;
  Leg leg{away, share, 0, std::numeric_limits<double>::infinity(), limits.feed};
  double across = leg.jerk;  // mm/s^3 that the slowest axis gives
  double pull = leg.jerk;    // mm/s^2, the same
  for (int i = 0; i < 3; ++i) {
    const double part = std::abs(away[i]);
    if (part < kSameDirection) continue;
    leg.jerk = std::min(leg.jerk, limits.jerk[i] / part);
    leg.speed = std::min(leg.speed, limits.speed[i] / part);
    across = std::min(across, limits.jerk[i]);
    pull = std::min(pull, limits.acceleration[i]);
  }
  // Without a limit on the jerk an acceleration is reached at once; the way is then that of the
  // acceleration, v^2/2a, which a jerk of a^2/v gives to within a factor of two.
  const double a = pull;
  leg.jerk = std::min(leg.jerk, a * a / leg.speed);
  across = std::min(across, a * a / leg.speed);
  // To the outside and back to the inside, two tolerances across the leg: 32 d = j t^3.
  const double swing = std::cbrt(64 * options_.tolerance / across);
  leg.needed =
      stopping_way(leg.speed, leg.jerk) + leg.speed * (std::sqrt(leg.speed / leg.jerk) + swing);
  return leg;
}

bool TimeOptimalLine::has_room() const {
  return std::min(before_.share, after_.share) > options_.tolerance;
}

TimeOptimalLine::Joint TimeOptimalLine::joint_of(const Leg& leg, double room) const {
  const double taken = std::min(room * leg.needed, leg.share);
  return {leg, taken, std::min(leg.speed, stopping_speed(taken, leg.jerk))};
}

std::vector<double> TimeOptimalLine::breakpoints(const Joint& in, const Joint& out,
                                                 double lost) const {
  // Widths from the apex outwards; both sides have as many spans.
  const int each = options_.spans / 2;
  std::vector<double> parts = {0};
  double width = 1;
  for (int i = 0; i < each; ++i, width *= kGrowth) parts.push_back(parts.back() + width);
  for (double& part : parts) part /= parts.back();
  const double apex = in.room / in.speed + lost / 2;
  const double after = out.room / out.speed + lost / 2;
  std::vector<double> breaks;
  for (int i = each; i > 0; --i) breaks.push_back(apex - parts[i] * apex);
  for (int i = 0; i <= each; ++i) breaks.push_back(apex + parts[i] * after);
  return breaks;
}

BandProblem TimeOptimalLine::problem(const Joint& in, const Joint& out, double lost,
                                     double tolerance) const {
  const auto breaks = breakpoints(in, out, lost);
  BandProblem made{BsplineBasis::clamped(3, breaks), 3, {}, {}, {}};
  const BsplineBasis& basis = made.basis;
  const Point3 start = frame_.vertex + in.room * in.leg.away;
  const Point3 end = frame_.vertex + out.room * out.leg.away;
  const std::size_t last = basis.size() - 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double since = basis.greville(i) - basis.first();
    const double until = basis.last() - basis.greville(last - i);
    made.held.push_back(HeldPoint::at(i, start - since * in.speed * in.leg.away));
    made.held.push_back(HeldPoint::at(last - i, end - until * out.speed * out.leg.away));
  }
  add_band(made, breaks, tolerance);
  add_limits(made);
  return made;
}

void TimeOptimalLine::add_band(BandProblem& made, const std::vector<double>& breaks,
                               double tolerance) const {
  const double apex = breaks[breaks.size() / 2];
  BandSample sample;
  sample.foot = frame_.vertex;
  sample.radius = tolerance;
  for (std::size_t span = 0; span + 1 < breaks.size(); ++span) {
    for (int i = span == 0 ? 1 : 0; i < kWatchedBetween; ++i) {
      const double part = static_cast<double>(i) / kWatchedBetween;
      sample.parameter = breaks[span] + part * (breaks[span + 1] - breaks[span]);
      sample.shape = BandShape::kCylinder;
      if (sample.parameter <= apex) {
        sample.direction = frame_.a;
        made.samples.push_back(sample);
      }
      if (sample.parameter >= apex) {
        sample.direction = frame_.b;
        made.samples.push_back(sample);
      }
      if (sample.parameter == apex && options_.kind == ToleranceKind::kPath) {
        sample.shape = BandShape::kBall;
        made.samples.push_back(sample);
      }
    }
  }
}

void TimeOptimalLine::add_limits(BandProblem& made) const {
  const KinematicLimits& limits = options_.limits;
  const auto& t = made.basis.knots();
  const auto add_axes = [&](double u, int derivative, const Vector3& limit) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(limit[axis])) continue;
      BandSample sample;
      sample.parameter = u;
      sample.derivative = derivative;
      sample.shape = BandShape::kSlab;
      sample.direction = Vector3::Unit(axis);
      sample.radius = limit[axis];
      made.samples.push_back(sample);
    }
  };
  for (std::size_t k = 3; k < made.basis.size(); ++k) {
    const double middle = 0.5 * (t[k] + t[k + 1]);
    add_axes(middle, 3, limits.jerk);  // constant in a span
    // The ends have the feed itself.
    BandSample speed;
    speed.derivative = 1;
    speed.radius = limits.feed * (1 + kOverspeed);
    for (int i = k == 3 ? 1 : 0; i < kWatchedBetween; ++i) {
      speed.parameter = t[k] + (t[k + 1] - t[k]) * i / kWatchedBetween;
      made.samples.push_back(speed);
    }
    if (k == 3) continue;
    add_axes(t[k], 2, limits.acceleration);  // linear in a span
    if (limits.speed.minCoeff() < limits.feed) {
      add_axes(t[k], 1, limits.speed * (1 + kOverspeed));
    }
  }
}

TimeOptimalLine::Timed TimeOptimalLine::solved(const Joint& in, const Joint& out, double lost,
                                               double tolerance,
                                               const std::vector<Point3>& start) const {
  const BandProblem made = problem(in, out, lost, tolerance);
  std::vector<Point3> points = start;
  if (points.empty()) {
    const double apex = in.room / in.speed + lost / 2;
    for (std::size_t i = 0; i < made.basis.size(); ++i) {
      const double u = made.basis.greville(i) - apex;
      points.push_back(frame_.vertex +
                       (u < 0 ? -u / apex * in.room * in.leg.away
                              : u / (made.basis.last() - apex) * out.room * out.leg.away));
    }
  }
  const BandCurve curve = least_ratio_in_band(made, std::move(points), 2);
  return {curve.curve.control_points(), lost, curve.worst_ratio, curve.end != BandEnd::kOutside};
}

// The load falls as the time rises; where it is 1 the machine is used up.
std::optional<TimeOptimalLine::Timed> TimeOptimalLine::quickest(const Joint& in, const Joint& out,
                                                                double tolerance) const {
  // A stop at the vertex costs half of the time of each ramp.
  const double stop = std::sqrt(in.speed / in.leg.jerk) + std::sqrt(out.speed / out.leg.jerk);
  // With a wide tolerance the way is shorter, and time is won.
  double low = -1.5 * std::min(in.room / in.speed, out.room / out.speed);
  double high = 1.2 * stop;
  Timed slow = solved(in, out, high, tolerance, {});
  if (!slow.inside) return std::nullopt;
  double low_load = std::numeric_limits<double>::infinity();
  double lost = 0.4 * stop;
  for (int i = 0; i < kTimeTries && high - low > kTimeError * stop; ++i) {
    Timed next = solved(in, out, lost, tolerance, slow.points);
    if (next.inside && next.load <= 1) {
      high = lost;
      slow = std::move(next);
    } else {
      low = lost;
      low_load = next.inside ? next.load : low_load;
    }
    // The logarithm of the load is nearly linear; a twentieth of the interval from its ends.
    double part = 0.5;
    if (std::isfinite(low_load) && low_load > 1 && slow.load < 1) {
      part = std::log(low_load) / (std::log(low_load) - std::log(slow.load));
    }
    lost = low + std::clamp(part, 0.05, 0.95) * (high - low);
  }
  return slow;
}

std::optional<TimeOptimalBlend> TimeOptimalLine::fastest(double room) const {
  const Joint in = joint_of(before_, room);
  const Joint out = joint_of(after_, room);
  double aim = options_.tolerance;
  for (int round = 0; round < kBandRounds; ++round) {
    const auto timed = quickest(in, out, aim);
    if (!timed) return std::nullopt;
    const BsplineBasis basis = BsplineBasis::clamped(3, breakpoints(in, out, timed->time));
    const BsplineCurve curve(basis, timed->points);
    const BlendDeviation deviation = measure_blend(curve, frame_);
    const double measured = deviation_of(deviation, options_.kind);
    if (measured <= options_.tolerance) {
      return TimeOptimalBlend{{curve, deviation}, in.room,   out.room,
                              in.speed,           out.speed, basis.last() - basis.first(),
                              timed->load};
    }
    aim *= options_.tolerance / measured * (1 - kFurtherInside);
  }
  return std::nullopt;
}

void check(const TimeOptimalOptions& options) {
  require_positive_tolerance(options.tolerance, "time_optimal_corner");
  if (options.spans < 8) {
    throw std::invalid_argument("time_optimal_corner: " + std::to_string(options.spans) +
                                " spans, expected 8 or more");
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isfinite(options.limits.acceleration[axis]) ||
        std::isfinite(options.limits.jerk[axis])) {
      continue;
    }
    throw std::invalid_argument("time_optimal_corner: axis " + std::to_string(axis) +
                                " with neither acceleration nor jerk limited");
  }
  if (!(options.limits.feed > 0 && std::isfinite(options.limits.feed))) {
    throw std::invalid_argument("time_optimal_corner: feed " + std::to_string(options.limits.feed) +
                                " mm/s, expected a positive number");
  }
}

}  // namespace

std::variant<TimeOptimalBlend, NoBlend> time_optimal_corner(const Corner& corner,
                                                            const TimeOptimalOptions& options) {
  check(options);
  const auto framed = frame_of(corner);
  if (const auto* none = std::get_if<NoBlend>(&framed)) return *none;
  const TimeOptimalLine line(std::get<CornerFrame>(framed), options);
  if (!line.has_room()) return NoBlend::kNoRoom;
  auto found = line.fastest(1);
  if (!found) return NoBlend::kNoRoom;
  return std::move(*found);
}

namespace {

// Leg directions that agree in these steps, and shares (mm), are alike.
constexpr double kAlikeCorners = 1e-6;

// Measured deviations of one blend at two places differ by rounding.
constexpr double kCornerNoise = 1e-9;

// A racing line that bends this many times as hard as the five points do is none: where there is
// hardly any room (teeth of noise), the search ends with one that stands still on its way.
constexpr double kSharper = 2;

// Places of a racing line at which its curvature is looked at, to each of its spans.
constexpr int kPlacesPerSpan = 8;

using Directions = std::array<long long, 6>;

Directions directions_of(const CornerFrame& frame) {
  const auto steps = [](double x) { return std::llround(x / kAlikeCorners); };
  return {steps(frame.a.x()), steps(frame.a.y()), steps(frame.a.z()),
          steps(frame.b.x()), steps(frame.b.y()), steps(frame.b.z())};
}

bool bends_more_than(const BsplineCurve& curve, double curvature) {
  const std::vector<double> breaks = curve.breakpoints();
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    for (int k = 0; k < kPlacesPerSpan; ++k) {
      const double u = breaks[i] + (k + 0.5) / kPlacesPerSpan * (breaks[i + 1] - breaks[i]);
      if (!(curve.curvature_at(u) <= curvature)) return true;
    }
  }
  return false;
}

// A blend that was found, with the vertex and the shares it was found for.
struct Known {
  TimeOptimalBlend found;
  Point3 vertex;
  double share_before;
  double share_after;

  // Whether a search with these shares would find the same: they are the same, or neither search
  // is bound by them.
  [[nodiscard]] bool serves(const SharedCorner& corner) const {
    return serves(found.before, share_before, corner.share_before) &&
           serves(found.after, share_after, corner.share_after);
  }

 private:
  [[nodiscard]] static bool serves(double used, double share, double other) {
    if (std::abs(share - other) <= kAlikeCorners) return true;
    return used < share - kAlikeCorners && used < other - kAlikeCorners;
  }
};

class TimeOptimalBlender {
 public:
  explicit TimeOptimalBlender(const TimeOptimalPathOptions& options) : options_(options) {}

  std::variant<TimeOptimalPathBlend, NoBlend> blend(const SharedCorner& shared) {
    const auto framed = frame_of(shared.corner);
    if (const auto* reason = std::get_if<NoBlend>(&framed)) return *reason;
    const auto& frame = std::get<CornerFrame>(framed);
    const ToleranceKind kind = kind_at(shared.corner, options_.kind, options_.strict_sharper_than);
    const GuoRule rule{options_.tolerance, kind, GuoApex::kAllowed};
    auto five = guo_corner(shared.corner, rule, shared.share_before, shared.share_after);
    if (turns_more(shared.corner, options_.least_raced_turn)) {
      auto raced = raced_blend(shared, frame, kind);
      const auto* other = std::get_if<GuoBlend>(&five);
      if (raced && (other == nullptr ||
                    !bends_more_than(raced->blend.curve, kSharper * other->greatest_curvature))) {
        return std::move(*raced);
      }
    }
    if (const auto* reason = std::get_if<NoBlend>(&five)) return *reason;
    return TimeOptimalPathBlend{std::move(std::get<GuoBlend>(five).blend), false};
  }

  [[nodiscard]] int searched() const { return searched_; }

 private:
  std::optional<TimeOptimalPathBlend> raced_blend(const SharedCorner& shared,
                                                  const CornerFrame& frame, ToleranceKind kind) {
    std::vector<Known>& alike = known_[directions_of(frame)];
    for (const Known& known : alike) {
      if (known.serves(shared)) {
        if (auto again = moved_there(known, frame, kind)) return again;
      }
    }
    if (searched_ >= options_.most_raced) return std::nullopt;
    ++searched_;
    TimeOptimalOptions time_optimal;
    time_optimal.tolerance = options_.tolerance;
    time_optimal.kind = kind;
    time_optimal.limits = options_.limits;
    time_optimal.share_before = shared.share_before;
    time_optimal.share_after = shared.share_after;
    auto outcome = time_optimal_corner(shared.corner, time_optimal);
    auto* found = std::get_if<TimeOptimalBlend>(&outcome);
    if (found == nullptr) return std::nullopt;
    alike.push_back({*found, frame.vertex, shared.share_before, shared.share_after});
    return TimeOptimalPathBlend{std::move(found->blend), true};
  }

  // Measured anew: it was found for another corner.
  [[nodiscard]] std::optional<TimeOptimalPathBlend> moved_there(const Known& known,
                                                                const CornerFrame& frame,
                                                                ToleranceKind kind) const {
    const BsplineCurve& curve = known.found.blend.curve;
    std::vector<Point3> points = curve.control_points();
    for (Point3& p : points) p += frame.vertex - known.vertex;
    BsplineCurve moved(curve.basis(), std::move(points));
    const BlendDeviation deviation = measure_blend(moved, frame);
    if (deviation_of(deviation, kind) > options_.tolerance * (1 + kCornerNoise)) {
      return std::nullopt;
    }
    return TimeOptimalPathBlend{{std::move(moved), deviation}, true};
  }

  const TimeOptimalPathOptions& options_;
  std::map<Directions, std::vector<Known>> known_;
  int searched_ = 0;
};

}  // namespace

TimeOptimalPath time_optimal_path(std::span<const Point3> points,
                                  const TimeOptimalPathOptions& options) {
  require_positive_tolerance(options.tolerance, "time_optimal_path");
  TimeOptimalBlender blender(options);
  TimeOptimalPath path = path_with_blends<TimeOptimalPathBlend>(
      points, options.keep_corner_angle,
      [&](const SharedCorner& each) { return blender.blend(each); });
  path.searched = blender.searched();
  return path;
}

}  // namespace batten::geometry
