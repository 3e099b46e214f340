#include "postproc/smooth/selection/candidate_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "postproc/machine/models/junction_speed.h"
#include "postproc/machine/models/velocity_profile.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/selection/candidate.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

CandidateBounds::CandidateBounds(const RunTask& task, const SmoothedRun& so_far)
    : task_(task), so_far_(so_far), least_time_(least_time_of(LimitsOf::kDirections)) {
  // A control that joins lines runs faster than each of them allows: then nothing is known of the
  // directions of its moves.
  if (least_time_ > so_far.facts.scale.alone) least_time_ = least_time_of(LimitsOf::kAnyDirection);
}

double CandidateBounds::least_time_of(LimitsOf of) const {
  return postproc::least_time(task_.run, tolerance_of(task_.run, task_.options.tolerance_mm),
                              *task_.options.machine, task_.context.after.path,
                              task_.options.tolerance_kind, of);
}

// Of a block in such a form: blocks of one form have about the same words.
double CandidateBounds::least_bytes(Form form) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& c : so_far_.candidates) {
    if (c.form == form)
      least = std::min(least, kBounds.shorter * c.figures.bytes / c.figures.blocks);
  }
  return std::isfinite(least) ? least : kBounds.least_bytes;
}

Figures CandidateBounds::least(Form form, double blocks, double distance) const {
  const CostScale& scale = so_far_.facts.scale;
  const Times& before = scale.original.times;
  Figures least;
  // A control that rounds corners may take less than the length of the path at its feeds.
  least.times = before;
  least.times.programmed += std::min(0.0, least_time_ - scale.alone) - task_.context.may_win;
  // Where noise is smoothed over many vertices the path is shorter than the bound knows: what one
  // form takes another may take as well.
  for (const Candidate& c : so_far_.candidates) {
    least.times.programmed = std::min(least.times.programmed, c.figures.times.programmed);
  }
  least.blocks = kBounds.fewer * blocks;
  least.bytes = std::min(least_bytes(form) * least.blocks, scale.original.bytes);
  least.distance = std::hypot(distance, so_far_.facts.scattered);
  return least;
}

// What rounds corners is within the tolerance of them: it comes nearer to the path by as much.
bool CandidateBounds::is_hopeless() const {
  const auto& [run, context, options, scope, memo, record] = task_;
  if (options.prefer == Prefer::kSize || is_forced(options.output, so_far_.facts, options))
    return false;
  const double tolerance = tolerance_of(run, options.tolerance_mm);
  if (coarse_part(run, tolerance) < kBounds.coarse) return false;
  CostScale scale = so_far_.facts.scale;
  scale.original.distance = std::max(chord_height_beyond(run, 0), scale.near);
  const Figures corners = least(Form::kLines, 2 * scale.original.blocks / kBounds.fewer,
                                chord_height_beyond(run, tolerance));
  return objection_to(corners, scale, options.prefer) != Objection::kNone ||
         cost_of(corners, scale, options.prefer) >= cost_of(scale.original, scale, options.prefer);
}

bool CandidateBounds::is_beaten(Form form, double blocks, double distance) const {
  const SmoothOptions& options = task_.options;
  const RunFacts& facts = so_far_.facts;
  const Figures figures = least(form, blocks, distance);
  if (is_forced(form, facts, options)) return false;
  return objection_to(figures, facts.scale, options.prefer) != Objection::kNone ||
         cost_of(figures, facts.scale, options.prefer) >= cost_to_beat(so_far_, options);
}

std::size_t CandidateBounds::most_blocks(Form form, double distance) const {
  const auto is_too_many = [&](std::size_t blocks) {
    return is_beaten(form, static_cast<double>(blocks) / kBounds.fewer, distance);
  };
  std::size_t few = 0;
  constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
  if (!is_too_many(kAny)) return kAny;
  std::size_t many = 16;
  while (!is_too_many(many)) few = std::exchange(many, 2 * many);
  while (many - few > 1) {
    const std::size_t middle = (few + many) / 2;
    (is_too_many(middle) ? many : few) = middle;
  }
  return few;
}

using geometry::Vector3;

