#include "postproc/machine/planner/feed_plan_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "postproc/machine/planner/feed_plan_problem.h"

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

PlanMatrix::PlanMatrix(const PlanProblem& problem)
    : start_slope_(problem.start.slope()),
      end_slope_(-problem.end.slope()),
      start_is_given_(problem.start_is_given),
      end_is_given_(problem.end_is_given),
      rows_(problem.unknowns()) {}

void PlanMatrix::set_zero() { std::fill(rows_.begin(), rows_.end(), rows_[0] = {}); }

void PlanMatrix::add(std::size_t interval, const PlanBlock& block) {
  int entry = 0;
  for (int a = 0; a < 4; ++a) {
    auto& row = rows_[2 * interval + a];
    for (int b = 0; b <= a; ++b) row[a - b] += block.lower[entry++];
  }
}

void PlanMatrix::fold_ends() {
  if (start_is_given_) {
    rows_[0] = rows_[1] = {1, 0, 0, 0};
    rows_[2][1] = rows_[2][2] = rows_[3][2] = rows_[3][3] = 0;
  }
  if (end_is_given_) rows_[rows_.size() - 1] = rows_[rows_.size() - 2] = {1, 0, 0, 0};
  if (start_slope_ != 0) {
    const double k = start_slope_;
    rows_[0][0] += 2 * k * rows_[1][1] + k * k * rows_[1][0];
    rows_[2][2] += k * rows_[2][1];
    rows_[3][3] += k * rows_[3][2];
    rows_[1] = {1, 0, 0, 0};
    rows_[2][1] = rows_[3][2] = 0;
  }
  if (end_slope_ != 0) {
    const double k = end_slope_;
    auto& p = rows_[rows_.size() - 1];
    auto& q = rows_[rows_.size() - 2];
    q[0] += 2 * k * p[1] + k * k * p[0];
    q[1] += k * p[2];
    q[2] += k * p[3];
    p = {1, 0, 0, 0};
  }
}

bool PlanMatrix::factor() {
  fold_ends();
  // Row by row; rows_[i][k] becomes L(i, i - k), and rows_[i][0] the inverse of D(i).
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    auto& row = rows_[i];
    const int before = static_cast<int>(std::min<std::size_t>(i, kBands));
    double diagonal = row[0];
    for (int k = before; k >= 1; --k) {
      // row[k] holds L(i, i - k) D(i - k) of the entries further left.
      for (int m = k + 1; m <= before; ++m) row[k] -= row[m] * rows_[i - k][m - k];
    }
    for (int k = 1; k <= before; ++k) {
      const double scaled = row[k] * rows_[i - k][0];
      diagonal -= scaled * row[k];
      row[k] = scaled;
    }
    if (!(diagonal > 0)) return false;
    row[0] = 1 / diagonal;
  }
  return true;
}

void PlanMatrix::solve(std::vector<double>& right) const {
  const std::size_t n = rows_.size();
  if (start_is_given_) right[0] = right[1] = 0;
  if (end_is_given_) right[n - 1] = right[n - 2] = 0;
  if (start_slope_ != 0) {
    right[0] += start_slope_ * right[1];
    right[1] = 0;
  }
  if (end_slope_ != 0) {
    right[n - 2] += end_slope_ * right[n - 1];
    right[n - 1] = 0;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const int before = static_cast<int>(std::min<std::size_t>(i, kBands));
    for (int k = 1; k <= before; ++k) right[i] -= rows_[i][k] * right[i - k];
  }
  for (std::size_t i = n; i-- > 0;) {
    right[i] *= rows_[i][0];
    for (int k = 1; k <= kBands && i + k < n; ++k) right[i] -= rows_[i + k][k] * right[i + k];
  }
  if (start_slope_ != 0) right[1] = start_slope_ * right[0];
  if (end_slope_ != 0) right[n - 1] = end_slope_ * right[n - 2];
}

// Where the search for a feed plan starts.

namespace {

// One pass takes the mean of each inner value and its neighbours. Nodes are spread by the time
// that the machine needs for a change, so this rounds off corners of the envelope, as limited jerk
// does, on each scale alike.
void smooth(std::vector<double>& values, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    double before = values.front();
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
      const double here = values[i];
      values[i] = 0.25 * before + 0.5 * here + 0.25 * values[i + 1];
      before = here;
    }
  }
}

