#include "postproc/machine/planner/feed_search.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "geometry/numeric/banded_cholesky.h"

namespace batten::postproc {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct SearchTuning {
  double to_limit = 0.98;   // share of the way to the nearest limit that a step goes
  double least_part = 0.2;  // q may fall to this part of itself in one step: the time, 1 / sqrt(q),
                            // is modelled by its second derivative only
  double stiff = 1e8;       // an equation between unknowns is a spring this much stiffer than all
                            // else at that position
};
constexpr SearchTuning kSearch;

// c.x <= 1, or <= 1 / sqrt(q) for the jerk.
struct LimitSide {
  Vector3d c = Vector3d::Zero();
  double slack = 1;
  double dual = 0;
  double inverse = 1;  // of the slack
  double missing = 0;  // what the unknowns leave, less the slack
  double slack_step = 0;
  double dual_step = 0;
};

struct PlaceState {
  Vector3d x = Vector3d::Zero();  // q, p, r
  double root = 0;                // 1 / sqrt(q)
  std::size_t first = 0;          // of its sides
  std::size_t jerk_sides = 0;
  std::size_t sides = 0;

  // By which 1 / sqrt(q) falls per q.
  [[nodiscard]] double tangent() const { return 0.5 * root * root * root; }
};

class Search {
 public:
  Search(const SearchProblem& problem, std::vector<double> start);
  SearchResult run(const SearchRule& rule);

 private:
  void find_states();
  [[nodiscard]] double seconds() const;
  void start_slacks(const SearchRule& rule);
  void assemble(double primal, double dual);
  void add_place(const SearchPlace& place, const PlaceState& at, double primal, double dual);
  void add_springs();
  void find_step(double target);
  [[nodiscard]] double unexplained() const;
  [[nodiscard]] std::span<LimitSide> sides_of(const PlaceState& at) {
    return std::span(sides_).subspan(at.first, at.sides);
  }

  const SearchProblem& problem_;
  std::vector<double> x_;
  std::vector<LimitSide> sides_;
  std::vector<PlaceState> places_;
  std::vector<double> base_;         // the right side for a target of 0, then the step
  std::vector<double> center_;       // what a target of 1 adds to it
  std::vector<double> unexplained_;  // gradient of the time, and of the limits times their duals
  geometry::BandedMatrix matrix_;
  double gap_ = 0;           // s: the sum of slack * dual
  double excess_ = 0;        // the greatest part of its limit that a side is above it
  double primal_share_ = 1;  // of the step
  double dual_share_ = 1;
};

Search::Search(const SearchProblem& problem, std::vector<double> start)
    : problem_(problem), x_(std::move(start)), matrix_(problem.unknowns) {
  sides_.reserve(2 * problem.rows.size() + problem.places.size());
  for (const SearchPlace& place : problem.places) {
    PlaceState& at = places_.emplace_back();
    at.first = sides_.size();
    at.jerk_sides = 2 * place.jerk_rows;
    for (std::size_t k = 0; k < place.rows; ++k) {
      const Vector3d& c = problem.rows[place.first_row + k];
      sides_.push_back({.c = c});
      sides_.push_back({.c = -c});
    }
    if (!std::isinf(place.most)) sides_.push_back({.c = Vector3d(1 / place.most, 0, 0)});
    at.sides = sides_.size() - at.first;
  }
}

void Search::find_states() {
  for (std::size_t k = 0; k < places_.size(); ++k) {
    places_[k].x = problem_.places[k].state_of(x_);
    places_[k].root = 1 / std::sqrt(places_[k].x[0]);
  }
}

double Search::seconds() const {
  double time = 0;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    time += problem_.places[k].time * places_[k].root;
  }
  return time;
}

// All products slack * dual alike.
void Search::start_slacks(const SearchRule& rule) {
  find_states();
  const double product = rule.first_gap * seconds() / static_cast<double>(sides_.size());
  for (const PlaceState& at : places_) {
    const std::span<LimitSide> sides = sides_of(at);
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const double right = i < at.jerk_sides ? at.root : 1;
      sides[i].slack = std::max(right - sides[i].c.dot(at.x), rule.least_slack * right);
      sides[i].dual = product / sides[i].slack;
    }
  }
}