namespace {

// mm: how far inside of a corner a path may pass that is within `tolerance` of its legs. In the
// reading `band` the corner itself may be farther from it.
double inside_of_corner(double tolerance, double half_turn, geometry::ToleranceKind kind) {
  if (kind != geometry::ToleranceKind::kBand) return tolerance;
  return tolerance / std::max(std::cos(half_turn), std::sin(geometry::kSharpestCut / 2));
}

// What a path within `tolerance` of a corner can save by cutting it: a chord across the corner at
// the height h above it is 2 h tan(turn / 4) shorter than the legs. It joins the middles of the
// legs at most.
double saved_at(const Vector3& a, const Vector3& b, double tolerance,
                geometry::ToleranceKind kind) {
  const double to_middles = 0.5 * (a.norm() + b.norm() - (a + b).norm());
  const double across = a.cross(b).norm();
  // A sine is less than its turn, and a tangent greater.
  const double sine = across / (a.norm() * b.norm());
  if (to_middles <= tolerance * sine / 2) return to_middles;
  const double turn = std::atan2(across, a.dot(b));
  const double inside = inside_of_corner(tolerance, turn / 2, kind);
  return std::min(to_middles, 2 * inside * std::tan(turn / 4));
}

}  // namespace

namespace {

// The fastest that the machine allows in a direction.
struct PathLimits {
  double velocity = 0;      // mm/s
  double acceleration = 0;  // mm/s^2
};

class DirectionLimits {
 public:
  explicit DirectionLimits(const Machine& machine, LimitsOf of)
      : machine_(machine),
        velocities_(axis_velocities(machine, false)),
        accelerations_(axis_accelerations(machine)),
        of_(of) {}

  [[nodiscard]] PathLimits along(const Vector3& direction) const {
    const auto axes = [&](const Vector3& limits) {
      return of_ == LimitsOf::kDirections ? limit_along(direction, limits) : limits.norm();
    };
    return {std::min(axes(velocities_), machine_.path_feed),
            std::min(axes(accelerations_), machine_.path_acceleration)};
  }

 private:
  const Machine& machine_;
  Vector3 velocities_;
  Vector3 accelerations_;
  LimitsOf of_;
};

// mm: how far the way of the machine may leave the path that it is told at a corner, where nothing
// but the bend of that way lets it be faster there. Nothing where short blocks do as well: grbl and
// Marlin look at each joint alone.
std::optional<double> rounded_by_control(const Machine& machine, const gcode::PathControl& path) {
  const double acceleration = machine.max_acceleration();
  switch (machine.model) {
    case ControllerModel::kLinuxcnc: {
      const double blend = path.blend_tolerance.value_or(machine.blend_tolerance);
      if (!(blend > 0)) return std::nullopt;  // no limit
      return blend + path.naive_cam_tolerance.value_or(machine.naive_cam_tolerance);
    }
    case ControllerModel::kKlipper: {
      const double speed = machine.square_corner_velocity;
      return speed * speed * (std::numbers::sqrt2 - 1) / acceleration;
    }
    case ControllerModel::kLookAhead:
      // The velocity changes within a period of the servo, and no block is shorter than its own.
      if (machine.servo_period > machine.block_period) return std::nullopt;
      return acceleration * machine.servo_period * machine.servo_period;
    default:
      return std::nullopt;
  }
}

// mm/s, at which a way passes the corner between two edges that stays within `far` of them: on the
// widest circle that does. No limit where the edges are shorter than it reaches.
double greatest_corner_speed(const Vector3& a, const Vector3& b, double far,
                             geometry::ToleranceKind kind, const Vector3& accelerations) {
  const Vector3 before = a.normalized();
  const Vector3 turn = b.normalized() - before;
  const double sine = turn.norm() / 2;  // of half the turn
  if (sine < geometry::kSameDirection) return kNoLimit;
  const double cosine = std::sqrt(std::max(0.0, 1 - sine * sine));
  const double inside = inside_of_corner(far, std::atan2(sine, cosine), kind);
  const double radius = (inside * cosine + far) * (1 + cosine) / (sine * sine);
  if (radius * sine > std::min(a.norm(), b.norm())) return kNoLimit;
  return std::sqrt(limit_along(turn.normalized(), accelerations) * radius);
}

}  // namespace

