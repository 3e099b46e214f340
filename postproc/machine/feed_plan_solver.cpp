#include "postproc/machine/feed_plan_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "postproc/machine/feed_plan_matrix.h"

namespace batten::postproc {
namespace {

// Share of the way to the nearest limit that a step goes.
constexpr double kToLimit = 0.99;

// q may fall to this part of itself in one step: the time, 1 / sqrt(q), is modelled by its second
// derivative only.
constexpr double kLeastPart = 0.2;

// Paths whose allowed speed changes a hundredfold within a millimetre take up to 120.
constexpr int kMostIterations = 150;

// While the duals do not yet explain the gradient of the time, the search keeps this much distance
// from the limits: with less, it would creep along them.
constexpr double kGapPerUnexplained = 0.1;

// After a step shorter than this some limit is too near for its dual: the next step keeps the gap
// and evens out the products.
constexpr double kShortStep = 0.2;

// One side of a row: g = 1 - c.x or 1 + c.x, for kJerk with 1 / sqrt(q) for 1.
struct Side {
  double slack = 0;    // g
  double inverse = 0;  // 1 / g
  double dual = 0;     // l
  double extra = 0;    // dg dl of the affine step, then the step of l
};

struct RowState {
  PlanWindow c{};
  Side plus;       // - c.x
  Side minus;      // + c.x
  double two = 1;  // 0 where only the first side is there: its dual stays 0
  bool jerk = false;
  std::uint8_t place = 0;
};

// q at the three places of an interval, 1 / sqrt(q), and the derivative of that by q.
struct Places {
  std::array<double, 3> q{};
  std::array<double, 3> root{};
  std::array<double, 3> slope{};
};

// q at the places as sums over the window.
std::array<PlanWindow, 3> place_weights(double length) {
  return {PlanWindow{1, 0, 0, 0}, PlanWindow{0.5, length / 8, 0.5, -length / 8},
          PlanWindow{0, 0, 1, 0}};
}

// The three numbers that a change of the unknowns makes of q at the places.
std::array<double, 3> at_places(double length, const double* d) {
  return {d[0], 0.5 * (d[0] + d[2]) + length / 8 * (d[1] - d[3]), d[2]};
}

class Search {
 public:
  Search(const PlanProblem& problem, std::vector<double> start);
  PlanSolution run(const SearchRule& rule);

 private:
  void find_slacks();
  void start_duals(double gap);
  void assemble();
  void add_time(std::size_t interval, PlanWindow& gradient, PlanBlock& block) const;
  [[nodiscard]] double unexplained() const;
  [[nodiscard]] double affine_gap();
  void aim(double target);
  [[nodiscard]] double advance(double target);

  // Calls visit(row, change of its left side, change of its right side) along step_.
  template <typename Visit>
  void along_step(const Visit& visit);

  const PlanProblem& problem_;
  std::vector<double> x_;
  std::vector<RowState> rows_;
  std::vector<Places> places_;
  std::vector<double> gradient_;  // of the time
  std::vector<double> residual_;  // of it, what the duals do not explain
  std::vector<double> right_;
  std::vector<double> step_;
  PlanMatrix matrix_;
  double sides_ = 0;
  double gap_ = 0;  // sum of slack * dual
};

Search::Search(const PlanProblem& problem, std::vector<double> start)
    : problem_(problem),
      x_(std::move(start)),
      rows_(problem.rows.size()),
      places_(problem.intervals()),
      gradient_(problem.unknowns()),
      residual_(problem.unknowns()),
      right_(problem.unknowns()),
      step_(problem.unknowns()),
      matrix_(problem) {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const PlanRow& row = problem.rows[k];
    rows_[k].c = row.c;
    rows_[k].two = row.limit == PlanLimit::kUpper ? 0 : 1;
    rows_[k].jerk = row.limit == PlanLimit::kJerk;
    rows_[k].place = static_cast<std::uint8_t>(row.place);
    sides_ += 1 + rows_[k].two;
  }
}

void Search::find_slacks() {
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    Places& at = places_[i];
    const double* w = x_.data() + 2 * i;
    at.q = at_places(problem_.lengths[i], w);
    for (int p = 0; p < 3; ++p) {
      at.root[p] = 1 / std::sqrt(at.q[p]);
      at.slope[p] = -0.5 * at.root[p] / at.q[p];
    }
    for (std::size_t k = problem_.first_rows[i]; k < problem_.first_rows[i + 1]; ++k) {
      RowState& row = rows_[k];
      const double right = row.jerk ? at.root[row.place] : 1;
      const double left = dot(row.c, w);
      row.plus.slack = right - left;
      row.minus.slack = right + left;
      row.plus.inverse = 1 / row.plus.slack;
      row.minus.inverse = 1 / row.minus.slack;
    }
  }
}