// The slope at a node between two intervals that keeps a cubic monotone where the values are:
// their harmonic mean, or 0 at an extremum.
double monotone_slope(double before, double after) {
  return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

std::vector<double> unknowns_of(const PlanProblem& problem, const std::vector<double>& q) {
  const std::size_t n = problem.intervals();
  const auto rise = [&](std::size_t i) { return (q[i + 1] - q[i]) / problem.lengths[i]; };
  std::vector<double> x(problem.unknowns());
  for (std::size_t i = 0; i <= n; ++i) {
    x[2 * i] = q[i];
    x[2 * i + 1] = i > 0 && i < n ? monotone_slope(rise(i - 1), rise(i)) : 0;
  }
  // At ends that are not at rest without acceleration: given so, or a start as good as any.
  x[1] = problem.start.slope() * x[0];
  x[2 * n + 1] = -problem.end.slope() * x[2 * n];
  return x;
}

// The greatest factor on all unknowns that keeps the limits, at most 1.
double allowed_factor(const PlanProblem& problem, const std::vector<double>& x) {
  double factor = 1;
  for (std::size_t i = 0; i < problem.intervals(); ++i) {
    const auto states = states_at_places(x.data() + 2 * i, problem.lengths[i]);
    for (std::size_t p = 0; p < kPlanPlaces; ++p) {
      const PlanPlace& place = problem.places[kPlanPlaces * i + p];
      const LimitWindow state = {states[p].q, states[p].p, states[p].r};
      factor = std::min(factor, place.most / state[0]);
      for (std::size_t k = 0; k < place.rows; ++k) {
        const double size = std::abs(dot(problem.rows[place.first_row + k], state));
        if (!(size > 0)) continue;
        if (k < place.jerk_rows) {
          const double ratio = 1 / (std::sqrt(state[0]) * size);
          factor = std::min(factor, std::cbrt(ratio * ratio));
        } else {
          factor = std::min(factor, 1 / size);
        }
      }
    }
  }
  return factor;
}

}  // namespace

void slow_down(const PlanProblem& problem, std::vector<double>& x) {
  const double factor = allowed_factor(problem, x);
  const std::size_t first = problem.start_is_given ? 2 : 0;
  const std::size_t last = x.size() - (problem.end_is_given ? 2 : 0);
  for (std::size_t i = first; i < last; ++i) x[i] *= factor;
}

bool raise_above_zero(const PlanProblem& problem, std::vector<double>& x) {
  const std::size_t n = problem.intervals();
  const auto rise = [&](std::size_t i) { return (x[2 * i + 2] - x[2 * i]) / problem.lengths[i]; };
  const auto is_above = [&](std::size_t i) {
    const auto states = states_at_places(x.data() + 2 * i, problem.lengths[i]);
    return std::ranges::all_of(states, [](const PlanState& state) { return state.q > 0; });
  };
  const auto flatten = [&](std::size_t node) {
    if (node > 0 && node < n) x[2 * node + 1] = monotone_slope(rise(node - 1), rise(node));
  };
  // Flatter slopes may take the neighbours below 0, which are flattened in the next pass.
  constexpr int kPasses = 4;
  for (int pass = 0; pass < kPasses; ++pass) {
    bool above = true;
    for (std::size_t i = 0; i < n; ++i) {
      if (is_above(i)) continue;
      above = false;
      flatten(i);
      flatten(i + 1);
    }
    if (above) return true;
  }
  return false;
}

std::vector<double> rough_start(const PlanProblem& problem, const PlanGrid& grid) {
  const std::size_t first = problem.start.length > 0 ? 1 : 0;
  std::vector<double> logarithms;
  for (std::size_t i = 0; i <= problem.intervals(); ++i) {
    logarithms.push_back(2 * std::log(grid.speeds[first + i]));
  }
  constexpr int kPasses = 12;  // about two changes of the speed, at the usual density
  smooth(logarithms, kPasses);
  std::vector<double> q;
  q.reserve(logarithms.size());
  for (const double value : logarithms) q.push_back(std::exp(value));
  std::vector<double> x = unknowns_of(problem, q);
  if (problem.start_is_given) x[0] = grid.bounds.front() * grid.bounds.front();
  if (problem.end_is_given) x[x.size() - 2] = grid.bounds.back() * grid.bounds.back();
  return x;
}

}  // namespace batten::postproc
