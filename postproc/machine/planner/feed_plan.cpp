#include "postproc/machine/planner/feed_plan.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "postproc/machine/planner/bent_section.h"
#include "postproc/machine/planner/feed_plan_straight.h"
#include "postproc/machine/planner/feed_sections.h"
#include "postproc/machine/planner/speed_cubic.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

// A straight move is not refined, so it has more nodes from the start.
constexpr double kStraightDensity = 2;

// Parameters this close are the same: rounding of sums.
constexpr double kSameParameter = 1e-12;

class Planner {
 public:
  Planner(std::span<const PathPiece> path, LimitsOfPieces limits, double density)
      : path_(path), limits_(limits), density_(density) {}

  FeedPlan run(const PlanEnds& ends) {
    const PassedJoints joints =
        for_each_section(path_, limits_, ends, [this](const PlannedSection& section) {
          section.is_straight() ? plan_straight(section) : plan_bent(section);
        });
    plan_.stops = joints.stops;
    plan_.passed_jumps = joints.jumps;
    return std::move(plan_);
  }

 private:
  void plan_straight(const PlannedSection& section) {
    const StraightRun run = straight_run(section, path_, limits_);
    // From rest the acceleration is there at once where the jerk has no limit.
    start_nodes(section, run.from, run.from > 0 ? 0 : run.state_at(0).acceleration);
    std::vector<double> ends;
    double sum = 0;
    for (const FeedPart& part : section.parts) ends.push_back(sum += part.length);
    std::size_t part = 0;
    StraightState last;
    double last_time = 0;
    for (const double time :
         node_times(run, std::span(ends).first(ends.size() - 1), kStraightDensity * density_)) {
      const StraightState state = run.state_at(time);
      const double length = section.parts[part].length;
      double t = 1 - (ends[part] - state.distance) / length;
      if (t > 1 - kSameParameter && part + 1 < ends.size()) {
        ++part;
        t = 0;
      }
      add_node(section.parts[part].piece, std::clamp(t, 0.0, 1.0), state.distance - last.distance,
               time - last_time, state.speed, state.acceleration);
      last = state;
      last_time = time;
    }
  }

  void plan_bent(const PlannedSection& section) {
    BentSection bent(path_, section, limits_, density_);
    bent.solve();
    const std::vector<double>& x = bent.x;
    const auto& intervals = bent.intervals;
    const std::size_t n = intervals.size();
    // Interval k ends where the next one starts.
    const auto add = [&](double length, std::size_t next, double seconds, double q, double p) {
      const FeedInterval& last = bent.end.is_there() ? bent.last : intervals.back();
      const bool is_end = next > n || (next == n && !bent.end.is_there());
      const FeedInterval& at = next < n ? intervals[next] : last;
      add_node(at.piece, is_end ? at.t1 : at.t0, length, seconds, std::sqrt(q), p / 2);
    };
    if (bent.start.is_there()) {
      start_nodes(section, 0, bent.start.acceleration_at_rest(x[0]));
      add(bent.start.length, 0, bent.start.time() / std::sqrt(x[0]), x[0], x[1]);
    } else {
      start_nodes(section, std::sqrt(x[0]), x[1] / 2);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double length = intervals[i].length;
      add(length, i + 1, interval_seconds(length, x.data() + 2 * i), x[2 * i + 2], x[2 * i + 3]);
    }
    if (bent.end.is_there()) {
      const double q = x[2 * n];
      add(bent.end.length, n + 1, bent.end.time() / std::sqrt(q), 0,
          -2 * bent.end.acceleration_at_rest(q));
    }
  }

  void start_nodes(const PlannedSection& section, double speed, double acceleration) {
    if (plan_.nodes.empty()) plan_.nodes.emplace_back();
    FeedPlanNode& node = plan_.nodes.back();
    node.speed = speed;
    node.acceleration = acceleration;
    node.piece = section.parts.front().piece;
    node.t = 0;
  }

  // A node `length` mm and some seconds after the last one.
  void add_node(std::size_t piece, double t, double length, double seconds, double speed,
                double acceleration) {
    plan_.time += seconds;
    plan_.nodes.push_back(
        {plan_.nodes.back().distance + length, speed, acceleration, plan_.time, piece, t});
  }

  std::span<const PathPiece> path_;
  LimitsOfPieces limits_;
  double density_;
  FeedPlan plan_;
};

}  // namespace

FeedPlan plan_feed(std::span<const PathPiece> path, const KinematicPathLimits& limits,
                   const PlanEnds& ends, double density) {
  return plan_feed(path, LimitsOfPieces(&limits, 1), ends, density);
}

FeedPlan plan_feed(std::span<const PathPiece> path, LimitsOfPieces limits, const PlanEnds& ends,
                   double density) {
  return Planner(path, limits, density).run(ends);
}

std::vector<double> plan_nodes(std::span<const PathPiece> path, const KinematicPathLimits& limits,
                               double density) {
  std::vector<double> nodes(path.size(), 0);
  const LimitsOfPieces same(&limits, 1);
  for_each_section(path, same, {}, [&](const PlannedSection& section) {
    if (section.is_straight()) {
      ++nodes[section.parts.front().piece];
      return;
    }
    for (const FeedInterval& at : intervals_of(section, path, same, grid_of(density))) {
      ++nodes[at.piece];
    }
  });
  return nodes;
}

}  // namespace batten::postproc
