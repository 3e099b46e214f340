#include "geometry/fitting/corners/time_optimal_corner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/basic/require.h"
#include "geometry/basic/rounding.h"
#include "geometry/fitting/band_curve.h"
#include "geometry/fitting/corners/guo_corner.h"

namespace batten::geometry {
namespace {

constexpr TimeOptimalTuning kRacing = kTimeOptimalTuning;

// mm over which the speed changes between 0 and v along a leg without acceleration at both ends:
// constant jerk up and down, 2 sqrt(v/j) long, at v/2 in the mean.
double stopping_way(double v, double j) { return v * std::sqrt(v / j); }

// mm/s from which the machine can stop on that way.
double stopping_speed(double way, double j) { return std::cbrt(way * way * j); }

struct RampLeg {
  Vector3 away;  // unit, from the vertex
  double share;  // mm
  double jerk;   // mm/s^3 that the axes give along the leg
  double room;   // mm from the vertex that the curve takes
  double speed;  // mm/s along the leg at its end

  [[nodiscard]] double time() const { return room / speed; }
};

// With the room that the machine needs to change its speed and to swing from side to side, or the
// share, whichever is less.
RampLeg leg_of(const Vector3& away, double share, const TimeOptimalOptions& options) {
  const KinematicLimits& limits = options.limits;
  double jerk = std::numeric_limits<double>::infinity();
  double speed = limits.feed;
  double across = jerk;  // mm/s^3 that the slowest axis gives
  double pull = jerk;    // mm/s^2, the same
  for (int i = 0; i < 3; ++i) {
    const double part = std::abs(away[i]);
    if (part < kSameDirection) continue;
    jerk = std::min(jerk, limits.jerk[i] / part);
    speed = std::min(speed, limits.speed[i] / part);
    across = std::min(across, limits.jerk[i]);
    pull = std::min(pull, limits.acceleration[i]);
  }
  // Without a limit on the jerk an acceleration is reached at once; the way is then that of the
  // acceleration, v^2/2a, which a jerk of a^2/v gives to within a factor of two.
  jerk = std::min(jerk, pull * pull / speed);
  across = std::min(across, pull * pull / speed);
  // To the outside and back to the inside, two tolerances across the leg: 32 d = j t^3.
  const double swing = std::cbrt(64 * options.tolerance / across);
  const double needed = stopping_way(speed, jerk) + speed * (std::sqrt(speed / jerk) + swing);
  const double room = std::min(needed, share);
  return {away, share, jerk, room, std::min(speed, stopping_speed(room, jerk))};
}

// The fastest curve through one corner.
class TimeOptimalLine {
 public:
  // Both must outlive it.
  TimeOptimalLine(const CornerFrame& frame, const TimeOptimalOptions& options)
      : frame_(frame),
        options_(options),
        in_(leg_of(frame.a, std::min(options.share_before, frame.length_a), options)),
        out_(leg_of(frame.b, std::min(options.share_after, frame.length_b), options)) {}

  [[nodiscard]] std::variant<TimeOptimalBlend, NoBlend> fastest() const {
    if (!(std::min(in_.share, out_.share) > options_.tolerance)) return NoBlend::kNoRoom;
    double aim = options_.tolerance;
    for (int round = 0; round < kRacing.band_rounds; ++round) {
      const auto timed = quickest(aim);
      if (!timed) break;
      const BsplineBasis basis = BsplineBasis::clamped(3, breakpoints(timed->time));
      const BsplineCurve curve(basis, timed->points);
      const BlendDeviation deviation = measure_blend(curve, frame_);
      const double measured = deviation_of(deviation, options_.kind);
      if (measured <= options_.tolerance) {
        return TimeOptimalBlend{{curve, deviation}, in_.room,   out_.room,
                                in_.speed,          out_.speed, basis.last() - basis.first(),
                                timed->load};
      }
      aim *= options_.tolerance / measured * (1 - kRacing.further_inside);
    }
    return NoBlend::kNoRoom;
  }

 private:
  // A curve whose time is given, and what the machine lacks for it.
  struct Timed {
    std::vector<Point3> points;
    double time = 0;
    double load = 0;
    bool inside = false;
  };

  // Both sides have as many spans. `lost`: s that the corner costs.
  [[nodiscard]] std::vector<double> breakpoints(double lost) const {
    std::vector<double> parts = {0};  // of a side, from the apex outwards
    double width = 1;
    for (int i = 0; i < kRacing.spans_each; ++i, width *= kRacing.growth) {
      parts.push_back(parts.back() + width);
    }
    for (double& part : parts) part /= parts.back();
    const double apex = in_.time() + lost / 2;
    const double after = out_.time() + lost / 2;
    std::vector<double> breaks;
    for (std::size_t i = parts.size(); --i > 0;) breaks.push_back(apex - parts[i] * apex);
    for (const double part : parts) breaks.push_back(apex + part * after);
    return breaks;
  }

