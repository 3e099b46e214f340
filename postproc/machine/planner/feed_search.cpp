#include "postproc/machine/planner/feed_search.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "geometry/numeric/banded_cholesky.h"

namespace batten::postproc {
namespace {

using geometry::Vector3;

// Share of the way to the nearest limit that a step goes.
constexpr double kToLimit = 0.98;

// q may fall to this part of itself in one step: the time, 1 / sqrt(q), is modelled by its second
// derivative only.
constexpr double kLeastPart = 0.2;

// An equation between unknowns is a spring this much stiffer than all else at that place.
constexpr double kStiff = 1e8;

// c.x <= 1 and -c.x <= 1.
using LimitSides = Eigen::Array2d;

struct LimitRow {
  LimitWindow c{};
  LimitSides slack = LimitSides::Ones();
  LimitSides dual = LimitSides::Zero();
  LimitSides inverse = LimitSides::Ones();  // of the slack
  LimitSides missing = LimitSides::Zero();  // what the unknowns leave, less the slack
  LimitSides slack_step = LimitSides::Zero();
  LimitSides dual_step = LimitSides::Zero();
};

// q <= most, for one q.
struct LimitBound {
  double scale = 0;  // 1 / most, s^2/mm^2
  double slack = 1;  // as part of `most`
  double dual = 0;
  double inverse = 1;  // of the slack
  double missing = 0;
  double slack_step = 0;
  double dual_step = 0;

  [[nodiscard]] bool is_there() const { return scale > 0; }
};

// What the limits of a place add to the system of one step.
struct LimitSums {
  std::array<double, 6> square{};  // qq, pq, pp, rq, rp, rr
  LimitWindow base{};              // the right side, for a target of 0
  LimitWindow center{};            // what a target of 1 adds to it
  LimitWindow unexplained{};       // gradient of the time, and of the limits times their duals

