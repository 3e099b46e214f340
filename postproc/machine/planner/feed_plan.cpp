#include "postproc/machine/planner/feed_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>

#include "geometry/basic/rounding.h"
#include "postproc/machine/planner/feed_estimate_parts.h"
#include "postproc/machine/planner/feed_plan_envelope.h"
#include "postproc/machine/planner/feed_plan_grid.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_plan_problem.h"
#include "postproc/machine/planner/feed_plan_refine.h"
#include "postproc/machine/planner/feed_plan_straight.h"
#include "postproc/machine/planner/feed_search.h"

namespace batten::postproc {
namespace {

using geometry::Path;
using geometry::PathPiece;

// A straight move is not refined, so it has more nodes from the start.
constexpr double kStraightDensity = 2;

// A joint so many times slower than the envelope of the speeds on both sides is passed at its speed
// without acceleration. An acceleration there wins at most 0.15 times the square of the ratio of
// the speeds, as part of the time of a ramp; the envelope is 1.65 times what jerk allows between
// two rests: 1.6e-5.
constexpr double kSlowJoint = 160;

// The search ends where no limit is exceeded by more than this part: a fiftieth of what is allowed
// between the nodes.
constexpr double kEnoughKept = 1e-4;

// While the duals do not yet explain the gradient of the time, the search keeps this much distance
// from the limits: with less, it would creep along them.
constexpr double kPerUnexplained = 0.1;

// Paths whose allowed speed changes a hundredfold within a millimetre take up to 120 steps.
constexpr SearchRule kFirst = {.first_gap = 0.5,
                               .enough_gap = 1e-3,  // only says where nodes are missing
                               .enough_kept = kEnoughKept,
                               .least_slack = 0.2,
                               .least_gap_part = 0.08,
                               .per_unexplained = kPerUnexplained,
                               .most_steps = 150};

// The next start from it, near to what they find.
constexpr SearchRule kNext = {.first_gap = 0.02,
                              .enough_gap = 2e-5,
                              .enough_kept = kEnoughKept,
                              .least_slack = 0.02,
                              .least_gap_part = 0.08,
                              .per_unexplained = kPerUnexplained,
                              .most_steps = 150};

// Intervals are cut where the jerk switches, once, and where a limit is exceeded between the places
// that were asked, until it is so by less than half a percent; three times are rarely needed.
constexpr std::array<RefineRule, 4> kRefinements = {RefineRule{0.002, 0.5}, RefineRule{0.004, 2},
                                                    RefineRule{0.004, 2}, RefineRule{0.004, 2}};

// Parameters this close are the same: rounding of sums.
constexpr double kSameParameter = 1e-12;

// Distances of the ends of the pieces from the start of the first.
std::vector<double> ends_of_pieces(const Path& pieces) {
  std::vector<double> ends;
  double sum = 0;
  for (const PathPiece& piece : pieces) ends.push_back(sum += geometry::length_of(piece));
  return ends;
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
    bool slow_start = false;           // at the bound, without acceleration
    bool slow_end = false;
  };

  void plan_chain(const Chain& chain);
  [[nodiscard]] std::vector<std::size_t> slow_joints(const Chain& chain) const;
  void plan_part(const Chain& chain);
  void plan_straight(const Chain& chain);
  void plan_bent(const Chain& chain);
  void start_nodes(const Chain& chain, double speed, double acceleration);
  void add_node(std::size_t piece, double t, double length, double seconds, double speed,
                double acceleration);