// All products slack * dual alike, in sum this part of the time.
void Search::start_duals(double gap) {
  const double product = gap * planned_seconds(problem_, x_) / sides_;
  for (RowState& row : rows_) {
    row.plus.dual = product * row.plus.inverse;
    row.minus.dual = row.two * product * row.minus.inverse;
  }
}

// First and second derivatives of the time over one interval and at rest beside it.
void Search::add_time(std::size_t interval, PlanWindow& gradient, PlanBlock& block) const {
  const Places& at = places_[interval];
  const double h = problem_.lengths[interval];
  std::array<double, 3> weight = {h / 6, 4 * h / 6, h / 6};
  if (interval == 0) weight[0] += problem_.start.time();
  if (interval + 1 == problem_.intervals()) weight[2] += problem_.end.time();
  const std::array<PlanWindow, 3> c = place_weights(h);
  for (int p = 0; p < 3; ++p) {
    const double slope = weight[p] * at.slope[p];
    add_scaled(gradient, slope, c[p]);
    block.add_square(-1.5 * slope / at.q[p], c[p]);
  }
}

// The matrix: second derivatives of the time and, for each side with slack g, dual l and
// gradient a of g, (l / g) a a^T. For a jerk row a = t -+ c, with t = slope * weights of its place,
// so what has a t in it is summed by places first.
void Search::assemble() {
  matrix_.set_zero();
  std::fill(gradient_.begin(), gradient_.end(), 0);
  std::fill(residual_.begin(), residual_.end(), 0);
  gap_ = 0;
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    PlanBlock block;
    PlanWindow gradient{};
    PlanWindow explained{};
    add_time(i, gradient, block);
    std::array<PlanWindow, 3> products{};  // by places: sums of (l / g) c and l / g, and of l
    std::array<double, 3> squares{};
    std::array<double, 3> duals{};
    for (std::size_t k = problem_.first_rows[i]; k < problem_.first_rows[i + 1]; ++k) {
      const RowState& row = rows_[k];
      gap_ += row.plus.slack * row.plus.dual + row.minus.slack * row.minus.dual;
      const double plus = row.plus.dual * row.plus.inverse;
      const double minus = row.minus.dual * row.minus.inverse;
      add_scaled(explained, row.minus.dual - row.plus.dual, row.c);
      block.add_square(plus + minus, row.c);
      if (!row.jerk) continue;
      duals[row.place] += row.plus.dual + row.minus.dual;
      squares[row.place] += plus + minus;
      add_scaled(products[row.place], minus - plus, row.c);
    }
    const std::array<PlanWindow, 3> weights = place_weights(problem_.lengths[i]);
    for (int p = 0; p < 3; ++p) {
      PlanWindow t{};
      add_scaled(t, places_[i].slope[p], weights[p]);
      add_scaled(explained, duals[p], t);
      block.add_square(squares[p], t);
      block.add_product(t, products[p]);
    }
    for (int a = 0; a < 4; ++a) {
      gradient_[2 * i + a] += gradient[a];
      residual_[2 * i + a] += gradient[a] - explained[a];
    }
    matrix_.add(i, block);
  }
}

// Seconds that the time would change by, to first order and beyond what the duals explain, if each
// q were 0 instead, or twice as much.
double Search::unexplained() const {
  double sum = 0;
  for (std::size_t i = 0; i < x_.size(); i += 2) {
    sum += std::abs(residual_[i] * x_[i] + residual_[i + 1] * x_[i + 1]);
  }
  return sum;
}

template <typename Visit>
void Search::along_step(const Visit& visit) {
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    const double* d = step_.data() + 2 * i;
    std::array<double, 3> change = at_places(problem_.lengths[i], d);
    for (int p = 0; p < 3; ++p) change[p] *= places_[i].slope[p];
    for (std::size_t k = problem_.first_rows[i]; k < problem_.first_rows[i + 1]; ++k) {
      RowState& row = rows_[k];
      visit(row, dot(row.c, d), row.jerk ? change[row.place] : 0);
    }
  }
}

