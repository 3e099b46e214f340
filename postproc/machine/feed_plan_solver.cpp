#include "postproc/machine/feed_plan_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/banded_cholesky.h"

namespace batten::postproc {
namespace {

// Share of the way to the nearest limit that a step goes.
constexpr double kToLimit = 0.99;

// q may fall to this part of itself in one step: the time, 1 / sqrt(q), is modelled by its second
// derivative only.
constexpr double kLeastPart = 0.2;

constexpr int kMostIterations = 150;

// While the duals do not yet explain the gradient of the time, the search keeps this much distance
// from the limits: with less, it would creep along them.
constexpr double kGapPerUnexplained = 0.1;

// After a step shorter than this some limit is too near for its dual: the next step keeps the gap
// and evens out the products.
constexpr double kShortStep = 0.2;

// Both sides of a row: 1 - c.x and, but for kUpper, 1 + c.x; for kJerk with 1 / sqrt(q) for 1.
struct Pair {
  double plus = 0;   // of the side - c.x
  double minus = 0;  // of the side + c.x
};

class Search {
 public:
  Search(const PlanProblem& problem, std::vector<double> start)
      : problem_(problem),
        x_(std::move(start)),
        slack_(problem.rows.size()),
        dual_(problem.rows.size()),
        correction_(problem.rows.size()),
        gradient_(problem.unknowns()),
        residual_(problem.unknowns()),
        right_(problem.unknowns()),
        step_(problem.unknowns()),
        matrix_(problem.unknowns()) {
    for (const PlanRow& row : problem.rows) sides_ += row.limit == PlanLimit::kUpper ? 1 : 2;
  }

  PlanSolution run(double enough_gap);

 private:
  // The places of one interval at the present x: q and 1 / sqrt(q) by number of PlanPlace.
  struct Places {
    std::array<PlanWindow, 3> weights;
    std::array<double, 3> q;
    std::array<double, 3> root;
  };
  [[nodiscard]] Places places_of(std::size_t interval) const;

  void find_slacks();
  void start_duals();
  void assemble();
  [[nodiscard]] double unexplained() const;
  void fold_ends();
  void solve(std::vector<double>& right) const;
  [[nodiscard]] double affine_gap();
  void aim(double target);
  [[nodiscard]] double advance(double target);

  // Calls visit(row number, row, places, number of first unknown) for all rows.
  template <typename Visit>
  void for_rows(const Visit& visit) const;

  // What `row`'s right side changes by along a direction, linearised: 0 but for the jerk.
  static double root_change(const PlanRow& row, const Places& at, const double* d) {
    if (row.limit != PlanLimit::kJerk) return 0;
    const auto i = static_cast<std::size_t>(row.place);
    return -0.5 * at.root[i] / at.q[i] * dot(at.weights[i], d);
  }

