#include "postproc/machine/program_time/planned_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "geometry/path/parameter_samples.h"
#include "postproc/machine/models/junction_speed.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/machine/planner/s_curve.h"

namespace batten::postproc {
namespace {

constexpr double kHalf = 0.5;

// Radians: a turn that is rounding, for S-curves.
constexpr double kSmooth = 1e-4;

KinematicPathLimits limits_of_piece(const TimedPiece& piece, const Machine& machine) {
  KinematicPathLimits limits;
  limits.feed = std::min(piece.feed / kMinute, machine.path_feed);
  limits.speed = axis_velocities(machine, piece.rapid);
  limits.acceleration = axis_accelerations(machine);
  limits.jerk = axis_jerks(machine);
  limits.tangential_acceleration = machine.path_acceleration;
  limits.tangential_jerk = machine.path_jerk;
  limits.period = machine.servo_period;
  return limits;
}

SCurveLimits s_curve_limits(const Machine& machine) {
  SCurveLimits limits;
  limits.velocity = std::min(machine.max_velocity(), machine.path_feed);
  limits.acceleration = std::min(machine.max_acceleration(), machine.path_acceleration);
  limits.jerk = std::min(machine.max_jerk(), machine.path_jerk);
  return limits;
}

// A piece is slow where it takes so many times as long as the machine takes to its feed. A plan has
// nodes in such times: along slow pieces nothing happens but at stops.
constexpr double kSlow = 300;

// The part of the acceleration and of the jerk that bends of slow pieces may take.
constexpr double kLittle = 0.1;

// Pieces of one feed, which are planned as one, and how fast its ends may be passed.
struct Stretch {
  std::size_t first = 0;
  std::size_t count = 0;
  PlanEnds ends;
  FeedPlan plan;
  bool slow = false;  // it runs at its feed but at stops, and has no plan
};

class JerkPlans {
 public:
  JerkPlans(std::span<const TimedPiece> pieces, const Machine& machine)
      : pieces_(pieces), machine_(machine) {
    for (const TimedPiece& piece : pieces) path_.push_back(piece.piece);
  }

  std::vector<PlannedPiece> run() {
    cut();
    for (Stretch& stretch : stretches_) {
      stretch.slow = is_slow(stretch);
      if (!stretch.slow) plan(stretch);
    }
    // A stretch may not come to the speed at which its neighbour would pass their joint.
    for (std::size_t i = 1; i < stretches_.size(); ++i) meet(stretches_[i - 1], stretches_[i]);
    for (std::size_t i = stretches_.size(); i-- > 1;) meet(stretches_[i - 1], stretches_[i]);
    std::vector<PlannedPiece> all(pieces_.size());
    for (const Stretch& stretch : stretches_) count(stretch, all);
    return all;
  }

 private:
  void cut() {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const bool goes_on = i > 0 && pieces_[i].feed == pieces_[i - 1].feed &&
                           pieces_[i].rapid == pieces_[i - 1].rapid;
      if (goes_on) {
        ++stretches_.back().count;
        continue;
      }
      if (i > 0) {
        const KinematicPathLimits before = limits_of_piece(pieces_[i - 1], machine_);
        const KinematicPathLimits after = limits_of_piece(pieces_[i], machine_);
        const double joint = joint_speed(derivatives_by_length(path_[i - 1], 1),
                                         derivatives_by_length(path_[i], 0), after);
        stretches_.back().ends.end_speed = std::min({joint, before.feed, after.feed});
      }
      const double speed = i > 0 ? stretches_.back().ends.end_speed : 0;
      stretches_.push_back({.first = i, .count = 1, .ends = {speed, 0}, .plan = {}});
    }
  }

  void plan(Stretch& stretch) const {
    stretch.plan = plan_feed(std::span(path_).subspan(stretch.first, stretch.count),
                             limits_of_piece(pieces_[stretch.first], machine_), stretch.ends);
  }

  void meet(Stretch& before, Stretch& after) const {
    if (before.plan.nodes.empty() || after.plan.nodes.empty()) return;
    const double end = before.plan.nodes.back().speed;
    const double start = after.plan.nodes.front().speed;
    const double both = std::min(end, start);
    if (end > both) {
      before.ends.end_speed = both;
      plan(before);
    } else if (start > both) {
      after.ends.start_speed = both;
      plan(after);
    }
  }

  // mm/s, in any direction.
  [[nodiscard]] double speed_of(const Stretch& stretch) const {
    return std::min(pieces_[stretch.first].feed / kMinute, s_curve_limits(machine_).velocity);
  }

  // Whether its pieces are slow, and bend so little that they are run at the feed.
  [[nodiscard]] bool is_slow(const Stretch& stretch) const {
    const SCurveLimits limits = s_curve_limits(machine_);
    const double v = speed_of(stretch);
    const double change = s_curve_change(v, limits);
    return std::ranges::all_of(std::span(path_).subspan(stretch.first, stretch.count),
                               [&](const geometry::PathPiece& piece) {
                                 const double curvature = greatest_curvature(piece);
                                 return geometry::length_of(piece) > kSlow * v * change &&
                                        curvature * v * v <= kLittle * limits.acceleration &&
                                        curvature * curvature * v * v * v <= kLittle * limits.jerk;
                               });
  }

