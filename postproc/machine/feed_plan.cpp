#include "postproc/machine/feed_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>

#include "geometry/numeric.h"
#include "postproc/machine/feed_plan_envelope.h"
#include "postproc/machine/feed_plan_grid.h"
#include "postproc/machine/feed_plan_path.h"
#include "postproc/machine/feed_plan_problem.h"
#include "postproc/machine/feed_plan_refine.h"
#include "postproc/machine/feed_plan_solver.h"
#include "postproc/machine/feed_plan_straight.h"

namespace batten::postproc {
namespace {

using geometry::Path;
using geometry::PathPiece;

// A joint whose speed the machine reaches from rest within this way is a stop: the way is a
// thousandth of the last printed decimal.
constexpr double kStopWay = 1e-6;  // mm

// A straight move is not refined, so it has more nodes from the start.
constexpr double kStraightDensity = 2;

// The first solution only says where nodes are missing.
constexpr SearchRule kRough = {0.5, 1e-3};

// The next start from it, slowed down to be inside of the limits.
constexpr SearchRule kFine = {0.1, 2e-5};
constexpr double kWarmStart = 0.9;

// Intervals are cut where the jerk switches, once, and where a limit is exceeded between the places
// that were asked, until it is so by less than half a percent; three times are rarely needed.
constexpr std::array<RefineRule, 4> kRefinements = {RefineRule{0.002, 0.5}, RefineRule{0.004, 2},
                                                    RefineRule{0.004, 2}, RefineRule{0.004, 2}};

// Times and parameters this close, as part of the whole, are the same: rounding of sums.
constexpr double kSamePart = 1e-12;

// Distances of the ends of the pieces from the start of the first.
std::vector<double> ends_of_pieces(const Path& pieces) {
  std::vector<double> ends;
  double sum = 0;
  for (const PathPiece& piece : pieces) ends.push_back(sum += geometry::length_of(piece));
  return ends;
}

double time_at(const StraightMove& move, double distance) {
  double below = 0;
  double above = move.time();
  while (true) {
    const double middle = 0.5 * (below + above);
    if (middle <= below || middle >= above) return middle;
    (state_at(move, middle).distance < distance ? below : above) = middle;
  }
}

// Where the jerk changes, so many places between those, and the ends of the pieces. From rest to
// the end of the first phase, and in the last, the plan's intervals are exact; but after an end of
// a piece there they are not, and must be short against the time from rest.
std::vector<double> node_times(const StraightMove& move, const std::vector<double>& ends,
                               double density) {
  const bool jerk = move.jerk_time > 0;
  const double first = jerk ? move.jerk_time : move.acceleration_time;
  const double inner[] = {jerk ? move.acceleration_time : 0, jerk ? move.jerk_time : 0,
                          move.cruise_time, jerk ? move.jerk_time : 0,
                          jerk ? move.acceleration_time : 0};
  const int parts = std::max(1, static_cast<int>(std::ceil(density)));
  std::vector<double> times;
  double start = first;
  times.push_back(start);
  for (const double phase : inner) {
    const int count = phase > kSamePart * move.time() ? parts : 0;
    for (int i = 1; i <= count; ++i) times.push_back(start + phase * i / count);
    start += phase;
  }
  times.push_back(move.time());
  double nearest_start = first;
  double nearest_end = first;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double time = time_at(move, ends[i]);
    times.push_back(time);
    nearest_start = std::min(nearest_start, time);
    nearest_end = std::min(nearest_end, move.time() - time);
  }
  const double growth = 1 + 1 / density;
  for (double t = nearest_start * growth; t < first; t *= growth) times.push_back(t);
  for (double t = nearest_end * growth; t < first; t *= growth) times.push_back(move.time() - t);
  std::sort(times.begin(), times.end());
  return times;
}

class Planner {
 public:
  Planner(const KinematicPathLimits& limits, const FeedPlanOptions& options)
      : limits_(limits), options_(options), potential_(limits) {}

  FeedPlan run(std::span<const PathPiece> path, const PlanEnds& ends);

 private:
  // What the pieces between two stops are, and where they come from.
  struct Chain {
    Path pieces;
    std::vector<std::size_t> numbers;  // of the pieces in the path
    std::vector<double> bounds;        // mm/s at their ends
  };

