#include "postproc/machine/planner/feed_estimate_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "postproc/machine/planner/feed_estimate_problem.h"
#include "postproc/machine/planner/feed_plan_problem.h"

namespace batten::postproc {
namespace {

// The search ends where the duals promise no more than this part of the time, and no limit is
// exceeded by more than that part of it.
constexpr double kEnoughGap = 3e-3;
constexpr double kEnoughKept = 0.02;

// The gap falls at most to this part of itself in one step.
constexpr double kLeastGapPart = 0.1;

// A rough start costs steps; more of them do not make an estimate better.
constexpr int kMostSteps = 40;

// The start is this part of the envelope of speed^2.
constexpr double kStartPart = 0.8;

constexpr double kFirstGap = 0.3;   // of the time
constexpr double kToLimit = 0.98;   // of the way to the nearest limit that a step goes
constexpr double kLeastPart = 0.2;  // of q that is left after one step

// Slacks at the start: no less than this part of the limit.
constexpr double kLeastSlack = 0.5;

// An equation between unknowns is a spring this much stiffer than all else at that place.
constexpr double kStiff = 1e8;

double dot(const LimitWindow& c, const double* u) {
  return c[0] * u[0] + c[1] * u[1] + c[2] * u[2];
}

struct CellState {
  LimitWindow x{};  // q, p, r in the middle
  double root = 0;  // 1 / sqrt(q)
  LimitBound bound;
};

struct KnotState {
  double q = 0;
  double root = 0;
  LimitBound bound;
};

class QuickSearch {
 public:
  explicit QuickSearch(const EstimateProblem& problem);
  EstimateSolution run(const EstimateStretch& stretch);

 private:
  void guess(const EstimateStretch& stretch);
  void start_slacks();
  [[nodiscard]] double seconds_now() const;
  void find_states();
  [[nodiscard]] std::span<LimitRow> rows_of(const EstimateCell& cell) {
    return std::span(rows_).subspan(cell.first_row, cell.rows);
  }

  void assemble(double primal, double dual);
  void add_cell(std::size_t k, const LimitSums& sums);
  void add_knot(std::size_t k, const LimitSums& sums);
  void add_arc(std::size_t unknown, const EstimateTie& tie);
  void tie(std::size_t free, std::size_t tied, const EstimateTie& by);
  void pin(std::size_t unknown, double value);
  void tie_ends();
  void find_step(double target);

  const EstimateProblem& problem_;
  std::vector<CellState> cells_;
  std::vector<KnotState> knots_;
  std::vector<LimitRow> rows_;
  std::vector<double> u_;     // the ordinates
  std::vector<double> base_;  // the right side, then the step
  std::vector<double> center_;
  EstimateMatrix matrix_;
  LimitTally tally_;
  double primal_share_ = 1;  // of the step
  double dual_share_ = 1;
};

QuickSearch::QuickSearch(const EstimateProblem& problem)
    : problem_(problem),
      cells_(problem.cells.size()),
      knots_(problem.knots.size()),
      rows_(problem.rows.size()),
      u_(problem.cells.size() + 2),
      base_(u_.size()),
      center_(u_.size()),
      matrix_(u_.size()) {
  tally_.sides = 2 * static_cast<double>(rows_.size());
  for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k].c = problem.rows[k];
  for (std::size_t k = 0; k < cells_.size(); ++k) cells_[k].bound.scale = 1 / problem.cells[k].most;
  for (std::size_t k = 0; k < knots_.size(); ++k) knots_[k].bound.scale = 1 / problem.knots[k].most;
  for (const CellState& cell : cells_) tally_.sides += cell.bound.is_there() ? 1 : 0;
  for (const KnotState& knot : knots_) tally_.sides += knot.bound.is_there() ? 1 : 0;
}

void QuickSearch::guess(const EstimateStretch& stretch) {
  const std::size_t n = cells_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const double v = stretch.intervals[k].speed;
    u_[k + 1] = kStartPart * std::min(v * v, problem_.cells[k].most);
  }
  // Limited jerk rounds the envelope off; nodes are spread by the time that it takes.
  constexpr int kPasses = 3;
  for (int pass = 0; pass < kPasses; ++pass) {
    double before = u_[1];
    for (std::size_t k = 2; k + 1 <= n; ++k) {
      const double here = u_[k];
      u_[k] = std::sqrt(here * std::sqrt(before * u_[k + 1]));
      before = here;
    }
  }
  u_[0] = problem_.start.pins ? problem_.start.value
                              : std::min(u_[1], 0.9 * problem_.knots.front().most);
  u_[n + 1] =
      problem_.end.pins ? problem_.end.value : std::min(u_[n], 0.9 * problem_.knots.back().most);
  if (problem_.start.pins) u_[1] = problem_.start.next;
  if (problem_.end.pins && n > 1) u_[n] = problem_.end.next;
  if (problem_.start.ties) u_[1] = problem_.start.factor * u_[0] + problem_.start.offset;
  if (problem_.end.ties && n > 1) u_[n] = problem_.end.factor * u_[n + 1] + problem_.end.offset;
}

