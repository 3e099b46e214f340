// The planned time of a path, quickly: unknowns for q = speed^2 as a quadratic spline of the way,
// on few nodes. q and dq/ds run on, d2q/ds2 is constant over each interval. The unknowns are its
// Bezier ordinates: q at the start, one in the middle of each interval, and q at the end.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "postproc/machine/planner/feed_plan.h"
#include "postproc/machine/planner/feed_plan_straight.h"
#include "postproc/machine/planner/feed_search.h"
#include "postproc/machine/planner/feed_sections.h"

namespace batten::postproc {
namespace {

// At most 1.6e-3 of a ramp's time is lost at a joint that counts as slow.
constexpr double kSlowEstimateJoint = 16;

// Half of the first jerk phase by time is an eighth of its way, and at its end, at half the speed,
// the potential is 0.35 of its greatest.
constexpr GridRule kEstimateGrid = {
    .density = 3, .nodes_per_bend = 1, .rest_share = 0.35 / 8, .joins_parts = true};

// A rough start costs steps; more of them do not make an estimate better.
constexpr SearchRule kQuick = {.first_gap = 0.3,
                               .enough_gap = 3e-3,
                               .enough_kept = 0.02,
                               .least_slack = 0.5,
                               .least_gap_part = 0.1,
                               .per_unexplained = 0,
                               .most_steps = 40};

// The start is this part of the envelope of speed^2.
constexpr double kStartPart = 0.8;

// The middles of the intervals come first, then the nodes between them.
class EstimateProblem {
 public:
  EstimateProblem(std::span<const geometry::PathPiece> path, const PlannedSection& section,
                  const KinematicPathLimits& limits)
      : limits_(limits), intervals_(intervals_of(section, path, limits, kEstimateGrid)) {
    RestMotion start;
    RestMotion end;
    if (section.start.is_rest()) {
      start = rest_motion(path[intervals_.front().piece], intervals_.front(), limits);
      intervals_.erase(intervals_.begin());
    }
    if (section.end.is_rest()) {
      end = rest_motion(path[intervals_.back().piece], intervals_.back(), limits);
      intervals_.pop_back();
    }
    const std::size_t n = intervals_.size();
    problem_.unknowns = n + 2;
    for (std::size_t k = 0; k < n; ++k) add_middle(path, k);
    for (std::size_t k = 0; k <= n; ++k) add_node(k);
    const auto factor = [&](const RestMotion& rest, const FeedInterval& outer) {
      return 1 + rest.slope() * outer.length / 2;
    };
    set_end(section.start, start, {0, 1, factor(start, intervals_.front()), 1}, problem_.places[n],
            problem_);
    // A single interval has one ordinate inside: the start's equation is the one that counts.
    const bool is_given = n == 1 && !problem_.ties.empty();
    set_end(section.end, end, {n + 1, is_given ? n + 1 : n, factor(end, intervals_.back()), 1},
            problem_.places.back(), problem_);
  }

  [[nodiscard]] double seconds() const { return fastest(problem_, guess(), kQuick).seconds; }

 private:
  // Shares of the ordinates beside a node in its q.
  struct NodeShares {
    double before;
    double after;
  };

  [[nodiscard]] double length(std::size_t interval) const {  // 0 beyond the ends
    return interval < intervals_.size() ? intervals_[interval].length : 0;
  }

  [[nodiscard]] NodeShares shares(std::size_t node) const {
    const double before = length(node - 1);
    const double after = length(node);
    return {after / (before + after), before / (before + after)};
  }

  // q at the ends, and so q, p and r in the middle, as sums over the ordinates k, k + 1, k + 2.
  void add_middle(std::span<const geometry::PathPiece> path, std::size_t k) {
    const FeedInterval& interval = intervals_[k];
    const double h = interval.length;
    const Eigen::RowVector3d q0(shares(k).before, shares(k).after, 0);
    const Eigen::RowVector3d q1(0, shares(k + 1).before, shares(k + 1).after);
    const Eigen::RowVector3d inner(0, 1, 0);
    SearchPlace place;
    place.first = k;
    place.width = 3;
    place.sums.row(0).head<3>() = 0.25 * (q0 + q1) + 0.5 * inner;
    place.sums.row(1).head<3>() = (q1 - q0) / h;
    place.sums.row(2).head<3>() = 2 / (h * h) * (q0 + q1 - 2 * inner);
    place.time = 4 * h / 6;
    const LengthDerivatives x =
        derivatives_by_length(path[interval.piece], 0.5 * (interval.t0 + interval.t1));
    problem_.add_jerk_rows(x, limits_, place);
    problem_.add_other_limits(x, limits_, place);
    place.lower_speed(interval.inner_bound);
    problem_.places.push_back(place);
  }

  void add_node(std::size_t k) {
    SearchPlace place;
    place.first = k;
    place.width = 2;
    place.sums.row(0).head<2>() << shares(k).before, shares(k).after;
    place.time = (length(k - 1) + length(k)) / 6;
    if (k > 0) place.lower_speed(intervals_[k - 1].end_bound);
    problem_.places.push_back(place);
  }

  [[nodiscard]] std::vector<double> guess() const {
    std::vector<double> u;
    for (std::size_t k = 0; k < intervals_.size(); ++k) {
      const double v = intervals_[k].speed;
      u.push_back(kStartPart * std::min(v * v, problem_.places[k].most));
    }
    smooth(u, 3);
    const auto& places = problem_.places;
    u.insert(u.begin(), std::min(u.front(), 0.9 * places[intervals_.size()].most));
    u.push_back(std::min(u.back(), 0.9 * places.back().most));
    problem_.tie(u);
    return u;
  }

  const KinematicPathLimits& limits_;
  std::vector<FeedInterval> intervals_;
  SearchProblem problem_;
};

}  // namespace

double estimated_time(std::span<const geometry::PathPiece> path, const KinematicPathLimits& limits,
                      const PlanEnds& ends) {
  double time = 0;
  for_each_section(path, limits, ends, kSlowEstimateJoint, [&](const PlannedSection& section) {
    time += section.is_straight() ? straight_run(section, path, limits).time
                                  : EstimateProblem(path, section, limits).seconds();
  });
  return time;
}

}  // namespace batten::postproc