  [[nodiscard]] double joint_bound(const PathPiece& before, const PathPiece& after) const;
  void plan_chain(const Chain& chain);
  void plan_straight(const Chain& chain, double length);
  void plan_bent(const Chain& chain);
  void start_nodes(const Chain& chain, double speed, double acceleration);
  void add_node(std::size_t piece, double t, double length, double seconds, double speed,
                double acceleration);

  const KinematicPathLimits& limits_;
  const FeedPlanOptions& options_;
  Potential potential_;
  FeedPlan plan_;
};

double Planner::joint_bound(const PathPiece& before, const PathPiece& after) const {
  const LengthDerivatives from = derivatives_by_length(before, 1);
  const LengthDerivatives to = derivatives_by_length(after, 0);
  const double speed = joint_speed(from, to, limits_);
  // Rounding of control points looks like a jump, but a tiny one.
  if (speed >= limits_along(from.first, limits_).speed) return KinematicPathLimits::kNone;
  const double slowest = potential_.speed(potential_.slope(from.first, limits_) * kStopWay);
  return speed < slowest ? 0 : speed;
}

FeedPlan Planner::run(std::span<const PathPiece> path, const PlanEnds& ends) {
  Chain chain;
  chain.bounds.push_back(ends.start_speed);
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!(geometry::length_of(path[i]) > geometry::kSamePlace)) continue;
    if (!chain.pieces.empty()) {
      const double bound = joint_bound(chain.pieces.back(), path[i]);
      chain.bounds.push_back(bound);
      if (bound == 0) {
        ++plan_.stops;
        plan_chain(chain);
        chain = {};
        chain.bounds.push_back(0);
      } else if (!std::isinf(bound)) {
        ++plan_.passed_jumps;
      }
    }
    chain.pieces.push_back(path[i]);
    chain.numbers.push_back(i);
  }
  if (!chain.pieces.empty()) {
    chain.bounds.push_back(ends.end_speed);
    plan_chain(chain);
  }
  return std::move(plan_);
}

void Planner::plan_chain(const Chain& chain) {
  const bool rest = chain.bounds.front() == 0 && chain.bounds.back() == 0;
  const bool straight = std::all_of(
      chain.pieces.begin(), chain.pieces.end(),
      [](const PathPiece& piece) { return std::holds_alternative<geometry::Line>(piece); });
  const bool runs_on = std::all_of(chain.bounds.begin() + 1, chain.bounds.end() - 1,
                                   [](double bound) { return std::isinf(bound); });
  if (rest && straight && runs_on) {
    plan_straight(chain, geometry::length_of(chain.pieces));
  } else {
    plan_bent(chain);
  }
}

void Planner::start_nodes(const Chain& chain, double speed, double acceleration) {
  if (plan_.nodes.empty()) plan_.nodes.emplace_back();
  FeedPlanNode& node = plan_.nodes.back();
  node.speed = speed;
  node.acceleration = acceleration;
  node.piece = chain.numbers.front();
  node.t = 0;
}

// A node `length` mm and some seconds after the last one.
void Planner::add_node(std::size_t piece, double t, double length, double seconds, double speed,
                       double acceleration) {
  FeedPlanNode node;
  node.distance = plan_.nodes.back().distance + length;
  node.speed = speed;
  node.acceleration = acceleration;
  plan_.time += seconds;
  node.time = plan_.time;
  node.piece = piece;
  node.t = t;
  plan_.nodes.push_back(node);
}

void Planner::plan_straight(const Chain& chain, double length) {
  const geometry::Vector3 direction = geometry::direction_at(chain.pieces.front(), 0);
  const StraightMove move = straight_move(length, limits_along(direction, limits_));
  start_nodes(chain, 0, state_at(move, 0).acceleration);
  const std::vector<double> ends = ends_of_pieces(chain.pieces);
  std::size_t piece = 0;
  StraightState last;
  double last_time = 0;
  for (const double time : node_times(move, ends, kStraightDensity * options_.density)) {
    const StraightState state = state_at(move, time);
    const double from = piece > 0 ? ends[piece - 1] : 0;
    double t = (state.distance - from) / (ends[piece] - from);
    if (t > 1 - kSamePart && piece + 1 < chain.pieces.size()) {
      ++piece;
      t = 0;
    }
    add_node(chain.numbers[piece], std::min(t, 1.0), state.distance - last.distance,
             time - last_time, state.speed, state.acceleration);
    last = state;
    last_time = time;
  }
}