double QuickSearch::seconds_now() const {
  double time = 0;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    time += 4 * problem_.cells[k].length / 6 * cells_[k].root;
  }
  for (std::size_t k = 0; k < knots_.size(); ++k) time += problem_.knots[k].weight * knots_[k].root;
  return time;
}

void QuickSearch::find_states() {
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const EstimateCell& cell = problem_.cells[k];
    const double* u = u_.data() + k;
    cells_[k].x = {dot(cell.q_of, u), dot(cell.p_of, u), dot(cell.r_of, u)};
    cells_[k].root = 1 / std::sqrt(cells_[k].x[0]);
  }
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const EstimateKnot& knot = problem_.knots[k];
    knots_[k].q = knot.before * u_[k] + knot.after * u_[k + 1];
    knots_[k].root = 1 / std::sqrt(knots_[k].q);
  }
}

void QuickSearch::start_slacks() {
  find_states();
  const double product = kFirstGap * seconds_now() / tally_.sides;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const EstimateCell& cell = problem_.cells[k];
    CellState& at = cells_[k];
    start_bound(at.bound, at.x[0], kLeastSlack, product);
    for (std::size_t i = 0; i < cell.rows; ++i) {
      start_row(rows_[cell.first_row + i], at.x, i < cell.jerk_rows ? at.root : 1, kLeastSlack,
                product);
    }
  }
  for (KnotState& knot : knots_) start_bound(knot.bound, knot.q, kLeastSlack, product);
}

void QuickSearch::add_cell(std::size_t k, const LimitSums& sums) {
  const EstimateCell& cell = problem_.cells[k];
  const auto& s = sums.square;
  for (int a = 0; a < 3; ++a) {
    const double q = cell.q_of[a];
    const double p = cell.p_of[a];
    const double r = cell.r_of[a];
    const double by_q = s[0] * q + s[1] * p + s[3] * r;
    const double by_p = s[1] * q + s[2] * p + s[4] * r;
    const double by_r = s[3] * q + s[4] * p + s[5] * r;
    for (int b = 0; b <= a; ++b) {
      matrix_.at(k + a, a - b) += by_q * cell.q_of[b] + by_p * cell.p_of[b] + by_r * cell.r_of[b];
    }
    base_[k + a] += sums.base[0] * q + sums.base[1] * p + sums.base[2] * r;
    center_[k + a] += sums.center[0] * q + sums.center[1] * p + sums.center[2] * r;
  }
}

void QuickSearch::add_knot(std::size_t k, const LimitSums& sums) {
  const EstimateKnot& knot = problem_.knots[k];
  matrix_.at(k, 0) += sums.square[0] * knot.before * knot.before;
  matrix_.at(k + 1, 0) += sums.square[0] * knot.after * knot.after;
  matrix_.at(k + 1, 1) += sums.square[0] * knot.before * knot.after;
  base_[k] += sums.base[0] * knot.before;
  base_[k + 1] += sums.base[0] * knot.after;
  center_[k] += sums.center[0] * knot.before;
  center_[k + 1] += sums.center[0] * knot.after;
}

// The time length / (speed + sqrt(q)) of an arc.
void QuickSearch::add_arc(std::size_t unknown, const EstimateTie& tie) {
  if (!(tie.arc_length > 0)) return;
  const double v = std::sqrt(u_[unknown]);
  const double sum = tie.arc_speed + v;
  const double by_v = -tie.arc_length / (sum * sum);
  const double slope = by_v / (2 * v);
  const double square = (-2 * by_v / sum - by_v / v) / (4 * v * v);
  matrix_.at(unknown, 0) += square;
  base_[unknown] -= slope;
}

void QuickSearch::tie(std::size_t free, std::size_t tied, const EstimateTie& by) {
  const double factor = by.factor;
  const double stiff = kStiff * matrix_.at(tied, 0);
  const double missing = factor * u_[free] + by.offset - u_[tied];
  const std::size_t later = std::max(free, tied);
  matrix_.at(tied, 0) += stiff;
  matrix_.at(free, 0) += stiff * factor * factor;
  matrix_.at(later, 1) -= stiff * factor;
  base_[tied] += stiff * missing;
  base_[free] -= stiff * factor * missing;
}

void QuickSearch::pin(std::size_t unknown, double value) {
  const double stiff = kStiff * matrix_.at(unknown, 0);
  matrix_.at(unknown, 0) += stiff;
  base_[unknown] += stiff * (value - u_[unknown]);
}

