#include "postproc/machine/models/planned_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "geometry/path/parameter_samples.h"
#include "postproc/machine/models/junction_speed.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/machine/planner/planned_interval.h"
#include "postproc/machine/planner/s_curve.h"

namespace batten::postproc {
namespace {

constexpr double kHalf = 0.5;

// Radians: a turn that is rounding, for S-curves.
constexpr double kSmooth = 1e-4;

SCurveLimits s_curve_limits(const Machine& machine) {
  SCurveLimits limits;
  limits.velocity = std::min(machine.max_velocity(), machine.path_feed);
  limits.acceleration = std::min(machine.max_acceleration(), machine.path_acceleration);
  limits.jerk = std::min(machine.max_jerk(), machine.path_jerk);
  return limits;
}

// A piece is slow where it takes so many times as long as the machine takes to its feed. A plan has
// nodes in such times: along slow pieces nothing happens but at their ends.
constexpr double kSlow = 300;

// Of such a time, the way at the feed from the end of a slow piece that is planned: after half of
// one the feed is reached, without acceleration.
constexpr double kSettled = 2;

// The part of the acceleration and of the jerk that bends of slow pieces may take.
constexpr double kLittle = 0.1;

// A plan of a whole chain. Slow pieces are planned near their ends only and run at their feed
// between them.
class JerkPlan {
 public:
  JerkPlan(std::span<const TimedPiece> pieces, const Machine& machine, bool stops_at_ends,
           double density)
      : pieces_(pieces),
        machine_(machine),
        along_(s_curve_limits(machine)),
        stops_at_ends_(stops_at_ends),
        density_(density) {}

  std::vector<FeedPlanNode> run() {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const double feed = pieces_[i].feed / kMinute;
      const double settled = kSettled * feed * s_curve_change(feed, along_);
      const double length = geometry::length_of(pieces_[i].piece);
      double planned_from = 0;
      if (is_slow(pieces_[i].piece, feed, kSlow / kSettled * settled)) {
        const double share = settled / length;
        add(i, 0, share);
        plan_up_to(feed);
        run_on(i, 1 - share, (1 - 2 * share) * length);
        planned_from = 1 - share;
      }
      add(i, planned_from, 1);
      const bool is_end = i + 1 == pieces_.size();
      if (is_end || (stops_at_ends_ && !pieces_[i + 1].goes_on)) plan_up_to(0);
    }
    return std::move(nodes_);
  }

 private:
  // A piece of the chain between two of its parameters.
  struct Part {
    std::size_t piece = 0;
    double t0 = 0;
    double t1 = 1;
  };

  [[nodiscard]] bool is_slow(const geometry::PathPiece& piece, double feed, double length) const {
    if (!(geometry::length_of(piece) > length) || feed > along_.velocity) return false;
    if (std::holds_alternative<geometry::CubicBezier>(piece)) return false;
    const double bend = greatest_curvature(piece);
    return bend * feed * feed <= kLittle * along_.acceleration &&
           bend * bend * feed * feed * feed <= kLittle * along_.jerk;
  }

  void add(std::size_t piece, double t0, double t1) {
    const bool whole = t0 == 0 && t1 == 1;
    path_.push_back(whole ? pieces_[piece].piece
                          : geometry::sub_piece(pieces_[piece].piece, t0, t1));
    limits_.push_back(kinematic_limits(machine_, pieces_[piece].feed, pieces_[piece].rapid));
    parts_.push_back({piece, t0, t1});
  }

  // From the speed that the plan has come to, to this one, both held; 0 is rest.
  void plan_up_to(double end_speed) {
    const double start_speed = nodes_.empty() ? 0 : nodes_.back().speed;
    const FeedPlan plan = plan_feed(path_, limits_, {start_speed, end_speed, true}, density_);
    const FeedPlanNode from = nodes_.empty() ? FeedPlanNode{} : nodes_.back();
    if (!nodes_.empty()) nodes_.pop_back();
    for (FeedPlanNode node : plan.nodes) {
      const Part& part = parts_[node.piece];
      node.distance += from.distance;
      node.time += from.time;
      node.piece = part.piece;
      node.t = part.t0 + (part.t1 - part.t0) * node.t;
      nodes_.push_back(node);
    }
    path_.clear();
    limits_.clear();
    parts_.clear();
  }

  void run_on(std::size_t piece, double t, double length) {
    const FeedPlanNode& from = nodes_.back();
    const double seconds = length / from.speed;
    nodes_.push_back({from.distance + length, from.speed, 0, from.time + seconds, piece, t});
  }