void Planner::plan_bent(const Chain& chain) {
  PlanGrid grid = make_plan_grid(chain.pieces, chain.bounds, limits_, options_.density);
  PlanProblem problem = make_plan_problem(chain.pieces, grid, limits_);
  PlanSolution solution = fastest_plan(problem, feasible_start(problem, grid), kRough);
  const auto rounds = static_cast<std::size_t>(std::clamp(options_.refinements, 0, 4));
  for (const RefineRule& rule : std::span(kRefinements).first(rounds)) {
    std::vector<double> start = solution.x;
    const std::size_t cut = refine_plan(chain.pieces, limits_, problem, rule, grid, start);
    const bool first = &rule == &kRefinements.front();
    if (cut == 0 && !first) break;
    if (cut > 0) problem = make_plan_problem(chain.pieces, grid, limits_);
    slow_down(problem, kWarmStart, start);
    solution = fastest_plan(problem, std::move(start), kFine);
  }
  const auto& x = solution.x;
  const std::size_t n = problem.intervals();
  const auto& intervals = grid.intervals;
  const bool from_rest = problem.start.length > 0;
  // The place where interval k ends is where the next one starts.
  const auto add = [&](std::size_t k, double seconds, double q, double p) {
    const bool last = k + 1 == intervals.size();
    const GridInterval& at = last ? intervals[k] : intervals[k + 1];
    add_node(chain.numbers[at.piece], last ? at.t1 : at.t0, intervals[k].length, seconds,
             std::sqrt(q), p / 2);
  };
  std::size_t k = 0;
  if (from_rest) {
    start_nodes(chain, 0, problem.start.acceleration_at_rest(x[0]));
    add(k++, problem.start.time() / std::sqrt(x[0]), x[0], x[1]);
  } else {
    start_nodes(chain, std::sqrt(x[0]), x[1] / 2);
  }
  for (std::size_t i = 0; i < n; ++i) {
    add(k++, interval_seconds(problem.lengths[i], x.data() + 2 * i), x[2 * i + 2], x[2 * i + 3]);
  }
  if (problem.end.length > 0) {
    add(k, problem.end.time() / std::sqrt(x[2 * n]), 0,
        -2 * problem.end.acceleration_at_rest(x[2 * n]));
  }
}

void require_sound(const PlanEnds& ends) {
  if (ends.start_speed >= 0 && ends.end_speed >= 0) return;
  throw std::invalid_argument("plan_feed: end speeds " + std::to_string(ends.start_speed) +
                              " and " + std::to_string(ends.end_speed) + ", expected 0 or more");
}

}  // namespace

FeedPlan plan_feed(std::span<const PathPiece> path, const KinematicPathLimits& limits,
                   const PlanEnds& ends, const FeedPlanOptions& options) {
  require_sound(limits);
  require_sound(ends);
  return Planner(limits, options).run(path, ends);
}

FeedPlan plan_feed(const geometry::BsplineCurve& curve, const KinematicPathLimits& limits,
                   const PlanEnds& ends, const FeedPlanOptions& options) {
  return plan_feed(path_of(curve), limits, ends, options);
}

double planned_time(std::span<const PathPiece> path, const KinematicPathLimits& limits,
                    const PlanEnds& ends, const FeedPlanOptions& options) {
  return plan_feed(path, limits, ends, options).time;
}

double planned_time(const geometry::BsplineCurve& curve, const KinematicPathLimits& limits,
                    const PlanEnds& ends, const FeedPlanOptions& options) {
  return plan_feed(curve, limits, ends, options).time;
}

Path path_of(const geometry::BsplineCurve& curve) {
  const auto pieces = curve.bezier_pieces();
  return {pieces.begin(), pieces.end()};
}

}  // namespace batten::postproc