  [[nodiscard]] BandProblem problem(double lost, double tolerance) const {
    const auto breaks = breakpoints(lost);
    BandProblem made{BsplineBasis::clamped(3, breaks), 3, {}, {}, {}};
    const BsplineBasis& basis = made.basis;
    const Point3 start = frame_.vertex + in_.room * in_.away;
    const Point3 end = frame_.vertex + out_.room * out_.away;
    const std::size_t last = basis.size() - 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const double since = basis.greville(i) - basis.first();
      const double until = basis.last() - basis.greville(last - i);
      made.held.push_back(HeldPoint::at(i, start - since * in_.speed * in_.away));
      made.held.push_back(HeldPoint::at(last - i, end - until * out_.speed * out_.away));
    }
    add_band(made, breaks, tolerance);
    add_limits(made);
    return made;
  }

  void add_band(BandProblem& made, const std::vector<double>& breaks, double tolerance) const {
    const double apex = breaks[breaks.size() / 2];
    BandSample sample;
    sample.foot = frame_.vertex;
    sample.radius = tolerance;
    const auto add = [&](BandShape shape, const Vector3& direction) {
      sample.shape = shape;
      sample.direction = direction;
      made.samples.push_back(sample);
    };
    for (std::size_t span = 0; span + 1 < breaks.size(); ++span) {
      for (int i = span == 0 ? 1 : 0; i < kRacing.watched; ++i) {
        const double part = static_cast<double>(i) / kRacing.watched;
        sample.parameter = breaks[span] + part * (breaks[span + 1] - breaks[span]);
        if (sample.parameter <= apex) add(BandShape::kCylinder, frame_.a);
        if (sample.parameter >= apex) add(BandShape::kCylinder, frame_.b);
        if (sample.parameter == apex && options_.kind == ToleranceKind::kPath) {
          add(BandShape::kBall, frame_.b);
        }
      }
    }
  }

  void add_limits(BandProblem& made) const {
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
      speed.radius = limits.feed * (1 + kRacing.overspeed);
      for (int i = k == 3 ? 1 : 0; i < kRacing.watched; ++i) {
        speed.parameter = t[k] + (t[k + 1] - t[k]) * i / kRacing.watched;
        made.samples.push_back(speed);
      }
      if (k == 3) continue;
      add_axes(t[k], 2, limits.acceleration);  // linear in a span
      if (limits.speed.minCoeff() < limits.feed) {
        add_axes(t[k], 1, limits.speed * (1 + kRacing.overspeed));
      }
    }
  }

  // The search begins with `points`; without any, along the legs.
  [[nodiscard]] Timed solved(double lost, double tolerance, std::vector<Point3> points) const {
    const BandProblem made = problem(lost, tolerance);
    if (points.empty()) {
      const double apex = in_.time() + lost / 2;
      for (std::size_t i = 0; i < made.basis.size(); ++i) {
        const double u = made.basis.greville(i) - apex;
        points.push_back(frame_.vertex +
                         (u < 0 ? -u / apex * in_.room * in_.away
                                : u / (made.basis.last() - apex) * out_.room * out_.away));
      }
    }
    const BandCurve curve = least_ratio_in_band(made, std::move(points), 2);
    return {curve.curve.control_points(), lost, curve.worst_ratio, curve.end != BandEnd::kOutside};
  }

  // The load falls as the time rises; where it is 1 the machine is used up.
  [[nodiscard]] std::optional<Timed> quickest(double tolerance) const {
    // A stop at the vertex costs half of the time of each ramp.
    const double stop = std::sqrt(in_.speed / in_.jerk) + std::sqrt(out_.speed / out_.jerk);
    double low = kRacing.least_lost * std::min(in_.time(), out_.time());
    double high = kRacing.most_lost * stop;
    Timed slow = solved(high, tolerance, {});
    if (!slow.inside) return std::nullopt;
    double low_load = std::numeric_limits<double>::infinity();
    double lost = kRacing.first_lost * stop;
    for (int i = 0; i < kRacing.time_tries && high - low > kRacing.time_error * stop; ++i) {
      Timed next = solved(lost, tolerance, slow.points);
      if (next.inside && next.load <= 1) {
        high = lost;
        slow = std::move(next);
      } else {
        low = lost;
        low_load = next.inside ? next.load : low_load;
      }
      // The logarithm of the load is nearly linear.
      double part = 0.5;
      if (std::isfinite(low_load) && low_load > 1 && slow.load < 1) {
        part = std::log(low_load) / (std::log(low_load) - std::log(slow.load));
      }
      lost = low + std::clamp(part, kRacing.from_ends, 1 - kRacing.from_ends) * (high - low);
    }
    return slow;
  }

  const CornerFrame& frame_;
  const TimeOptimalOptions& options_;
  RampLeg in_;
  RampLeg out_;
};