  // Each change of speed at a joint takes longer than its way at the feed.
  void count_slow(const Stretch& stretch, std::vector<PlannedPiece>& all) const {
    const KinematicPathLimits limits = limits_of_piece(pieces_[stretch.first], machine_);
    const double v = speed_of(stretch);
    const auto lost = [&, of = s_curve_limits(machine_)](double joint) {
      const double change = std::max(v - joint, 0.0);
      return s_curve_change(change, of) * change / (2 * v);
    };
    double start = stretch.ends.start_speed;
    for (std::size_t i = stretch.first; i < stretch.first + stretch.count; ++i) {
      const bool last = i + 1 == stretch.first + stretch.count;
      const double end = last ? stretch.ends.end_speed
                              : joint_speed(derivatives_by_length(path_[i], 1),
                                            derivatives_by_length(path_[i + 1], 0), limits);
      all[i].seconds += geometry::length_of(path_[i]) / v + lost(start) + lost(end);
      start = end;
    }
  }

  void count(const Stretch& stretch, std::vector<PlannedPiece>& all) const {
    if (stretch.slow) return count_slow(stretch, all);
    const auto& nodes = stretch.plan.nodes;
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
      const std::size_t number = stretch.first + nodes[i].piece;
      const double seconds = nodes[i + 1].time - nodes[i].time;
      const double way = nodes[i + 1].distance - nodes[i].distance;
      all[number].seconds += seconds;
      if (way < kHalf * pieces_[number].feed / kMinute * seconds) {
        all[number].slow_seconds += seconds;
      }
    }
  }

  std::span<const TimedPiece> pieces_;
  const Machine& machine_;
  std::vector<geometry::PathPiece> path_;
  std::vector<Stretch> stretches_;
};

// A place that is passed no faster than this, as a curvature: S-curves go by nothing else. 0 is
// rest.
double curvature_for(double speed, const SCurveLimits& limits) {
  return limits.acceleration / (speed * speed);
}

// Pieces of one feed; the ends are passed no faster than so.
std::vector<SCurveNode> s_curve_nodes_of(std::span<const TimedPiece> pieces, double start_speed,
                                         double end_speed, const SCurveLimits& limits) {
  const double of_feed = curvature_for(pieces.front().feed / kMinute, limits);
  std::vector<geometry::ParameterSample> samples = {
      {0, 0, 1, std::max(of_feed, curvature_for(start_speed, limits))}};
  double distance = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const geometry::PathPiece& piece = pieces[i].piece;
    const int steps = std::holds_alternative<geometry::Line>(piece) ? 2 : geometry::kNaseathSteps;
    double way = 0;
    double before = 0;
    for (int k = 0; k < steps; ++k) {
      // In the middle of each step: at the ends the neighbours count.
      const double t = (k + kHalf) / steps;
      way += length_between(piece, before, t);
      before = t;
      samples.push_back({static_cast<double>(i) + t, distance + way, 1,
                         std::max(of_feed, geometry::curvature_at(piece, t))});
    }
    distance += geometry::length_of(piece);
  }
  samples.push_back({static_cast<double>(pieces.size()), distance, 1,
                     std::max(of_feed, curvature_for(end_speed, limits))});
  return s_curve_nodes(samples, limits);
}

// mm/s, at the joint in front of piece i: 0 where the direction jumps.
double s_curve_joint(std::span<const TimedPiece> pieces, std::size_t i) {
  const geometry::Vector3 turn =
      geometry::direction_at(pieces[i].piece, 0) - geometry::direction_at(pieces[i - 1].piece, 1);
  return turn.norm() > kSmooth ? 0 : std::min(pieces[i - 1].feed, pieces[i].feed) / kMinute;
}

// The time between two nodes goes by the way: the curve is stretched over all of it.
void count_s_curves(const std::vector<SCurveNode>& nodes, std::span<const TimedPiece> pieces,
                    std::span<PlannedPiece> planned) {
  std::size_t piece = 0;
  double end = geometry::length_of(pieces.front().piece);  // mm, of that piece
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const double speed = kHalf * (nodes[i - 1].velocity + nodes[i].velocity);
    if (!(speed > 0)) continue;
    for (double at = nodes[i - 1].distance; at < nodes[i].distance;) {
      while (at >= end && piece + 1 < pieces.size()) {
        end += geometry::length_of(pieces[++piece].piece);
      }
      const bool is_last = piece + 1 == pieces.size();
      const double to = is_last ? nodes[i].distance : std::min(nodes[i].distance, end);
      const double seconds = (to - at) / speed;
      planned[piece].seconds += seconds;
      if (speed < kHalf * pieces[piece].feed / kMinute) planned[piece].slow_seconds += seconds;
      at = to;
    }
  }
}

std::vector<PlannedPiece> by_s_curves(std::span<const TimedPiece> pieces, const Machine& machine) {
  const SCurveLimits limits = s_curve_limits(machine);
  std::vector<PlannedPiece> all(pieces.size());
  double start_speed = 0;
  for (std::size_t first = 0, i = 1; i <= pieces.size(); ++i) {
    const bool is_end = i == pieces.size();
    const double joint = is_end ? 0 : s_curve_joint(pieces, i);
    if (!is_end && joint > 0 && pieces[i].feed == pieces[i - 1].feed) continue;
    const auto part = pieces.subspan(first, i - first);
    count_s_curves(s_curve_nodes_of(part, start_speed, joint, limits), part,
                   std::span(all).subspan(first, i - first));
    start_speed = joint;
    first = i;
  }
  return all;
}

}  // namespace

std::vector<PlannedPiece> planned_chain(std::span<const TimedPiece> pieces, const Machine& machine,
                                        FeedPlanner planner) {
  if (planner == FeedPlanner::kControl) {
    throw std::invalid_argument("planned_chain: the model of a control is no plan");
  }
  if (pieces.empty()) return {};
  if (planner == FeedPlanner::kSCurve) return by_s_curves(pieces, machine);
  return JerkPlans(pieces, machine).run();
}

}  // namespace batten::postproc