  const PlanProblem& problem_;
  std::vector<double> x_;
  std::vector<Pair> slack_;
  std::vector<Pair> dual_;
  std::vector<Pair> correction_;
  std::vector<double> gradient_;
  std::vector<double> residual_;  // gradient of the time less what the duals explain
  std::vector<double> right_;
  std::vector<double> step_;
  geometry::BandedMatrix matrix_;
  double sides_ = 0;
  double gap_ = 0;  // sum of slack * dual
};

Search::Places Search::places_of(std::size_t interval) const {
  const double h = problem_.lengths[interval];
  const double* w = x_.data() + 2 * interval;
  Places at;
  at.weights = {PlanWindow{1, 0, 0, 0}, PlanWindow{0.5, h / 8, 0.5, -h / 8},
                PlanWindow{0, 0, 1, 0}};
  at.q = {w[0], 0.5 * (w[0] + w[2]) + h / 8 * (w[1] - w[3]), w[2]};
  for (int i = 0; i < 3; ++i) at.root[i] = 1 / std::sqrt(at.q[i]);
  return at;
}

template <typename Visit>
void Search::for_rows(const Visit& visit) const {
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    const Places at = places_of(i);
    for (std::size_t k = problem_.first_rows[i]; k < problem_.first_rows[i + 1]; ++k) {
      visit(k, problem_.rows[k], at, 2 * i);
    }
  }
}

void Search::find_slacks() {
  for_rows([&](std::size_t k, const PlanRow& row, const Places& at, std::size_t first) {
    const double right =
        row.limit == PlanLimit::kJerk ? at.root[static_cast<std::size_t>(row.place)] : 1;
    const double left = dot(row.c, x_.data() + first);
    slack_[k] = {right - left, right + left};
  });
}

// All products slack * dual alike, in sum half of the time.
void Search::start_duals() {
  const double product = 0.5 * planned_seconds(problem_, x_) / sides_;
  for (std::size_t k = 0; k < dual_.size(); ++k) {
    dual_[k].plus = product / slack_[k].plus;
    const bool one = problem_.rows[k].limit == PlanLimit::kUpper;
    dual_[k].minus = one ? 0 : product / slack_[k].minus;
  }
}

// Gradient of the time, and the matrix: its second derivatives and, for each side with slack g,
// dual l and gradient a of g, (l / g) a a^T.
void Search::assemble() {
  matrix_.set_zero();
  std::fill(gradient_.begin(), gradient_.end(), 0);
  std::fill(residual_.begin(), residual_.end(), 0);
  gap_ = 0;
  const auto add_time = [&](double weight, double q, double root, const PlanWindow& c,
                            std::size_t first, std::array<double, 16>& block) {
    const double slope = -0.5 * weight * root / q;
    const double bend = -1.5 * slope / q;
    for (int a = 0; a < 4; ++a) {
      gradient_[first + a] += slope * c[a];
      for (int b = 0; b <= a; ++b) block[4 * a + b] += bend * c[a] * c[b];
    }
  };
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    const Places at = places_of(i);
    const double h = problem_.lengths[i];
    std::array<double, 16> block{};
    double start = h / 6;
    double end = h / 6;
    if (i == 0) start += problem_.start.time();
    if (i + 1 == problem_.intervals()) end += problem_.end.time();
    add_time(start, at.q[0], at.root[0], at.weights[0], 2 * i, block);
    add_time(4 * h / 6, at.q[1], at.root[1], at.weights[1], 2 * i, block);
    add_time(end, at.q[2], at.root[2], at.weights[2], 2 * i, block);
    for (std::size_t k = problem_.first_rows[i]; k < problem_.first_rows[i + 1]; ++k) {
      const PlanRow& row = problem_.rows[k];
      PlanWindow t{};
      if (row.limit == PlanLimit::kJerk) {
        const auto place = static_cast<std::size_t>(row.place);
        const double factor = -0.5 * at.root[place] / at.q[place];
        for (int a = 0; a < 4; ++a) t[a] = factor * at.weights[place][a];
      }
      const Pair& g = slack_[k];
      const Pair& l = dual_[k];
      gap_ += g.plus * l.plus + g.minus * l.minus;
      const double plus = l.plus / g.plus;
      const double minus = l.minus / g.minus;
      for (int a = 0; a < 4; ++a) {
        residual_[2 * i + a] -= l.plus * (t[a] - row.c[a]) + l.minus * (t[a] + row.c[a]);
        const double plus_a = plus * (t[a] - row.c[a]);
        const double minus_a = minus * (t[a] + row.c[a]);
        for (int b = 0; b <= a; ++b) {
          block[4 * a + b] += plus_a * (t[b] - row.c[b]) + minus_a * (t[b] + row.c[b]);
        }
      }
    }
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b <= a; ++b) matrix_.at(2 * i + a, a - b) += block[4 * a + b];
    }
  }
  for (std::size_t i = 0; i < residual_.size(); ++i) residual_[i] += gradient_[i];
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

// At an end at rest, p is a multiple of q: its row and column join those of q.
void Search::fold_ends() {
  const std::size_t last = matrix_.size() - 1;
  if (problem_.start.length > 0) {
    const double k = problem_.start.slope();
    matrix_.at(0, 0) += 2 * k * matrix_.at(1, 1) + k * k * matrix_.at(1, 0);
    matrix_.at(2, 2) += k * matrix_.at(2, 1);
    matrix_.at(3, 3) += k * matrix_.at(3, 2);
    matrix_.at(1, 0) = 1;
    matrix_.at(1, 1) = matrix_.at(2, 1) = matrix_.at(3, 2) = 0;
  }
  if (problem_.end.length > 0) {
    const double k = -problem_.end.slope();
    matrix_.at(last - 1, 0) += 2 * k * matrix_.at(last, 1) + k * k * matrix_.at(last, 0);
    matrix_.at(last - 1, 1) += k * matrix_.at(last, 2);
    matrix_.at(last - 1, 2) += k * matrix_.at(last, 3);
    matrix_.at(last, 0) = 1;
    for (int below = 1; below <= 3; ++below) matrix_.at(last, below) = 0;
  }
}

void Search::solve(std::vector<double>& right) const {
  const std::size_t last = right.size() - 1;
  const bool from_rest = problem_.start.length > 0;
  const bool to_rest = problem_.end.length > 0;
  if (from_rest) {
    right[0] += problem_.start.slope() * right[1];
    right[1] = 0;
  }
  if (to_rest) {
    right[last - 1] -= problem_.end.slope() * right[last];
    right[last] = 0;
  }
  matrix_.solve_factored(right);
  if (from_rest) right[1] = problem_.start.slope() * right[0];
  if (to_rest) right[last] = -problem_.end.slope() * right[last - 1];
}