  // The time so many mm / sqrt(q), given 1 / sqrt(q).
  void add_time(double length, double root) {
    const double inverse = root * root;
    const double slope = -0.5 * length * root * inverse;
    square[0] -= 1.5 * slope * inverse;
    base[0] -= slope;
    unexplained[0] += slope;
  }
};

// Over all limits.
struct LimitTally {
  LimitSides gap = LimitSides::Zero();  // s: slack * dual, summed in two halves
  double excess = 0;                    // the greatest part of its limit that a row is above it
};

// Reciprocals of how far a step may go, times how near to a limit it may come.
struct LimitReach {
  double primal = kToLimit;
  LimitSides slack = LimitSides::Constant(kToLimit);
  LimitSides dual = LimitSides::Constant(kToLimit);
};

double dot(const LimitWindow& c, const LimitWindow& x) {
  return c[0] * x[0] + c[1] * x[1] + c[2] * x[2];
}

void add_scaled(LimitWindow& sum, double w, const LimitWindow& c) {
  for (std::size_t i = 0; i < 3; ++i) sum[i] += w * c[i];
}

// What the sides of rows sum to that stand on the tangent of 1 / sqrt(q).
struct TangentSums {
  LimitSides square = LimitSides::Zero();
  LimitSides base = LimitSides::Zero();
  LimitSides center = LimitSides::Zero();
  LimitSides dual = LimitSides::Zero();
  LimitWindow mixed{};
};

// Goes these shares of the last step and adds what is needed for the next.
template <bool kJerk>
void add_row(LimitRow& row, const LimitWindow& x, double right, double primal, double dual,
             LimitSums& sums, TangentSums& tangent, LimitSides& room, LimitTally& tally) {
  const LimitWindow& c = row.c;
  const double left = dot(c, x);
  row.slack += primal * row.slack_step;
  row.dual += dual * row.dual_step;
  const LimitSides here(right - left, right + left);
  row.missing = here - row.slack;
  row.inverse = row.slack.inverse();
  const LimitSides weight = row.dual * row.inverse;
  const LimitSides toward = weight * row.missing;
  room = room.min(here);
  tally.gap += row.slack * row.dual;
  const double both = weight[0] + weight[1];
  const LimitWindow scaled = {both * c[0], both * c[1], both * c[2]};
  sums.square[0] += scaled[0] * c[0];
  sums.square[1] += scaled[1] * c[0];
  sums.square[2] += scaled[1] * c[1];
  sums.square[3] += scaled[2] * c[0];
  sums.square[4] += scaled[2] * c[1];
  sums.square[5] += scaled[2] * c[2];
  add_scaled(sums.base, toward[0] - toward[1], c);
  add_scaled(sums.center, row.inverse[1] - row.inverse[0], c);
  add_scaled(sums.unexplained, row.dual[0] - row.dual[1], c);
  if constexpr (kJerk) {
    tangent.square += weight;
    tangent.base += toward;
    tangent.center += row.inverse;
    tangent.dual += row.dual;
    add_scaled(tangent.mixed, weight[0] - weight[1], c);
  }
}

// All rows of a place; the first `jerk_rows` are those of the jerk, root = 1 / sqrt(q).
void add_rows(std::span<LimitRow> rows, std::size_t jerk_rows, const LimitWindow& x, double root,
              double primal, double dual, LimitSums& sums, LimitTally& tally) {
  TangentSums of_jerk;
  LimitSides jerk_room = LimitSides::Constant(root);
  LimitSides room = LimitSides::Ones();
  for (LimitRow& row : rows.first(jerk_rows)) {
    add_row<true>(row, x, root, primal, dual, sums, of_jerk, jerk_room, tally);
  }
  for (LimitRow& row : rows.subspan(jerk_rows)) {
    add_row<false>(row, x, 1, primal, dual, sums, of_jerk, room, tally);
  }
  const double jerk_excess = -jerk_room.minCoeff() * (x[0] * root);
  tally.excess = std::max({tally.excess, -room.minCoeff(), jerk_excess});
  const double tangent = 0.5 * root * root * root;  // 1 / sqrt(q) falls by that per q
  const LimitWindow& mixed = of_jerk.mixed;
  sums.square[0] += tangent * (tangent * of_jerk.square.sum() + 2 * mixed[0]);
  sums.square[1] += tangent * mixed[1];
  sums.square[3] += tangent * mixed[2];
  sums.base[0] += tangent * of_jerk.base.sum();
  sums.center[0] -= tangent * of_jerk.center.sum();
  sums.unexplained[0] += tangent * of_jerk.dual.sum();
}

// The steps of slacks and duals that belong to the change of (q, p, r).
void step_rows(std::span<LimitRow> rows, std::size_t jerk_rows, const LimitWindow& change,
               double root, double target, LimitReach& reach) {
  const double right = -0.5 * root * root * root * change[0];
  for (std::size_t i = 0; i < rows.size(); ++i) {
    LimitRow& row = rows[i];
    const double left = dot(row.c, change);
    const double moved = i < jerk_rows ? right : 0;
    row.slack_step = row.missing + LimitSides(moved - left, moved + left);
    row.dual_step = (target - row.dual * row.slack_step) * row.inverse - row.dual;
    reach.slack = reach.slack.max(-row.slack_step * row.inverse);
    reach.dual = reach.dual.max(-row.dual_step / row.dual);
  }
}

void add_bound(LimitBound& bound, double q, double primal, double dual, LimitSums& sums,
               LimitTally& tally) {
  if (!bound.is_there()) return;
  bound.slack += primal * bound.slack_step;
  bound.dual += dual * bound.dual_step;
  const double c = bound.scale;
  bound.missing = 1 - c * q - bound.slack;
  bound.inverse = 1 / bound.slack;
  tally.gap[0] += bound.slack * bound.dual;
  tally.excess = std::max(tally.excess, c * q - 1);
  const double weight = bound.dual * bound.inverse;
  sums.square[0] += weight * c * c;
  sums.base[0] += c * weight * bound.missing;
  sums.center[0] -= c * bound.inverse;
  sums.unexplained[0] += c * bound.dual;
}

void step_bound(LimitBound& bound, double dq, double target, LimitReach& reach) {
  if (!bound.is_there()) return;
  bound.slack_step = bound.missing - dq * bound.scale;
  bound.dual_step = (target - bound.dual * bound.slack_step) * bound.inverse - bound.dual;
  reach.primal = std::max(reach.primal, -bound.slack_step * bound.inverse);
  reach.dual[0] = std::max(reach.dual[0], -bound.dual_step / bound.dual);
}

LimitWindow window_at(const SearchPlace& place, const std::vector<double>& unknowns) {
  LimitWindow x{};
  for (std::size_t i = 0; i < place.width; ++i) {
    const double u = unknowns[place.first + i];
    x[0] += place.q[i] * u;
    x[1] += place.p[i] * u;
    x[2] += place.r[i] * u;
  }
  return x;
}

struct PlaceState {
  LimitWindow x{};  // q, p, r
  double root = 0;  // 1 / sqrt(q)
  LimitBound bound;
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
  void add_place(const SearchPlace& place, const LimitSums& sums);
  void add_arcs();
  void add_springs();
  void find_step(double target);
  [[nodiscard]] double unexplained() const;
  [[nodiscard]] std::span<LimitRow> rows_of(const SearchPlace& place) {
    return std::span(rows_).subspan(place.first_row, place.rows);
  }

