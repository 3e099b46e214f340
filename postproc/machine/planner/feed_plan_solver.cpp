#include "postproc/machine/planner/feed_plan_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "postproc/machine/planner/feed_plan_matrix.h"
#include "postproc/machine/planner/feed_plan_rows.h"

namespace batten::postproc {
namespace {

// Share of the way to the nearest limit that a step goes.
constexpr double kToLimit = 0.98;

// q may fall to this part of itself in one step: the time, 1 / sqrt(q), is modelled by its second
// derivative only.
constexpr double kLeastPart = 0.2;

// Paths whose allowed speed changes a hundredfold within a millimetre take up to 120.
constexpr int kMostSteps = 150;

// While the duals do not yet explain the gradient of the time, the search keeps this much distance
// from the limits: with less, it would creep along them.
constexpr double kGapPerUnexplained = 0.1;

// The gap falls at most to this part of itself in one step.
constexpr double kLeastGapPart = 0.08;

// The search ends where no limit is exceeded by more than this part: a fiftieth of what is allowed
// between the nodes.
constexpr double kEnoughKept = 1e-4;

struct PlaceState {
  LimitWindow x{};  // q, p, r
  double root = 0;  // 1 / sqrt(q)
  LimitBound bound;
};

// q, p and r at a place as sums over the window of the interval.
struct PlaceWeights {
  PlanWindow q;
  PlanWindow p;
  PlanWindow r;
};

std::array<PlaceWeights, kPlanPlaces> place_weights(double h) {
  const double k = 6 / (h * h);
  return {PlaceWeights{{1, 0, 0, 0}, {0, 1, 0, 0}, {-k, -4 / h, k, -2 / h}},
          PlaceWeights{
              {0.5, h / 8, 0.5, -h / 8}, {-1.5 / h, -0.25, 1.5 / h, -0.25}, {0, -1 / h, 0, 1 / h}},
          PlaceWeights{{0, 0, 1, 0}, {0, 0, 0, 1}, {k, 2 / h, -k, 4 / h}}};
}

PlanWindow in_window(const PlaceWeights& weights, const LimitWindow& c) {
  PlanWindow sum;
  for (int i = 0; i < 4; ++i) {
    sum[i] = c[0] * weights.q[i] + c[1] * weights.p[i] + c[2] * weights.r[i];
  }
  return sum;
}

// H = W^T S W for the second derivatives S by (q, p, r).
void add_to_block(const PlaceWeights& weights, const LimitSums& sums, PlanBlock& block) {
  const auto& s = sums.square;
  int entry = 0;
  for (int a = 0; a < 4; ++a) {
    const double q = weights.q[a];
    const double p = weights.p[a];
    const double r = weights.r[a];
    const double by_q = s[0] * q + s[1] * p + s[3] * r;
    const double by_p = s[1] * q + s[2] * p + s[4] * r;
    const double by_r = s[3] * q + s[4] * p + s[5] * r;
    for (int b = 0; b <= a; ++b) {
      block.lower[entry++] += by_q * weights.q[b] + by_p * weights.p[b] + by_r * weights.r[b];
    }
  }
}

class Search {
 public:
  Search(const PlanProblem& problem, std::vector<double> start);
  PlanSolution run(const SearchRule& rule);

 private:
  void find_states();
  void start_slacks(const SearchRule& rule);
  void assemble(double primal, double dual);
  void find_step(double target);
  [[nodiscard]] double unexplained() const;
  [[nodiscard]] std::array<double, kPlanPlaces> time_weights(std::size_t interval) const;
  [[nodiscard]] std::span<LimitRow> rows_of(const PlanPlace& place) {
    return std::span(rows_).subspan(place.first_row, place.rows);
  }

  const PlanProblem& problem_;
  std::vector<double> x_;
  std::vector<LimitRow> rows_;
  std::vector<PlaceState> places_;
  std::vector<double> base_;  // the right side, then the step
  std::vector<double> center_;
  std::vector<double> unexplained_;
  PlanMatrix matrix_;
  LimitTally tally_;
  double primal_share_ = 1;
  double dual_share_ = 1;
};

Search::Search(const PlanProblem& problem, std::vector<double> start)
    : problem_(problem),
      x_(std::move(start)),
      rows_(problem.rows.size()),
      places_(problem.places.size()),
      base_(problem.unknowns()),
      center_(problem.unknowns()),
      unexplained_(problem.unknowns()),
      matrix_(problem) {
  tally_.sides = 2 * static_cast<double>(rows_.size());
  for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k].c = problem.rows[k];
  for (std::size_t k = 0; k < places_.size(); ++k) {
    places_[k].bound.scale = 1 / problem.places[k].most;
    tally_.sides += places_[k].bound.is_there() ? 1 : 0;
  }
}

void Search::find_states() {
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    const auto states = states_at_places(x_.data() + 2 * i, problem_.lengths[i]);
    for (std::size_t p = 0; p < kPlanPlaces; ++p) {
      PlaceState& at = places_[kPlanPlaces * i + p];
      at.x = {states[p].q, states[p].p, states[p].r};
      at.root = 1 / std::sqrt(states[p].q);
    }
  }
}