void QuickSearch::tie_ends() {
  const std::size_t last = u_.size() - 1;
  const EstimateTie& start = problem_.start;
  const EstimateTie& end = problem_.end;
  add_arc(0, start);
  add_arc(last, end);
  if (start.pins) {
    pin(0, start.value);
    pin(1, start.next);
  } else if (start.ties) {
    tie(0, 1, start);
  }
  // A single interval has one ordinate inside: the start's equation is the one that counts.
  if (end.pins) pin(last, end.value);
  if (cells_.size() < 2 && (start.pins || start.ties)) return;
  if (end.pins) pin(last - 1, end.next);
  if (end.ties) tie(last, last - 1, end);
}

// Goes along the last step and sums the system of the next.
void QuickSearch::assemble(double primal, double dual) {
  matrix_.set_zero();
  std::fill(base_.begin(), base_.end(), 0);
  std::fill(center_.begin(), center_.end(), 0);
  tally_.start();
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const EstimateCell& cell = problem_.cells[k];
    CellState& at = cells_[k];
    LimitSums sums;
    sums.add_time(4 * cell.length / 6, at.root);
    add_bound(at.bound, at.x[0], primal, dual, sums, tally_);
    add_rows<false>(rows_of(cell), cell.jerk_rows, at.x, at.root, primal, dual, sums, tally_);
    add_cell(k, sums);
  }
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    KnotState& at = knots_[k];
    LimitSums sums;
    sums.add_time(problem_.knots[k].weight, at.root);
    add_bound(at.bound, at.q, primal, dual, sums, tally_);
    add_knot(k, sums);
  }
  tie_ends();
}

// The steps of slacks and duals that belong to the step of the unknowns (in base_), and how far
// both may go.
void QuickSearch::find_step(double target) {
  const std::vector<double>& du = base_;
  LimitReach reach(kToLimit);
  const auto keep_above_none = [&](double q, double dq) {
    reach.primal = std::max(reach.primal, -kToLimit * dq / ((1 - kLeastPart) * q));
  };
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const EstimateCell& cell = problem_.cells[k];
    CellState& at = cells_[k];
    const double* d = du.data() + k;
    const LimitWindow change = {dot(cell.q_of, d), dot(cell.p_of, d), dot(cell.r_of, d)};
    keep_above_none(at.x[0], change[0]);
    step_bound(at.bound, change[0], target, reach);
    step_rows(rows_of(cell), cell.jerk_rows, change, at.root, target, reach);
  }
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const EstimateKnot& knot = problem_.knots[k];
    const double change = knot.before * du[k] + knot.after * du[k + 1];
    keep_above_none(knots_[k].q, change);
    step_bound(knots_[k].bound, change, target, reach);
  }
  primal_share_ = kToLimit / reach.greatest_primal();
  dual_share_ = kToLimit / reach.greatest_dual();
}

EstimateSolution QuickSearch::run(const EstimateStretch& stretch) {
  EstimateSolution solution;
  guess(stretch);
  start_slacks();
  assemble(0, 0);
  double share = 0.5;
  for (int step = 1; step <= kMostSteps; ++step) {
    solution.iterations = step;
    const double part = std::max(kLeastGapPart, 1 - share);
    const double target = part * tally_.whole_gap() / tally_.sides;
    for (std::size_t i = 0; i < u_.size(); ++i) base_[i] += target * center_[i];
    matrix_.factor();
    matrix_.solve(base_);
    find_step(target);
    for (std::size_t i = 0; i < u_.size(); ++i) u_[i] += primal_share_ * base_[i];
    find_states();
    assemble(primal_share_, dual_share_);
    share = std::min(primal_share_, dual_share_);
    solution.found = tally_.whole_gap() < kEnoughGap * seconds_now() &&
                     tally_.excess < kEnoughKept && share > 0.5;
    if (solution.found) break;
  }
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const double ends = knots_[k].root + knots_[k + 1].root;
    solution.seconds.push_back(problem_.cells[k].length / 6 * (ends + 4 * cells_[k].root));
  }
  const auto arc = [](const EstimateTie& tie, double q) {
    return tie.arc_length > 0 ? tie.arc_length / (tie.arc_speed + std::sqrt(q)) : 0;
  };
  solution.start_seconds = arc(problem_.start, u_.front());
  solution.end_seconds = arc(problem_.end, u_.back());
  solution.ordinates = std::move(u_);
  return solution;
}

}  // namespace

EstimateSolution quick_search(std::span<const geometry::PathPiece> path,
                              const EstimateStretch& stretch, const KinematicPathLimits& limits) {
  const EstimateProblem problem = make_estimate_problem(path, stretch, limits);
  return QuickSearch(problem).run(stretch);
}

EstimateNode node_of(const EstimateStretch& stretch, const EstimateSolution& solution,
                     std::size_t i) {
  const auto& intervals = stretch.intervals;
  const auto& u = solution.ordinates;
  const double before = i > 0 ? intervals[i - 1].length : 0;
  const double after = i < intervals.size() ? intervals[i].length : 0;
  const double q = (after * u[i] + before * u[i + 1]) / (before + after);
  return {std::sqrt(q), (u[i + 1] - u[i]) / (before + after)};
}

}  // namespace batten::postproc