  const SearchProblem& problem_;
  std::vector<double> x_;
  std::vector<LimitRow> rows_;
  std::vector<PlaceState> places_;
  std::vector<double> base_;  // the right side, then the step
  std::vector<double> center_;
  std::vector<double> unexplained_;
  geometry::BandedMatrix matrix_;
  LimitTally tally_;
  double sides_ = 0;
  double primal_share_ = 1;  // of the step
  double dual_share_ = 1;
};

Search::Search(const SearchProblem& problem, std::vector<double> start)
    : problem_(problem),
      x_(std::move(start)),
      rows_(problem.rows.size()),
      places_(problem.places.size()),
      matrix_(problem.unknowns) {
  sides_ = 2 * static_cast<double>(rows_.size());
  for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k].c = problem.rows[k];
  for (std::size_t k = 0; k < places_.size(); ++k) {
    places_[k].bound.scale = 1 / problem.places[k].most;
    sides_ += places_[k].bound.is_there() ? 1 : 0;
  }
}

void Search::find_states() {
  for (std::size_t k = 0; k < places_.size(); ++k) {
    places_[k].x = window_at(problem_.places[k], x_);
    places_[k].root = 1 / std::sqrt(places_[k].x[0]);
  }
}

double Search::seconds() const {
  double time = 0;
  for (std::size_t k = 0; k < places_.size(); ++k)
    time += problem_.places[k].time * places_[k].root;
  for (const ArcTime& arc : problem_.arcs) time += arc.seconds(x_[arc.unknown]);
  return time;
}

// All products slack * dual alike.
void Search::start_slacks(const SearchRule& rule) {
  find_states();
  const double product = rule.first_gap * seconds() / sides_;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const SearchPlace& place = problem_.places[k];
    PlaceState& at = places_[k];
    if (at.bound.is_there()) {
      at.bound.slack = std::max(1 - at.x[0] * at.bound.scale, rule.least_slack);
      at.bound.dual = product / at.bound.slack;
    }
    for (std::size_t i = 0; i < place.rows; ++i) {
      LimitRow& row = rows_[place.first_row + i];
      const double right = i < place.jerk_rows ? at.root : 1;
      const double left = dot(row.c, at.x);
      row.slack = LimitSides(right - left, right + left).max(rule.least_slack * right);
      row.dual = product / row.slack;
    }
  }
}