  std::span<const TimedPiece> pieces_;
  const Machine& machine_;
  SCurveLimits along_;
  bool stops_at_ends_;
  double density_;
  std::vector<geometry::PathPiece> path_;  // that is not yet planned
  std::vector<KinematicPathLimits> limits_;
  std::vector<Part> parts_;
  std::vector<FeedPlanNode> nodes_;
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
    // Lines and arcs bend evenly, whatever rounding makes of the two radii of an arc.
    const bool bends_evenly = !std::holds_alternative<geometry::CubicBezier>(piece);
    const int steps = bends_evenly ? 1 : geometry::kNaseathSteps;
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

// The S-curve between two speeds, stretched over all of the way.
void add_s_curve(const SCurveNode& from, const SCurveNode& to, double distance,
                 const SCurveLimits& limits, std::vector<JerkPhase>& phases) {
  const double way = to.distance - from.distance;
  const double speed = kHalf * (from.velocity + to.velocity);
  if (!(way > 0) || !(speed > 0)) return;
  const double change = to.velocity - from.velocity;
  const double seconds = way / speed;
  const double shortest = s_curve_change(std::abs(change), limits);
  // Seconds of even jerk, of the shortest curve and of this one.
  const double of_shortest =
      std::isinf(limits.jerk) ? 0 : std::min(shortest / 2, limits.acceleration / limits.jerk);
  const double rounded = shortest > 0 ? of_shortest / shortest * seconds : 0;
  const double acceleration = change / (seconds - rounded);
  JerkPhase phase{phases.empty() ? 0 : phases.back().start + phases.back().duration,
                  0,
                  distance,
                  from.velocity,
                  0,
                  0};
  const auto add = [&](double duration, double begin, double end) {
    if (!(duration > 0)) return;
    phase.duration = duration;
    phase.acceleration = begin;
    phase.jerk = (end - begin) / duration;
    phases.push_back(phase);
    phase.start += duration;
    phase.way += duration * (phase.velocity + duration * (begin / 3 + end / 6));
    phase.velocity += duration * (begin + end) / 2;
  };
  add(rounded, 0, acceleration);
  add(seconds - 2 * rounded, acceleration, acceleration);
  add(rounded, acceleration, 0);
}

std::vector<JerkPhase> by_s_curves(std::span<const TimedPiece> pieces, const Machine& machine,
                                   bool stops_at_ends) {
  const SCurveLimits limits = s_curve_limits(machine);
  std::vector<JerkPhase> phases;
  double start_speed = 0;
  double distance = 0;  // mm of the parts before
  for (std::size_t first = 0, i = 1; i <= pieces.size(); ++i) {
    const bool is_end = i == pieces.size();
    const bool stops = is_end || (stops_at_ends && !pieces[i].goes_on);
    const double joint = stops ? 0 : s_curve_joint(pieces, i);
    if (!is_end && joint > 0 && pieces[i].feed == pieces[i - 1].feed) continue;
    const auto nodes =
        s_curve_nodes_of(pieces.subspan(first, i - first), start_speed, joint, limits);
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      add_s_curve(nodes[k - 1], nodes[k], distance + nodes[k - 1].distance, limits, phases);
    }
    distance += nodes.back().distance;
    start_speed = joint;
    first = i;
  }
  return phases;
}

}  // namespace

PlannedMotion::PlannedMotion(std::span<const TimedPiece> pieces, const Machine& machine,
                             FeedPlanner planner, const gcode::PathControl& path, double density)
    : pieces_(pieces) {
  if (planner == FeedPlanner::kControl) {
    throw std::invalid_argument("PlannedMotion: the model of a control is no plan");
  }
  if (pieces.empty()) return;
  const bool stops_at_ends = stops_at_block_ends(machine, path);
  if (planner == FeedPlanner::kJerk) {
    nodes_ = JerkPlan(pieces, machine, stops_at_ends, density).run();
    if (!nodes_.empty()) duration_ = nodes_.back().time;
    return;
  }
  s_curves_.emplace(by_s_curves(pieces, machine, stops_at_ends));
  double end = 0;
  for (const TimedPiece& piece : pieces) ends_.push_back(end += geometry::length_of(piece.piece));
  duration_ = s_curves_->duration();
}

PlannedPosition PlannedMotion::position_at(double time) const {
  if (s_curves_) {
    const double way = s_curves_->way_at(time);
    const auto end = std::ranges::upper_bound(ends_, way);
    const std::size_t piece = std::min<std::size_t>(end - ends_.begin(), ends_.size() - 1);
    const double length = geometry::length_of(pieces_[piece].piece);
    const double left = std::clamp(ends_[piece] - way, 0.0, length);
    return {piece, parameter_after(pieces_[piece].piece, 0, 1, length, length - left)};
  }
  const auto after = std::ranges::upper_bound(nodes_, time, {}, &FeedPlanNode::time);
  if (after == nodes_.begin()) return {nodes_.front().piece, nodes_.front().t};
  if (after == nodes_.end()) return {nodes_.back().piece, nodes_.back().t};
  const FeedPlanNode& from = *(after - 1);
  const PlannedInterval interval(from, *after);
  const double t1 = after->piece == from.piece ? after->t : 1;
  const double way = interval.distance_after(time - from.time);
  return {from.piece,
          parameter_after(pieces_[from.piece].piece, from.t, t1, interval.length(), way)};
}

std::vector<PlannedPiece> PlannedMotion::times_of_pieces() const {
  std::vector<PlannedPiece> all(pieces_.size());
  if (s_curves_) {
    double start = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double end = i + 1 == all.size() ? duration_ : s_curves_->time_at(ends_[i]);
      const double slow = kHalf * pieces_[i].feed / kMinute;
      all[i] = {end - start, s_curves_->time_below(slow, start, end)};
      start = end;
    }
    return all;
  }
  for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
    const std::size_t piece = nodes_[i].piece;
    const double seconds = nodes_[i + 1].time - nodes_[i].time;
    const double way = nodes_[i + 1].distance - nodes_[i].distance;
    all[piece].seconds += seconds;
    if (way < kHalf * pieces_[piece].feed / kMinute * seconds) all[piece].slow_seconds += seconds;
  }
  return all;
}

std::vector<PlannedPiece> planned_chain(std::span<const TimedPiece> pieces, const Machine& machine,
                                        FeedPlanner planner, const gcode::PathControl& path,
                                        double density) {
  return PlannedMotion(pieces, machine, planner, path, density).times_of_pieces();
}

}  // namespace batten::postproc