// Affine step: the products slack * dual all to 0 at once. How far it gets says how much of the
// gap the real step may leave out.
double Search::affine_gap() {
  double primal = 1;
  double dual = 1;
  double mixed_1 = 0;  // sums of g dl, l dg, dg dl
  double mixed_2 = 0;
  double mixed_3 = 0;
  const auto side = [&](double g, double l, double dg, double& correction) {
    const double dl = -l - l / g * dg;
    if (dg < 0) primal = std::min(primal, -g / dg);
    if (dl < 0) dual = std::min(dual, -l / dl);
    correction = dg * dl;
    mixed_1 += g * dl;
    mixed_2 += l * dg;
    mixed_3 += dg * dl;
  };
  for_rows([&](std::size_t k, const PlanRow& row, const Places& at, std::size_t first) {
    const double* d = step_.data() + first;
    const double change = root_change(row, at, d);
    const double left = dot(row.c, d);
    side(slack_[k].plus, dual_[k].plus, change - left, correction_[k].plus);
    if (row.limit != PlanLimit::kUpper) {
      side(slack_[k].minus, dual_[k].minus, change + left, correction_[k].minus);
    }
  });
  return gap_ + dual * mixed_1 + primal * mixed_2 + primal * dual * mixed_3;
}

// The right side for products slack * dual of `target`, the affine step's second order included.
void Search::aim(double target) {
  for (std::size_t i = 0; i < right_.size(); ++i) right_[i] = -gradient_[i];
  for_rows([&](std::size_t k, const PlanRow& row, const Places& at, std::size_t first) {
    const double plus = (target - correction_[k].plus) / slack_[k].plus;
    const bool one = row.limit == PlanLimit::kUpper;
    const double minus = one ? 0 : (target - correction_[k].minus) / slack_[k].minus;
    double* right = right_.data() + first;
    for (int a = 0; a < 4; ++a) right[a] += (minus - plus) * row.c[a];
    if (row.limit != PlanLimit::kJerk) return;
    const auto place = static_cast<std::size_t>(row.place);
    const double factor = -0.5 * at.root[place] / at.q[place] * (plus + minus);
    for (int a = 0; a < 4; ++a) right[a] += factor * at.weights[place][a];
  });
}

// Goes along step_, unknowns and duals each as far as they can. Returns the unknowns' share.
double Search::advance(double target) {
  double primal = 1 / kToLimit;
  double dual = 1 / kToLimit;
  const auto side = [&](double g, double l, double dg, double& correction) {
    const double dl = (target - correction - l * dg) / g - l;
    if (dg < 0) primal = std::min(primal, -g / dg);
    if (dl < 0) dual = std::min(dual, -l / dl);
    correction = dl;
  };
  for_rows([&](std::size_t k, const PlanRow& row, const Places& at, std::size_t first) {
    const double* d = step_.data() + first;
    const double change = root_change(row, at, d);
    const double left = dot(row.c, d);
    side(slack_[k].plus, dual_[k].plus, change - left, correction_[k].plus);
    if (row.limit != PlanLimit::kUpper) {
      side(slack_[k].minus, dual_[k].minus, change + left, correction_[k].minus);
    }
  });
  for (std::size_t i = 0; i < problem_.intervals(); ++i) {
    const Places at = places_of(i);
    for (int place = 0; place < 3; ++place) {
      const double change = dot(at.weights[place], step_.data() + 2 * i);
      if (change < 0) primal = std::min(primal, (1 - kLeastPart) * at.q[place] / -change);
    }
  }
  primal *= kToLimit;
  dual *= kToLimit;
  for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += primal * step_[i];
  for (std::size_t k = 0; k < dual_.size(); ++k) {
    dual_[k].plus += dual * correction_[k].plus;
    if (problem_.rows[k].limit != PlanLimit::kUpper) {
      dual_[k].minus += dual * correction_[k].minus;
    }
  }
  return primal;
}

PlanSolution Search::run(double enough_gap) {
  PlanSolution best;
  best.x = x_;
  best.seconds = planned_seconds(problem_, x_);
  find_slacks();
  start_duals();
  double share = 1;
  for (int iteration = 1; iteration <= kMostIterations; ++iteration) {
    assemble();
    best.gap = gap_;
    best.iterations = iteration;
    fold_ends();
    if (!matrix_.factor()) break;
    for (std::size_t i = 0; i < step_.size(); ++i) step_[i] = -gradient_[i];
    solve(step_);
    const double ratio = affine_gap() / gap_;
    double aimed = std::max(gap_ * ratio * ratio * ratio, kGapPerUnexplained * unexplained());
    if (share < kShortStep) aimed = std::max(aimed, gap_);
    const double target = aimed / sides_;
    aim(target);
    solve(right_);
    step_.swap(right_);
    share = advance(target);
    find_slacks();
    const double seconds = planned_seconds(problem_, x_);
    if (seconds < best.seconds) {
      best.seconds = seconds;
      best.x = x_;
    }
    if (gap_ < enough_gap * seconds && share > 0.5) break;
  }
  return best;
}

}  // namespace

PlanSolution fastest_plan(const PlanProblem& problem, std::vector<double> start,
                          double enough_gap) {
  return Search(problem, std::move(start)).run(enough_gap);
}

}  // namespace batten::postproc