void Search::start_slacks(const SearchRule& rule) {
  find_states();
  const double product = rule.first_gap * planned_seconds(problem_, x_) / tally_.sides;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const PlanPlace& place = problem_.places[k];
    PlaceState& at = places_[k];
    start_bound(at.bound, at.x[0], rule.least_slack, product);
    for (std::size_t i = 0; i < place.rows; ++i) {
      start_row(rows_[place.first_row + i], at.x, i < place.jerk_rows ? at.root : 1,
                rule.least_slack, product);
    }
  }
}

// mm, of 1 / sqrt(q) at the places: Simpson's rule, and what an end at rest adds.
std::array<double, kPlanPlaces> Search::time_weights(std::size_t interval) const {
  const double h = problem_.lengths[interval];
  std::array<double, kPlanPlaces> weights = {h / 6, 4 * h / 6, h / 6};
  if (interval == 0) weights[0] += problem_.start.time();
  if (interval + 1 == problem_.intervals()) weights[2] += problem_.end.time();
  return weights;
}

// Goes these shares of the last step and makes the system of the next.
void Search::assemble(double primal, double dual) {
  matrix_.set_zero();
  std::fill(base_.begin(), base_.end(), 0);
  std::fill(center_.begin(), center_.end(), 0);
  std::fill(unexplained_.begin(), unexplained_.end(), 0);
  tally_.start();
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    const auto weights = place_weights(problem_.lengths[i]);
    const auto time = time_weights(i);
    PlanBlock block;
    for (std::size_t p = 0; p < kPlanPlaces; ++p) {
      const PlanPlace& place = problem_.places[kPlanPlaces * i + p];
      PlaceState& at = places_[kPlanPlaces * i + p];
      LimitSums sums;
      sums.add_time(time[p], at.root);
      add_bound(at.bound, at.x[0], primal, dual, sums, tally_);
      add_rows<true>(rows_of(place), place.jerk_rows, at.x, at.root, primal, dual, sums, tally_);
      add_to_block(weights[p], sums, block);
      const PlanWindow base = in_window(weights[p], sums.base);
      const PlanWindow center = in_window(weights[p], sums.center);
      const PlanWindow left = in_window(weights[p], sums.unexplained);
      for (int a = 0; a < 4; ++a) {
        base_[2 * i + a] += base[a];
        center_[2 * i + a] += center[a];
        unexplained_[2 * i + a] += left[a];
      }
    }
    matrix_.add(i, block);
  }
}

// Seconds that the time would change by, to first order and beyond what the duals explain, if each
// q were 0 instead, or twice as much.
double Search::unexplained() const {
  double sum = 0;
  const std::size_t first = problem_.start_is_given ? 2 : 0;
  const std::size_t last = x_.size() - (problem_.end_is_given ? 2 : 0);
  for (std::size_t i = first; i < last; i += 2) {
    sum += std::abs(unexplained_[i] * x_[i] + unexplained_[i + 1] * x_[i + 1]);
  }
  return sum;
}

// The steps of slacks and duals that belong to the step of the unknowns, and how far they may go.
void Search::find_step(double target) {
  LimitReach reach(kToLimit);
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    const auto changes = states_at_places(base_.data() + 2 * i, problem_.lengths[i]);
    for (std::size_t p = 0; p < kPlanPlaces; ++p) {
      const PlanPlace& place = problem_.places[kPlanPlaces * i + p];
      PlaceState& at = places_[kPlanPlaces * i + p];
      const LimitWindow change = {changes[p].q, changes[p].p, changes[p].r};
      reach.primal = std::max(reach.primal, -kToLimit * change[0] / ((1 - kLeastPart) * at.x[0]));
      step_bound(at.bound, change[0], target, reach);
      step_rows(rows_of(place), place.jerk_rows, change, at.root, target, reach);
    }
  }
  primal_share_ = kToLimit / reach.greatest_primal();
  dual_share_ = kToLimit / reach.greatest_dual();
}

PlanSolution Search::run(const SearchRule& rule) {
  PlanSolution solution;
  start_slacks(rule);
  assemble(0, 0);
  double share = 0.5;
  for (int step = 1; step <= kMostSteps; ++step) {
    solution.iterations = step;
    const double gap = tally_.whole_gap();
    const double part = std::max(kLeastGapPart, 1 - share);
    const double needed = std::min(gap, kGapPerUnexplained * unexplained());
    const double target = std::max(part * gap, needed) / tally_.sides;
    for (std::size_t i = 0; i < base_.size(); ++i) base_[i] += target * center_[i];
    if (!matrix_.factor()) break;
    matrix_.solve(base_);
    find_step(target);
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += primal_share_ * base_[i];
    find_states();
    assemble(primal_share_, dual_share_);
    share = std::min(primal_share_, dual_share_);
    const bool enough = tally_.whole_gap() < rule.enough_gap * planned_seconds(problem_, x_);
    if (enough && tally_.excess < kEnoughKept && share > 0.5) break;
  }
  if (tally_.excess > kEnoughKept) slow_down(problem_, x_);
  solution.gap = tally_.whole_gap();
  solution.seconds = planned_seconds(problem_, x_);
  solution.x = std::move(x_);
  return solution;
}

}  // namespace

PlanSolution fastest_plan(const PlanProblem& problem, std::vector<double> start,
                          const SearchRule& rule) {
  return Search(problem, std::move(start)).run(rule);
}

}  // namespace batten::postproc