// Affine step: the products slack * dual all to 0 at once, dl = -l (1 + dg / g). How far it
// gets says how much of the gap the real step may leave out.
double Search::affine_gap() {
  double primal = 1;  // reciprocals of the shares of the step that can be gone
  double dual = 1;
  double slack_dual_step = 0;  // sums of g dl, l dg, dg dl
  double step_dual = 0;
  double steps = 0;
  const auto side = [&](Side& at, double dg) {
    const double part = dg * at.inverse;
    primal = std::max(primal, -part);
    dual = std::max(dual, 1 + part);
    const double dl = -at.dual * (1 + part);
    at.extra = dg * dl;
    slack_dual_step += at.slack * dl;
    step_dual += at.dual * dg;
    steps += at.extra;
  };
  along_step([&](RowState& row, double left, double right) {
    side(row.plus, right - left);
    side(row.minus, right + left);
  });
  return gap_ + slack_dual_step / dual + step_dual / primal + steps / (primal * dual);
}

// The right side for products slack * dual of `target`, the affine step's second order included.
void Search::aim(double target) {
  for (std::size_t i = 0; i < right_.size(); ++i) right_[i] = -gradient_[i];
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    PlanWindow sum{};
    std::array<double, 3> by_place{};
    for (std::size_t k = problem_.first_rows[i]; k < problem_.first_rows[i + 1]; ++k) {
      const RowState& row = rows_[k];
      const double plus = (target - row.plus.extra) * row.plus.inverse;
      const double minus = (row.two * target - row.minus.extra) * row.minus.inverse;
      add_scaled(sum, minus - plus, row.c);
      if (row.jerk) by_place[row.place] += plus + minus;
    }
    for (int p = 0; p < 3; ++p) by_place[p] *= places_[i].slope[p];
    const double tilt = problem_.lengths[i] / 8 * by_place[1];
    double* right = right_.data() + 2 * i;
    right[0] += sum[0] + by_place[0] + 0.5 * by_place[1];
    right[1] += sum[1] + tilt;
    right[2] += sum[2] + by_place[2] + 0.5 * by_place[1];
    right[3] += sum[3] - tilt;
  }
}

// Goes along step_, unknowns and duals each as far as they can. Returns the unknowns' share.
double Search::advance(double target) {
  double primal = kToLimit;
  double dual = kToLimit;
  const auto side = [&](Side& at, double dg, double product) {
    const double dl = (product - at.extra - at.dual * dg) * at.inverse - at.dual;
    primal = std::max(primal, -dg * at.inverse);
    if (-dl > dual * at.dual) dual = -dl / at.dual;
    at.extra = dl;
  };
  along_step([&](RowState& row, double left, double right) {
    side(row.plus, right - left, target);
    if (row.two > 0) side(row.minus, right + left, target);
  });
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    const auto change = at_places(problem_.lengths[i], step_.data() + 2 * i);
    for (int p = 0; p < 3; ++p) {
      primal = std::max(primal, -change[p] / ((1 - kLeastPart) * places_[i].q[p]));
    }
  }
  const double primal_share = kToLimit / primal;
  const double dual_share = kToLimit / dual;
  for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += primal_share * step_[i];
  for (RowState& row : rows_) {
    row.plus.dual += dual_share * row.plus.extra;
    if (row.two > 0) row.minus.dual += dual_share * row.minus.extra;
  }
  return primal_share;
}

PlanSolution Search::run(const SearchRule& rule) {
  PlanSolution best;
  best.x = x_;
  best.seconds = planned_seconds(problem_, x_);
  find_slacks();
  start_duals(rule.first_gap);
  double share = 1;
  for (int iteration = 1; iteration <= kMostIterations; ++iteration) {
    assemble();
    best.gap = gap_;
    best.iterations = iteration;
    if (!matrix_.factor()) break;
    for (std::size_t i = 0; i < step_.size(); ++i) step_[i] = -gradient_[i];
    matrix_.solve(step_);
    const double ratio = affine_gap() / gap_;
    double aimed = std::max(gap_ * ratio * ratio * ratio, kGapPerUnexplained * unexplained());
    if (share < kShortStep) aimed = std::max(aimed, gap_);
    const double target = aimed / sides_;
    aim(target);
    matrix_.solve(right_);
    step_.swap(right_);
    share = advance(target);
    find_slacks();
    const double seconds = planned_seconds(problem_, x_);
    if (seconds < best.seconds) {
      best.seconds = seconds;
      best.x = x_;
    }
    if (gap_ < rule.enough_gap * seconds && share > 0.5) break;
  }
  return best;
}

}  // namespace

PlanSolution fastest_plan(const PlanProblem& problem, std::vector<double> start,
                          const SearchRule& rule) {
  return Search(problem, std::move(start)).run(rule);
}

}  // namespace batten::postproc