// H = W^T S W for the second derivatives S by (q, p, r).
void Search::add_place(const SearchPlace& place, const LimitSums& sums) {
  const auto& s = sums.square;
  for (std::size_t a = 0; a < place.width; ++a) {
    const LimitWindow w = {place.q[a], place.p[a], place.r[a]};
    const double by_q = s[0] * w[0] + s[1] * w[1] + s[3] * w[2];
    const double by_p = s[1] * w[0] + s[2] * w[1] + s[4] * w[2];
    const double by_r = s[3] * w[0] + s[4] * w[1] + s[5] * w[2];
    const std::size_t row = place.first + a;
    for (std::size_t b = 0; b <= a; ++b) {
      matrix_.at(row, static_cast<int>(a - b)) +=
          by_q * place.q[b] + by_p * place.p[b] + by_r * place.r[b];
    }
    base_[row] += dot(sums.base, w);
    center_[row] += dot(sums.center, w);
    unexplained_[row] += dot(sums.unexplained, w);
  }
}

void Search::add_arcs() {
  for (const ArcTime& arc : problem_.arcs) {
    const double v = std::sqrt(x_[arc.unknown]);
    const double sum = arc.speed + v;
    const double by_v = -arc.length / (sum * sum);
    matrix_.at(arc.unknown, 0) += (-2 * by_v / sum - by_v / v) / (4 * v * v);
    base_[arc.unknown] -= by_v / (2 * v);
    unexplained_[arc.unknown] += by_v / (2 * v);
  }
}

void Search::add_springs() {
  for (const UnknownPin& pin : problem_.pins) {
    const double stiff = kStiff * matrix_.at(pin.unknown, 0);
    matrix_.at(pin.unknown, 0) += stiff;
    base_[pin.unknown] += stiff * (pin.value - x_[pin.unknown]);
  }
  for (const auto& [tied, free, factor, offset] : problem_.ties) {
    const double stiff = kStiff * matrix_.at(tied, 0);
    const double missing = factor * x_[free] + offset - x_[tied];
    matrix_.at(tied, 0) += stiff;
    matrix_.at(free, 0) += stiff * factor * factor;
    matrix_.at(std::max(free, tied), 1) -= stiff * factor;
    base_[tied] += stiff * missing;
    base_[free] -= stiff * factor * missing;
  }
}

// Goes these shares of the last step and makes the system of the next.
void Search::assemble(double primal, double dual) {
  matrix_.reset(problem_.unknowns);
  for (auto* sums : {&base_, &center_, &unexplained_}) sums->assign(problem_.unknowns, 0);
  tally_ = {};
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const SearchPlace& place = problem_.places[k];
    PlaceState& at = places_[k];
    LimitSums sums;
    sums.add_time(place.time, at.root);
    add_bound(at.bound, at.x[0], primal, dual, sums, tally_);
    add_rows(rows_of(place), place.jerk_rows, at.x, at.root, primal, dual, sums, tally_);
    add_place(place, sums);
  }
  add_arcs();
  add_springs();
}

// Seconds that the time would change by, to first order and beyond what the duals explain, if each
// q were 0 instead, or twice as much: of unknowns that are q and p of a node in turn.
double Search::unexplained() const {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < x_.size(); i += 2) {
    const bool is_pinned =
        std::ranges::find(problem_.pins, i, &UnknownPin::unknown) != problem_.pins.end();
    if (is_pinned) continue;
    sum += std::abs(unexplained_[i] * x_[i] + unexplained_[i + 1] * x_[i + 1]);
  }
  return sum;
}

// The steps of slacks and duals that belong to the step of the unknowns, and how far they may go.
void Search::find_step(double target) {
  LimitReach reach;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const SearchPlace& place = problem_.places[k];
    PlaceState& at = places_[k];
    const LimitWindow change = window_at(place, base_);
    reach.primal = std::max(reach.primal, -kToLimit * change[0] / ((1 - kLeastPart) * at.x[0]));
    step_bound(at.bound, change[0], target, reach);
    step_rows(rows_of(place), place.jerk_rows, change, at.root, target, reach);
  }
  primal_share_ = kToLimit / std::max(reach.primal, reach.slack.maxCoeff());
  dual_share_ = kToLimit / reach.dual.maxCoeff();
}

