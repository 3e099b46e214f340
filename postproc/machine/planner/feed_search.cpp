#include "postproc/machine/planner/feed_search.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "geometry/basic/operations.h"
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

// Of the two sides of a limit, c.x <= right and -c.x <= right.
using Sides = Eigen::Array2d;

double difference(const Sides& of) { return of[0] - of[1]; }

// |c.x| <= 1, or <= 1 / sqrt(q) for the jerk.
struct Limit {
  Sides slack = Sides::Ones();
  Sides dual = Sides::Zero();
  Sides inverse = Sides::Ones();  // of the slack
  Sides missing = Sides::Zero();  // what the unknowns leave, less the slack
  Sides slack_step = Sides::Zero();
  Sides dual_step = Sides::Zero();
  Vector3d c = Vector3d::Zero();
};

struct PlaceState {
  Vector3d x = Vector3d::Zero();  // q, p, r
  double root = 0;                // 1 / sqrt(q)
  std::size_t first = 0;          // of its limits
  std::size_t jerk_limits = 0;
  std::size_t limits = 0;

  // By which 1 / sqrt(q) falls per q.
  [[nodiscard]] double tangent() const { return 0.5 * root * root * root; }
};

// What the limits of one place add to its system in q, p and r.
struct PlaceSums {
  Matrix3d square = Matrix3d::Zero();
  Vector3d edge = Vector3d::Zero();  // that comes to the first row and to the first column
  Vector3d base = Vector3d::Zero();
  Vector3d center = Vector3d::Zero();
  Vector3d unexplained = Vector3d::Zero();
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
  [[nodiscard]] std::span<Limit> limits_of(const PlaceState& at) {
    return std::span(limits_).subspan(at.first, at.limits);
  }
  // The gap of each side that the target asks for.
  [[nodiscard]] double per_side(double gap) const {
    return gap / (2 * static_cast<double>(limits_.size()));
  }

  const SearchProblem& problem_;
  std::vector<double> x_;
  std::vector<Limit> limits_;
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
  limits_.reserve(problem.rows.size() + problem.places.size());
  for (const SearchPlace& place : problem.places) {
    PlaceState& at = places_.emplace_back();
    at.first = limits_.size();
    at.jerk_limits = place.jerk_rows;
    for (std::size_t k = 0; k < place.rows; ++k) {
      limits_.emplace_back().c = problem.rows[place.first_row + k];
    }
    if (!std::isinf(place.most)) limits_.emplace_back().c[0] = 1 / place.most;
    at.limits = limits_.size() - at.first;
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
  const double product = per_side(rule.first_gap * seconds());
  for (const PlaceState& at : places_) {
    const std::span<Limit> limits = limits_of(at);
    for (std::size_t i = 0; i < limits.size(); ++i) {
      const double right = i < at.jerk_limits ? at.root : 1;
      const double used = limits[i].c.dot(at.x);
      limits[i].slack = Sides(right - used, right + used).max(rule.least_slack * right);
      limits[i].dual = product / limits[i].slack;
    }
  }
}

// Goes these shares of the last step and adds what is needed for the next. The gradient of a side
// is c or -c, of a jerk's with the tangent of its right side.
void Search::add_place(const SearchPlace& place, const PlaceState& at, double primal, double dual) {
  PlaceSums sums;
  double least = 1;  // room, as part of the limit
  const std::span<Limit> limits = limits_of(at);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    Limit& limit = limits[i];
    const bool of_jerk = i < at.jerk_limits;
    const double right = of_jerk ? at.root : 1;
    const double tangent = of_jerk ? at.tangent() : 0;
    const double used = limit.c.dot(at.x);
    const Sides room(right - used, right + used);
    limit.slack += primal * limit.slack_step;
    limit.dual += dual * limit.dual_step;
    limit.missing = room - limit.slack;
    limit.inverse = 1 / limit.slack;
    gap_ += (limit.slack * limit.dual).sum();
    least = std::min(least, room.minCoeff() / right);
    const Sides weight = limit.dual * limit.inverse;
    const Sides pull = weight * limit.missing;
    const double both = weight.sum();
    const Vector3d weighted = both * limit.c;
    sums.square.noalias() += weighted * limit.c.transpose();
    sums.edge += tangent * difference(weight) * limit.c;
    sums.square(0, 0) += tangent * tangent * both;
    sums.base += difference(pull) * limit.c;
    sums.base[0] += tangent * pull.sum();
    sums.center -= difference(limit.inverse) * limit.c;
    sums.center[0] -= tangent * limit.inverse.sum();
    sums.unexplained += difference(limit.dual) * limit.c;
    sums.unexplained[0] += tangent * limit.dual.sum();
  }
  excess_ = std::max(excess_, -least);
  const double slope = -place.time * at.tangent();  // of the time, by q
  sums.square(0, 0) -= 1.5 * slope * at.root * at.root;
  sums.square.col(0) += sums.edge;
  sums.square.row(0) += sums.edge.transpose();
  sums.base[0] -= slope;
  sums.unexplained[0] += slope;
  using Eigen::Matrix4d;
  using Eigen::Vector4d;
  const Matrix4d square = place.sums.transpose() * (sums.square * place.sums);
  const Vector4d base = place.sums.transpose() * sums.base;
  const Vector4d center = place.sums.transpose() * sums.center;
  const Vector4d unexplained = place.sums.transpose() * sums.unexplained;
  for (int a = 0; a < 4; ++a) {
    const std::size_t row = place.first + static_cast<std::size_t>(a);
    for (int b = 0; b <= a; ++b) matrix_.at(row, a - b) += square(a, b);
    base_[row] += base[a];
    center_[row] += center[a];
    unexplained_[row] += unexplained[a];
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
  geometry::count_operations(4 * places_.size());
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
    const std::span<Limit> limits = limits_of(at);
    for (std::size_t i = 0; i < limits.size(); ++i) {
      Limit& limit = limits[i];
      const double moved = i < at.jerk_limits ? at.tangent() * change[0] : 0;
      const double along = limit.c.dot(change);
      limit.slack_step = limit.missing - Sides(moved + along, moved - along);
      limit.dual_step = (target - limit.dual * limit.slack_step) * limit.inverse - limit.dual;
      primal = std::max(primal, -(limit.slack_step * limit.inverse).minCoeff());
      dual = std::max(dual, -(limit.dual_step / limit.dual).minCoeff());
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
    const double target = per_side(wanted);
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