double time_at_feeds(const Run& run, const Machine& machine) {
  const std::vector<double> feeds = edge_feeds(run);
  double time = 0;
  for (std::size_t i = 0; i < feeds.size(); ++i) {
    time += (run.points[i + 1] - run.points[i]).norm() /
            std::min(feeds[i] / kMinute, machine.max_velocity());
  }
  return time;
}

double least_time(const Run& run, double tolerance, const Machine& machine,
                  const gcode::PathControl& path, geometry::ToleranceKind kind, LimitsOf of) {
  const auto& p = run.points;
  const std::vector<double> feeds = edge_feeds(run);
  const DirectionLimits limits(machine, of);
  const Vector3 accelerations = axis_accelerations(machine);
  const std::optional<double> rounded = rounded_by_control(machine, path);
  std::vector<VelocityStretch> chain;
  chain.reserve(feeds.size());
  for (std::size_t i = 0; i < feeds.size(); ++i) {
    const Vector3 edge = p[i + 1] - p[i];
    const double length = edge.norm();
    const double saved = i > 0 ? saved_at(p[i] - p[i - 1], edge, tolerance, kind) : 0;
    if (!chain.empty() && rounded) {
      double& exit = chain.back().exit_velocity;
      exit = std::min(exit, greatest_corner_speed(p[i] - p[i - 1], edge, tolerance + *rounded, kind,
                                                  accelerations));
    }
    if (!(length - saved > 0)) continue;
    const PathLimits most = limits.along(edge / length);
    VelocityStretch stretch;
    stretch.length = length - saved;
    stretch.max_velocity = std::min(feeds[i] / kMinute, most.velocity);
    stretch.acceleration = most.acceleration;
    chain.push_back(stretch);
  }
  const std::vector<double> speeds = joint_velocities(chain, {});
  double time = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    time += stretch_time(chain[i], speeds[i], speeds[i + 1], {});
  }
  return time;
}

double coarse_part(const Run& run, double tolerance) {
  const auto& p = run.points;
  std::size_t coarse = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Vector3 a = p[i] - p[i - 1];
    const Vector3 b = p[i + 1] - p[i];
    const double across = a.cross(b).norm();
    const auto [shorter, longer] = std::minmax({a.norm(), b.norm()});
    // A turn of less than a right angle is less than 1.6 of its sine.
    if (a.dot(b) > 0 && 1.6 * across / 8 <= tolerance * longer) continue;
    if (std::atan2(across, a.dot(b)) * shorter / 8 > tolerance) ++coarse;
  }
  return p.size() > 2 ? static_cast<double>(coarse) / static_cast<double>(p.size() - 2) : 0;
}

double chord_height_beyond(const Run& run, double within) {
  double squares = 0;
  double all = 0;
  const auto& p = run.points;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Vector3 a = p[i] - p[i - 1];
    const Vector3 b = p[i + 1] - p[i];
    const double length = a.norm() + b.norm();
    all += length;
    const double turn = std::atan2(a.cross(b).norm(), a.dot(b));
    if (turn > kBounds.sharp_corner) continue;
    const double height = turn * std::min(a.norm(), b.norm()) / 8;
    const double beyond = std::max(0.0, height - within);
    squares += length * beyond * beyond;
  }
  return all > 0 ? std::sqrt(squares / all) : 0;
}

bool rounding_is_worth_trying(double least_time, double time) {
  return least_time <= (1 - kBounds.worth_trying) * time;
}

bool tube_is_worth_trying(std::size_t points, double least_time, double time) {
  const double costs = kBounds.tube_starts + kBounds.tube_costs * static_cast<double>(points);
  const double left = time - least_time;
  return left >= kBounds.tube_wins * time && left >= costs;
}

bool is_run_of_corners(const Run& run, double user_mm) {
  return coarse_part(run, tolerance_of(run, user_mm)) >= kBounds.corners;
}

bool corners_are_worth_trying(double corners, double least_time, double time) {
  return corners >= kBounds.corners && rounding_is_worth_trying(least_time, time);
}

bool searches_are_worth_trying(std::size_t points, double least_time, double before, double now) {
  const double left = now - least_time;
  return points <= kBounds.most_searched && now <= kCost.clearly_faster * before &&
         left >= kBounds.worth_trying * now &&
         left >= kBounds.search_costs * static_cast<double>(points);
}

}  // namespace batten::postproc