// Goes these shares of the last step and adds what is needed for the next.
void Search::add_place(const SearchPlace& place, const PlaceState& at, double primal, double dual) {
  const double slope = -place.time * at.tangent();  // of the time, by q
  Matrix3d square = Matrix3d::Zero();
  square(0, 0) = -1.5 * slope * at.root * at.root;
  Vector3d base(-slope, 0, 0);
  Vector3d center = Vector3d::Zero();
  Vector3d unexplained(slope, 0, 0);
  const std::span<LimitSide> sides = sides_of(at);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    LimitSide& side = sides[i];
    const bool of_jerk = i < at.jerk_sides;
    side.slack += primal * side.slack_step;
    side.dual += dual * side.dual_step;
    const double right = of_jerk ? at.root : 1;
    const double room = right - side.c.dot(at.x);
    side.missing = room - side.slack;
    side.inverse = 1 / side.slack;
    gap_ += side.slack * side.dual;
    excess_ = std::max(excess_, -room / right);
    Vector3d g = side.c;
    if (of_jerk) g[0] += at.tangent();
    const double weight = side.dual * side.inverse;
    const Vector3d weighted = weight * g;
    square.noalias() += weighted * g.transpose();
    base += side.missing * weighted;
    center -= side.inverse * g;
    unexplained += side.dual * g;
  }
  for (Eigen::Index a = 0; a < place.sums.cols(); ++a) {
    const Vector3d w = place.sums.col(a);
    const Vector3d by = square * w;
    const std::size_t row = place.first + static_cast<std::size_t>(a);
    for (Eigen::Index b = 0; b <= a; ++b) {
      matrix_.at(row, static_cast<int>(a - b)) += by.dot(place.sums.col(b));
    }
    base_[row] += base.dot(w);
    center_[row] += center.dot(w);
    unexplained_[row] += unexplained.dot(w);
  }
}

void Search::add_springs() {
  for (const auto& [tied, free, factor, offset] : problem_.ties) {
    const double stiff = kSearch.stiff * matrix_.at(tied, 0);
    const double missing = factor * x_[free] + offset - x_[tied];
    matrix_.at(tied, 0) += stiff;
    base_[tied] += stiff * missing;
    if (factor == 0) continue;
    matrix_.at(free, 0) += stiff * factor * factor;
    matrix_.at(std::max(free, tied), 1) -= stiff * factor;
    base_[free] -= stiff * factor * missing;
  }
}

// Goes these shares of the last step and makes the system of the next.
void Search::assemble(double primal, double dual) {
  matrix_.reset(problem_.unknowns);
  for (auto* sums : {&base_, &center_, &unexplained_}) sums->assign(problem_.unknowns, 0);
  gap_ = excess_ = 0;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    add_place(problem_.places[k], places_[k], primal, dual);
  }
  add_springs();
}

// Seconds that the time would change by, to first order and beyond what the duals explain, if each
// q were 0 instead, or twice as much: of unknowns that are q and p of a node in turn.
double Search::unexplained() const {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < x_.size(); i += 2) {
    const bool is_given = std::ranges::any_of(
        problem_.ties, [&](const UnknownTie& t) { return t.tied == i && t.factor == 0; });
    if (!is_given) sum += std::abs(unexplained_[i] * x_[i] + unexplained_[i + 1] * x_[i + 1]);
  }
  return sum;
}

// The steps of slacks and duals that belong to the step of the unknowns, and how far they may go.
void Search::find_step(double target) {
  // Reciprocals of the shares, times how near to a limit they may come.
  double primal = kSearch.to_limit;
  double dual = kSearch.to_limit;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const PlaceState& at = places_[k];
    const Vector3d change = problem_.places[k].state_of(base_);
    primal = std::max(primal, -kSearch.to_limit * change[0] / ((1 - kSearch.least_part) * at.x[0]));
    const std::span<LimitSide> sides = sides_of(at);
    for (std::size_t i = 0; i < sides.size(); ++i) {
      LimitSide& side = sides[i];
      const double moved = i < at.jerk_sides ? at.tangent() * change[0] : 0;
      side.slack_step = side.missing - side.c.dot(change) - moved;
      side.dual_step = (target - side.dual * side.slack_step) * side.inverse - side.dual;
      primal = std::max(primal, -side.slack_step * side.inverse);
      dual = std::max(dual, -side.dual_step / side.dual);
    }
  }
  primal_share_ = kSearch.to_limit / primal;
  dual_share_ = kSearch.to_limit / dual;
}