  const KinematicPathLimits& limits_;
  const FeedPlanOptions& options_;
  Potential potential_;
  FeedPlan plan_;
};

FeedPlan Planner::run(std::span<const PathPiece> path, const PlanEnds& ends) {
  Chain chain;
  chain.bounds.push_back(ends.start_speed);
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!(geometry::length_of(path[i]) > geometry::kSamePlace)) continue;
    if (!chain.pieces.empty()) {
      const double bound = passing_speed(derivatives_by_length(chain.pieces.back(), 1),
                                         derivatives_by_length(path[i], 0), potential_, limits_);
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

// The joints, as numbers of the pieces after them, at which the chain falls into parts.
std::vector<std::size_t> Planner::slow_joints(const Chain& chain) const {
  PartChain envelope;
  for (std::size_t i = 0; i < chain.pieces.size(); ++i) {
    if (i > 0) envelope.parts.back().end_bound = chain.bounds[i];
    append_parts(chain.pieces[i], i, ends_of(chain.pieces[i]), potential_, limits_, envelope.parts);
  }
  envelope.find_potentials(chain.bounds.front(), chain.bounds.back(), potential_);
  std::vector<std::size_t> joints;
  for (const std::size_t part : envelope.slow_joints(kSlowJoint, potential_)) {
    joints.push_back(envelope.parts[part].piece);
  }
  return joints;
}

void Planner::plan_chain(const Chain& chain) {
  Chain part;
  part.bounds.push_back(chain.bounds.front());
  std::size_t next = 0;
  const auto add_until = [&](std::size_t end) {
    for (; next < end; ++next) {
      part.pieces.push_back(chain.pieces[next]);
      part.numbers.push_back(chain.numbers[next]);
      part.bounds.push_back(chain.bounds[next + 1]);
    }
  };
  if (chain.pieces.size() > 1) {
    for (const std::size_t joint : slow_joints(chain)) {
      add_until(joint);
      part.slow_end = true;
      plan_part(part);
      part = {};
      part.bounds.push_back(chain.bounds[joint]);
      part.slow_start = true;
    }
  }
  add_until(chain.pieces.size());
  plan_part(part);
}

void Planner::plan_part(const Chain& chain) {
  const bool slow_start = chain.slow_start || chain.bounds.front() == 0;
  const bool slow_end = chain.slow_end || chain.bounds.back() == 0;
  const bool straight = std::all_of(
      chain.pieces.begin(), chain.pieces.end(),
      [](const PathPiece& piece) { return std::holds_alternative<geometry::Line>(piece); });
  const bool runs_on = std::all_of(chain.bounds.begin() + 1, chain.bounds.end() - 1,
                                   [](double bound) { return std::isinf(bound); });
  if (!(slow_start && slow_end && straight && runs_on)) return plan_bent(chain);
  plan_straight(chain);
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

void Planner::plan_straight(const Chain& chain) {
  const geometry::Vector3 direction = geometry::direction_at(chain.pieces.front(), 0);
  const LimitsAlong along = limits_along(direction, limits_);
  const StraightRun run = straight_run(geometry::length_of(chain.pieces), chain.bounds.front(),
                                       chain.bounds.back(), along);
  // From rest the acceleration is there at once where the jerk has no limit.
  start_nodes(chain, run.from, run.from > 0 ? 0 : state_at(run, 0, along).acceleration);
  const std::vector<double> ends = ends_of_pieces(chain.pieces);
  std::size_t piece = 0;
  StraightState last;
  double last_time = 0;
  for (const double time : node_times(run, along, ends, kStraightDensity * options_.density)) {
    const StraightState state = state_at(run, time, along);
    const double from = piece > 0 ? ends[piece - 1] : 0;
    double t = (state.distance - from) / (ends[piece] - from);
    if (t > 1 - kSameParameter && piece + 1 < chain.pieces.size()) {
      ++piece;
      t = 0;
    }
    add_node(chain.numbers[piece], std::min(t, 1.0), state.distance - last.distance,
             time - last_time, state.speed, state.acceleration);
    last = state;
    last_time = time;
  }
}

SearchResult searched(const PlanProblem& problem, std::vector<double> start,
                      const SearchRule& rule) {
  SearchResult result = fastest(problem.search, std::move(start), rule);
  if (result.excess > kEnoughKept) slow_down(problem.search, result.unknowns);
  return result;
}

void Planner::plan_bent(const Chain& chain) {
  PlanGrid grid = make_plan_grid(chain.pieces, chain.bounds, limits_, options_.density);
  grid.slow_start = chain.slow_start;
  grid.slow_end = chain.slow_end;
  PlanProblem problem = make_plan_problem(chain.pieces, grid, limits_);
  std::vector<double> x = searched(problem, rough_start(problem, grid), kFirst).unknowns;
  const auto rounds = static_cast<std::size_t>(std::clamp(options_.refinements, 0, 4));
  for (const RefineRule& rule : std::span(kRefinements).first(rounds)) {
    PlanGrid finer_grid = grid;
    std::vector<double> start = x;
    const std::size_t cut = refine_plan(chain.pieces, limits_, problem, rule, finer_grid, start);
    const bool first = &rule == &kRefinements.front();
    if (cut == 0 && !first) break;
    PlanProblem finer = cut > 0 ? make_plan_problem(chain.pieces, finer_grid, limits_) : problem;
    const bool sound = raise_above_zero(finer, start);
    SearchResult found = sound ? searched(finer, std::move(start), kNext)
                               : searched(finer, rough_start(finer, finer_grid), kFirst);
    // The search may lose itself where the speed is next to nothing within the path.
    if (!std::isfinite(found.seconds)) break;
    grid = std::move(finer_grid);
    problem = std::move(finer);
    x = std::move(found.unknowns);
  }
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

namespace {

using geometry::PathPiece;

// One interval of the plan, by the distance and time from its start.
class Interval {
 public:
  Interval(const FeedPlanNode& from, const FeedPlanNode& to)
      : length_(to.distance - from.distance),
        duration_(to.time - from.time),
        window_{from.speed * from.speed, 2 * from.acceleration, to.speed * to.speed,
                2 * to.acceleration} {}

  [[nodiscard]] double length() const { return length_; }

  [[nodiscard]] PlanState at(double s) const {
    if (window_[0] == 0) return power(window_[2], window_[3] / window_[2], s);
    if (window_[2] == 0) {
      PlanState back = power(window_[0], -window_[1] / window_[0], length_ - s);
      back.p = -back.p;
      return back;
    }
    return state_in(window_.data(), length_, s);
  }

  // The distance `time` seconds after the start.
  [[nodiscard]] double distance_after(double time) const {
    if (window_[0] == 0)
      return length_ * std::pow(time / duration_, growth(window_[3], window_[2]));
    if (window_[2] == 0) {
      const double left = 1 - time / duration_;
      return length_ * (1 - std::pow(left, growth(-window_[1], window_[0])));
    }
    // Time by Simpson's rule in the plan, here by a finer one: stretched to the plan's.
    const double scale = seconds(length_) / duration_;
    double s = length_ * time / duration_;
    for (int i = 0; i < 20; ++i) {
      const double change = (time * scale - seconds(s)) * std::sqrt(at(s).q);
      s = std::clamp(s + change, 0.0, length_);
      if (std::abs(change) < 1e-13 * length_) break;
    }
    return s;
  }

 private:
  // q = q1 (s / length)^m with the slope at the far end that the plan has: m = p1 length / q1.
  [[nodiscard]] PlanState power(double q1, double slope, double s) const {
    const double m = slope * length_;
    if (!(s > 0)) return {0, m > 1.01 ? 0 : q1 / length_, 0};
    const double q = q1 * std::pow(s / length_, m);
    return {q, m * q / s, m * (m - 1) * q / (s * s)};
  }

  // Distance grows with this power of the time: 1 / (1 - m / 2).
  [[nodiscard]] double growth(double p1, double q1) const {
    return 1 / (1 - 0.5 * p1 * length_ / q1);
  }

  // From the start to s, by five-point Gauss-Legendre.
  [[nodiscard]] double seconds(double s) const {
    constexpr std::array<double, 5> kPlaces = {0.0469100770306680, 0.2307653449471585, 0.5,
                                               0.7692346550528415, 0.9530899229693320};
    constexpr std::array<double, 5> kWeights = {0.1184634425280945, 0.2393143352496832,
                                                0.2844444444444444, 0.2393143352496832,
                                                0.1184634425280945};
    double sum = 0;
    for (int i = 0; i < 5; ++i) sum += kWeights[i] / std::sqrt(at(s * kPlaces[i]).q);
    return s * sum;
  }

  double length_;
  double duration_;
  std::array<double, 4> window_;  // q and p at both ends
};

// The parameter `s` mm after t0, by Newton steps.
double parameter_after(const PathPiece& piece, double t0, double t1, double length, double s) {
  double t = t0 + (t1 - t0) * s / length;
  for (int i = 0; i < 6; ++i) {
    const double missing = s - length_between(piece, t0, t);
    if (std::abs(missing) < 1e-12 * length) break;
    t = std::clamp(t + missing * (t1 - t0) / length, t0, t1);
  }
  return t;
}

MotionSample sample_at(const PathPiece& piece, double t, const PlanState& at, double time) {
  const LengthDerivatives x = derivatives_by_length(piece, t);
  MotionSample sample;
  sample.time = time;
  sample.speed = std::sqrt(at.q);
  sample.tangential_acceleration = at.p / 2;
  sample.tangential_jerk = at.r / 2 * sample.speed;
  sample.position = geometry::point_at(piece, t);
  sample.velocity = x.first * sample.speed;
  sample.acceleration = x.second * at.q + x.first * (at.p / 2);
  sample.jerk = (x.third * at.q + x.second * (1.5 * at.p) + x.first * (0.5 * at.r)) * sample.speed;
  return sample;
}

}  // namespace

std::vector<MotionSample> sample_motion(std::span<const PathPiece> path, const FeedPlan& plan,
                                        double period) {
  if (!(period > 0)) {
    throw std::invalid_argument("sample_motion: period " + std::to_string(period) +
                                " s, expected above 0");
  }
  std::vector<MotionSample> samples;
  std::size_t k = 0;
  for (std::size_t i = 0; !plan.nodes.empty(); ++i) {
    const double time = static_cast<double>(i) * period;
    while (k + 1 < plan.nodes.size() && plan.nodes[k + 1].time <= time) ++k;
    if (k + 1 >= plan.nodes.size()) break;
    const FeedPlanNode& from = plan.nodes[k];
    const FeedPlanNode& to = plan.nodes[k + 1];
    const Interval interval(from, to);
    const double s = interval.distance_after(time - from.time);
    const double t1 = to.piece == from.piece ? to.t : 1;
    const double t = parameter_after(path[from.piece], from.t, t1, interval.length(), s);
    samples.push_back(sample_at(path[from.piece], t, interval.at(s), time));
  }
  return samples;
}

}  // namespace batten::postproc
