// The search for the fastest motion along a path: an optimisation over unknowns whose sums are
// q = (ds/dt)^2 and its first two derivatives p and r by the way, at positions where limits hold.
//
// A primal-dual interior-point method from any unknowns, also such that exceed limits, with a slack
// of its own for each side of each limit. All is convex but the jerk, |c.x| <= 1 / sqrt(q): the
// tangent of its right side at the present q replaces it, anew in every step. Each step is one
// symmetric system with three sub-diagonals: linear cost.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

struct SearchPlace {
  // q, p and r (rows) as sums over four neighbouring unknowns, `first` and on.
  Eigen::Matrix<double, 3, 4> sums = Eigen::Matrix<double, 3, 4>::Zero();
  std::size_t first = 0;

  double time = 0;                           // mm, of 1 / sqrt(q) in the time
  double most = KinematicPathLimits::kNone;  // of q, mm^2/s^2

  // Of the problem's rows: those of the jerk (<= 1 / sqrt(q)) first, then others (<= 1).
  std::size_t first_row = 0;
  std::size_t jerk_rows = 0;
  std::size_t rows = 0;

  void lower_speed(double speed) { most = std::min(most, speed * speed); }
  [[nodiscard]] Eigen::Vector3d state_of(const std::vector<double>& unknowns) const;  // q, p, r
};

// The unknown `tied` is factor * `free`, which is beside it, + offset. With a factor of 0 it is
// given.
struct UnknownTie {
  std::size_t tied = 0;
  std::size_t free = 0;
  double factor = 0;
  double offset = 0;
};

struct SearchProblem {
  std::size_t unknowns = 0;
  std::vector<SearchPlace> places;
  std::vector<Eigen::Vector3d> rows;  // |c.(q, p, r)| is bounded; those of one place side by side
  std::vector<UnknownTie> ties;

  // The limits where the path is `x` become those of `place`: the jerk first.
  void add_jerk_rows(const LengthDerivatives& x, const KinematicPathLimits& limits,
                     SearchPlace& place);
  void add_other_limits(const LengthDerivatives& x, const KinematicPathLimits& limits,
                        SearchPlace& place);

  // Puts unknowns where the ties have them.
  void tie(std::vector<double>& x) const;

 private:
  void add_row(double q, double p, double r, double limit, SearchPlace& place);
};

struct SearchRule {
  double first_gap = 0.5;      // products of limits and duals at the start, as part of the time
  double enough_gap = 2e-5;    // it ends where the duals promise no more than this part,
  double enough_kept = 1e-4;   // and no limit is exceeded by more than this part of it
  double least_slack = 0.2;    // at the start, as part of the limit: more for a rough start
  double least_gap_part = 0;   // the gap falls at most to this part of itself in one step
  double per_unexplained = 0;  // of the gradient that the duals leave: the least gap
  int most_steps = 0;
};

struct SearchResult {
  std::vector<double> unknowns;
  double seconds = 0;
  double excess = 0;  // the greatest part of its limit that something is above it
};

// The best found where the search does not come to an end.
[[nodiscard]] SearchResult fastest(const SearchProblem& problem, std::vector<double> start,
                                   const SearchRule& rule);

// Slows down as a whole until all limits are kept. Any q that keeps all limits keeps them times a
// factor below 1.
void slow_down(const SearchProblem& problem, std::vector<double>& unknowns);

// Values at neighbouring nodes, smoothed by their logarithms: a pass takes the mean of each inner
// one and its neighbours. Nodes are spread by the time that a change of speed takes, so this rounds
// off corners of an envelope as limited jerk does, on each scale alike.
void smooth(std::vector<double>& values, int passes);

}  // namespace batten::postproc