SearchResult Search::run(const SearchRule& rule) {
  start_slacks(rule);
  assemble(0, 0);
  double share = 0.5;
  bool found = false;
  for (int step = 0; step < rule.most_steps && !found; ++step) {
    double wanted = std::max(rule.least_gap_part, 1 - share) * gap_;
    wanted = std::max(wanted, std::min(gap_, rule.per_unexplained * unexplained()));
    const double target = wanted / static_cast<double>(sides_.size());
    for (std::size_t i = 0; i < base_.size(); ++i) base_[i] += target * center_[i];
    if (!matrix_.solve(base_)) break;
    find_step(target);
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += primal_share_ * base_[i];
    find_states();
    assemble(primal_share_, dual_share_);
    share = std::min(primal_share_, dual_share_);
    found = gap_ < rule.enough_gap * seconds() && excess_ < rule.enough_kept && share > 0.5;
  }
  const double time = seconds();
  return {std::move(x_), time, excess_};
}

}  // namespace

Vector3d SearchPlace::state_of(const std::vector<double>& unknowns) const {
  Vector3d x = Vector3d::Zero();
  for (Eigen::Index i = 0; i < sums.cols(); ++i) {
    x += unknowns[first + static_cast<std::size_t>(i)] * sums.col(i);
  }
  return x;
}

void SearchProblem::add_row(double q, double p, double r, double limit, SearchPlace& place) {
  if (std::isinf(limit) || (q == 0 && p == 0 && r == 0)) return;
  rows.emplace_back(Vector3d(q, p, r) / limit);
  ++place.rows;
}

void SearchProblem::add_jerk_rows(const LengthDerivatives& x, const KinematicPathLimits& limits,
                                  SearchPlace& place) {
  place.first_row = rows.size();
  if (x.is_straight()) {
    add_row(0, 0, 0.5, limits_along(x.first, limits).jerk, place);
  } else {
    for (int i = 0; i < 3; ++i) {
      add_row(x.third[i], 1.5 * x.second[i], 0.5 * x.first[i], limits.jerk[i], place);
    }
    add_row(0, 0, 0.5, limits.tangential_jerk, place);
  }
  place.jerk_rows = place.rows;
}

void SearchProblem::add_other_limits(const LengthDerivatives& x, const KinematicPathLimits& limits,
                                     SearchPlace& place) {
  const LimitsAlong along = limits_along(x.first, limits);
  place.lower_speed(along.speed);
  if (x.is_straight()) return add_row(0, 0.5, 0, along.acceleration, place);
  place.most = std::min(place.most, limits.normal_acceleration / x.second.norm());
  for (int i = 0; i < 3; ++i) {
    add_row(x.second[i], 0.5 * x.first[i], 0, limits.acceleration[i], place);
  }
  add_row(0, 0.5, 0, limits.tangential_acceleration, place);
}

void SearchProblem::tie(std::vector<double>& x) const {
  for (const auto& [tied, free, factor, offset] : ties) {
    x[tied] = factor * x[free] + offset;
  }
}

SearchResult fastest(const SearchProblem& problem, std::vector<double> start,
                     const SearchRule& rule) {
  return Search(problem, std::move(start)).run(rule);
}

void slow_down(const SearchProblem& problem, std::vector<double>& unknowns) {
  double factor = 1;
  for (const SearchPlace& place : problem.places) {
    const Vector3d x = place.state_of(unknowns);
    factor = std::min(factor, place.most / x[0]);
    for (std::size_t k = 0; k < place.rows; ++k) {
      const double size = std::abs(problem.rows[place.first_row + k].dot(x));
      if (!(size > 0)) continue;
      const double ratio = k < place.jerk_rows ? 1 / (std::sqrt(x[0]) * size) : 1 / size;
      factor = std::min(factor, k < place.jerk_rows ? std::cbrt(ratio * ratio) : ratio);
    }
  }
  for (double& u : unknowns) u *= factor;
  problem.tie(unknowns);
}

void smooth(std::vector<double>& values, int passes) {
  for (double& value : values) value = std::log(value);
  for (int pass = 0; pass < passes; ++pass) {
    double before = values.front();
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
      before = std::exchange(values[i], 0.25 * before + 0.5 * values[i] + 0.25 * values[i + 1]);
    }
  }
  for (double& value : values) value = std::exp(value);
}

}  // namespace batten::postproc