void check(const TimeOptimalOptions& options) {
  require_positive_tolerance(options.tolerance, "time_optimal_corner");
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isfinite(options.limits.acceleration[axis]) ||
        std::isfinite(options.limits.jerk[axis])) {
      continue;
    }
    throw std::invalid_argument("time_optimal_corner: axis " + std::to_string(axis) +
                                " with neither acceleration nor jerk limited");
  }
  require(options.limits.feed > 0 && std::isfinite(options.limits.feed),
          "time_optimal_corner: feed", options.limits.feed, "a positive number of mm/s");
}

}  // namespace

std::variant<TimeOptimalBlend, NoBlend> time_optimal_corner(const Corner& corner,
                                                            const TimeOptimalOptions& options) {
  check(options);
  const auto framed = frame_of(corner);
  if (const auto* none = std::get_if<NoBlend>(&framed)) return *none;
  return TimeOptimalLine(std::get<CornerFrame>(framed), options).fastest();
}

namespace {

bool bends_more_than(const BsplineCurve& curve, double curvature) {
  constexpr int kSteps = kRacing.watched;
  const std::vector<double> breaks = curve.breakpoints();
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    for (int k = 0; k < kSteps; ++k) {
      const double u = breaks[i] + (k + 0.5) / kSteps * (breaks[i + 1] - breaks[i]);
      if (!(curve.curvature_at(u) <= curvature)) return true;
    }
  }
  return false;
}

// A blend that was found, with the vertex and the shares it was found for.
struct KnownBlend {
  TimeOptimalBlend found;
  Point3 vertex;
  double share_before;
  double share_after;

  // Whether a search with these shares would find the same: they are the same, or neither search
  // is bound by them.
  [[nodiscard]] bool serves(const SharedCorner& corner) const {
    const auto is_same = [](double used, double share, double other) {
      constexpr double kAlike = kCornerTuning.alike;
      return std::abs(share - other) <= kAlike || used < std::min(share, other) - kAlike;
    };
    return is_same(found.before, share_before, corner.share_before) &&
           is_same(found.after, share_after, corner.share_after);
  }
};

struct TimeOptimalBlender {
  std::variant<TimeOptimalPathBlend, NoBlend> blend(const SharedCorner& shared,
                                                    const CornerFrame& frame) {
    auto five = guo_corner(shared.corner, {options.tolerance, shared.kind, GuoApex::kAllowed},
                           shared.share_before, shared.share_after);
    const auto* gentle = std::get_if<GuoBlend>(&five);
    if (turns_more(shared.corner, options.least_raced_turn)) {
      auto raced = raced_blend(shared, frame);
      if (raced && (gentle == nullptr ||
                    !bends_more_than(raced->curve, kRacing.sharper * gentle->greatest_curvature))) {
        return TimeOptimalPathBlend{std::move(*raced), true};
      }
    }
    if (gentle == nullptr) return std::get<NoBlend>(five);
    return TimeOptimalPathBlend{gentle->blend, false};
  }

  std::optional<CornerBlend> raced_blend(const SharedCorner& shared, const CornerFrame& frame) {
    std::vector<KnownBlend>& alike = found[alike_legs(frame)];
    for (const KnownBlend& known : alike) {
      if (!known.serves(shared)) continue;
      if (auto again = moved_there(known, frame, shared.kind)) return again;
    }
    if (searched >= options.most_raced) return std::nullopt;
    ++searched;
    const auto outcome = time_optimal_corner(
        shared.corner,
        {options.tolerance, shared.kind, options.limits, shared.share_before, shared.share_after});
    const auto* raced = std::get_if<TimeOptimalBlend>(&outcome);
    if (raced == nullptr) return std::nullopt;
    alike.push_back({*raced, frame.vertex, shared.share_before, shared.share_after});
    return raced->blend;
  }

  // Measured anew: it was found for another corner.
  [[nodiscard]] std::optional<CornerBlend> moved_there(const KnownBlend& known,
                                                       const CornerFrame& frame,
                                                       ToleranceKind kind) const {
    const BsplineCurve& curve = known.found.blend.curve;
    std::vector<Point3> points = curve.control_points();
    for (Point3& p : points) p += frame.vertex - known.vertex;
    BsplineCurve moved(curve.basis(), std::move(points));
    const BlendDeviation deviation = measure_blend(moved, frame);
    const double allowed = options.tolerance * (1 + kCornerTuning.measuring_noise);
    if (deviation_of(deviation, kind) > allowed) return std::nullopt;
    return CornerBlend{std::move(moved), deviation};
  }

  const TimeOptimalPathOptions& options;
  std::map<AlikeLegs, std::vector<KnownBlend>> found = {};
  int searched = 0;
};

}  // namespace

TimeOptimalPath time_optimal_path(std::span<const Point3> points,
                                  const TimeOptimalPathOptions& options) {
  require_positive_tolerance(options.tolerance, "time_optimal_path");
  TimeOptimalBlender blender{options};
  TimeOptimalPath path = path_with_blends<TimeOptimalPathBlend>(
      points, options, [&](const SharedCorner& each, const CornerFrame& frame) {
        return blender.blend(each, frame);
      });
  path.searched = blender.searched;
  return path;
}

}  // namespace batten::geometry