SearchResult Search::run(const SearchRule& rule) {
  SearchResult result;
  start_slacks(rule);
  assemble(0, 0);
  double share = 0.5;
  for (int step = 0; step < rule.most_steps && !result.found; ++step) {
    const double gap = tally_.gap.sum();
    double wanted = std::max(rule.least_gap_part, 1 - share) * gap;
    if (rule.per_unexplained > 0) {
      wanted = std::max(wanted, std::min(gap, rule.per_unexplained * unexplained()));
    }
    const double target = wanted / sides_;
    for (std::size_t i = 0; i < base_.size(); ++i) base_[i] += target * center_[i];
    if (!matrix_.solve(base_)) break;
    find_step(target);
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += primal_share_ * base_[i];
    find_states();
    assemble(primal_share_, dual_share_);
    share = std::min(primal_share_, dual_share_);
    result.found = tally_.gap.sum() < rule.enough_gap * seconds() &&
                   tally_.excess < rule.enough_kept && share > 0.5;
  }
  result.excess = tally_.excess;
  result.seconds = seconds();
  result.unknowns = std::move(x_);
  return result;
}

// The greatest factor on all unknowns that keeps the limits, at most 1.
double allowed_factor(const SearchProblem& problem, const std::vector<double>& unknowns) {
  double factor = 1;
  for (const SearchPlace& place : problem.places) {
    const LimitWindow x = window_at(place, unknowns);
    factor = std::min(factor, place.most / x[0]);
    for (std::size_t k = 0; k < place.rows; ++k) {
      const double size = std::abs(dot(problem.rows[place.first_row + k], x));
      if (!(size > 0)) continue;
      const double ratio = k < place.jerk_rows ? 1 / (std::sqrt(x[0]) * size) : 1 / size;
      factor = std::min(factor, k < place.jerk_rows ? std::cbrt(ratio * ratio) : ratio);
    }
  }
  return factor;
}

}  // namespace

double ArcTime::seconds(double q) const { return length / (speed + std::sqrt(q)); }

void SearchProblem::add_row(double q, double p, double r, double limit, SearchPlace& place) {
  if (std::isinf(limit) || (q == 0 && p == 0 && r == 0)) return;
  rows.push_back({q / limit, p / limit, r / limit});
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
                                     double steepest, SearchPlace& place) {
  const LimitsAlong along = limits_along(x.first, limits);
  const double curvature = x.second.norm();
  place.most = along.speed * along.speed;
  if (curvature > 0) place.most = std::min(place.most, limits.normal_acceleration / curvature);
  if (x.is_straight()) {
    if (steepest >= along.acceleration) add_row(0, 0.5, 0, along.acceleration, place);
    return;
  }
  for (int i = 0; i < 3; ++i) {
    const double most = std::abs(x.second[i]) * place.most + std::abs(x.first[i]) * steepest;
    if (most < limits.acceleration[i]) continue;
    add_row(x.second[i], 0.5 * x.first[i], 0, limits.acceleration[i], place);
  }
  if (steepest >= limits.tangential_acceleration) {
    add_row(0, 0.5, 0, limits.tangential_acceleration, place);
  }
}

SearchResult fastest(const SearchProblem& problem, std::vector<double> start,
                     const SearchRule& rule) {
  return Search(problem, std::move(start)).run(rule);
}

void slow_down(const SearchProblem& problem, std::vector<double>& unknowns) {
  const double factor = allowed_factor(problem, unknowns);
  for (double& u : unknowns) u *= factor;
  for (const UnknownPin& pin : problem.pins) unknowns[pin.unknown] = pin.value;
}

}  // namespace batten::postproc
