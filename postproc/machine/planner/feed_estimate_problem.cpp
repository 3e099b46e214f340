#include "postproc/machine/planner/feed_estimate_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {
namespace {

using geometry::Vector3;

class ProblemMaker {
 public:
  ProblemMaker(std::span<const geometry::PathPiece> path, const EstimateStretch& stretch,
               const KinematicPathLimits& limits);

  EstimateProblem problem;

 private:
  void make_rows(EstimateCell& cell, const LengthDerivatives& x);
  void add_row(double q, double p, double r, double limit);
  void set_knots(const EstimateStretch& stretch);
  void set_ends(const EstimateStretch& stretch, const LengthDerivatives& first,
                const LengthDerivatives& last);

  const KinematicPathLimits& limits_;
};

ProblemMaker::ProblemMaker(std::span<const geometry::PathPiece> path,
                           const EstimateStretch& stretch, const KinematicPathLimits& limits)
    : limits_(limits) {
  problem.cells.resize(stretch.intervals.size());
  problem.knots.resize(stretch.intervals.size() + 1);
  problem.rows.reserve(4 * problem.cells.size());
  LengthDerivatives first;
  LengthDerivatives x;
  for (std::size_t k = 0; k < problem.cells.size(); ++k) {
    const EstimateInterval& interval = stretch.intervals[k];
    EstimateCell& cell = problem.cells[k];
    x = derivatives_by_length(path[interval.piece], interval.t);
    if (k == 0) first = x;
    cell.length = interval.length;
    make_rows(cell, x);
    cell.most = std::min(cell.most, interval.inner_bound * interval.inner_bound);
  }
  set_knots(stretch);
  set_ends(stretch, first, x);
}

void ProblemMaker::add_row(double q, double p, double r, double limit) {
  if (std::isinf(limit) || (q == 0 && p == 0 && r == 0)) return;
  problem.rows.push_back({q / limit, p / limit, r / limit});
}

// mm/s^2: between rest and the greatest speed limited jerk comes to sqrt(J v). A bend may add to
// the jerk along the path, so that much more; limits that are farther away are left out.
double steepest_along(const LimitsAlong& along) {
  constexpr double kMore = 1.5;
  return kMore * std::sqrt(along.jerk * along.speed);
}

void ProblemMaker::make_rows(EstimateCell& cell, const LengthDerivatives& x) {
  const LimitsAlong along = limits_along(x.first, limits_);
  const double curvature = x.second.norm();
  cell.most = along.speed * along.speed;
  if (curvature > 0) {
    cell.most = std::min(cell.most, limits_.normal_acceleration / curvature);
  }
  cell.first_row = problem.rows.size();
  const bool straight = curvature == 0 && x.third == Vector3::Zero();
  if (straight) {
    add_row(0, 0, 0.5, along.jerk);
    cell.jerk_rows = problem.rows.size() - cell.first_row;
    if (steepest_along(along) >= along.acceleration) add_row(0, 0.5, 0, along.acceleration);
  } else {
    for (int i = 0; i < 3; ++i) {
      add_row(x.third[i], 1.5 * x.second[i], 0.5 * x.first[i], limits_.jerk[i]);
    }
    add_row(0, 0, 0.5, limits_.tangential_jerk);
    cell.jerk_rows = problem.rows.size() - cell.first_row;
    const double steepest = steepest_along(along);
    for (int i = 0; i < 3; ++i) {
      const double most = std::abs(x.second[i]) * cell.most + std::abs(x.first[i]) * steepest;
      if (most < limits_.acceleration[i]) continue;
      add_row(x.second[i], 0.5 * x.first[i], 0, limits_.acceleration[i]);
    }
    if (steepest >= limits_.tangential_acceleration) {
      add_row(0, 0.5, 0, limits_.tangential_acceleration);
    }
  }
  cell.rows = problem.rows.size() - cell.first_row;
}

void ProblemMaker::set_knots(const EstimateStretch& stretch) {
  const std::size_t n = problem.cells.size();
  for (std::size_t k = 0; k <= n; ++k) {
    const double before = k > 0 ? problem.cells[k - 1].length : 0;
    const double after = k < n ? problem.cells[k].length : 0;
    EstimateKnot& knot = problem.knots[k];
    knot.before = after / (before + after);
    knot.after = before / (before + after);
    knot.weight = (before + after) / 6;
    if (k > 0) {
      const double bound = stretch.intervals[k - 1].end_bound;
      knot.most = bound * bound;
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    EstimateCell& cell = problem.cells[k];
    const double h = cell.length;
    const EstimateKnot& from = problem.knots[k];
    const EstimateKnot& to = problem.knots[k + 1];
    // q at the ends as sums over the ordinates k, k + 1, k + 2.
    const LimitWindow q0 = {from.before, from.after, 0};
    const LimitWindow q1 = {0, to.before, to.after};
    for (int i = 0; i < 3; ++i) {
      const double middle = i == 1 ? 1 : 0;
      cell.q_of[i] = 0.25 * (q0[i] + q1[i]) + 0.5 * middle;
      cell.p_of[i] = (q1[i] - q0[i]) / h;
      cell.r_of[i] = 2 * (q0[i] + q1[i] - 2 * middle) / (h * h);
    }
  }
}

// The greatest speed at the end of an arc of constant jerk that begins at v0 without acceleration:
// jerk = 2 (v - v0) (v + 2 v0)^2 / (9 h^2).
double speed_after_arc(double v0, double length, double jerk) {
  const double most = 4.5 * jerk * length * length;
  double v = v0 + std::cbrt(most);
  constexpr int kSteps = 20;  // Newton, from above
  for (int i = 0; i < kSteps; ++i) {
    const double b = v + 2 * v0;
    const double step = ((v - v0) * b * b - most) / (b * (b + 2 * (v - v0)));
    v -= step;
    if (std::abs(step) <= 1e-12 * v) break;
  }
  return v;
}

void ProblemMaker::set_ends(const EstimateStretch& stretch, const LengthDerivatives& first,
                            const LengthDerivatives& last) {
  const auto set = [&](const EstimateEnd& end, const LengthDerivatives& x, double beside,
                       EstimateKnot& knot, EstimateTie& tie) {
    const double q = end.speed * end.speed;
    switch (end.kind) {
      case EstimateEnd::Kind::kFree:
        knot.most = std::min(knot.most, q);
        break;
      case EstimateEnd::Kind::kSlow:
      case EstimateEnd::Kind::kMoving:
        tie.pins = true;
        tie.value = q;
        tie.next = q + end.acceleration * beside;
        break;
      case EstimateEnd::Kind::kArc: {
        const LimitsAlong along = limits_along(x.first, limits_);
        const double v0 = end.speed;
        const double h = end.length;
        const bool jerk = !std::isinf(along.jerk);
        const double v =
            jerk ? speed_after_arc(v0, h, along.jerk) : std::sqrt(q + 2 * along.acceleration * h);
        knot.most = std::min(knot.most, v * v);
        // p = 4 (v - v0) (v + 2 v0) / (3 h), v0 v taken at the greatest; without jerk limit
        // (v^2 - v0^2) / h.
        const double rate = (jerk ? 4.0 / 3 : 1.0) / h;
        const double offset = jerk ? v0 * v - 2 * q : -q;
        tie.ties = true;
        tie.factor = 1 + rate * beside / 2;
        tie.offset = rate * beside / 2 * offset;
        tie.arc_length = jerk ? 3 * h : 2 * h;
        tie.arc_speed = jerk ? 2 * v0 : v0;
        break;
      }
    }
  };
  set(stretch.start, first, problem.cells.front().length, problem.knots.front(), problem.start);
  set(stretch.end, last, problem.cells.back().length, problem.knots.back(), problem.end);
}

}  // namespace

EstimateProblem make_estimate_problem(std::span<const geometry::PathPiece> path,
                                      const EstimateStretch& stretch,
                                      const KinematicPathLimits& limits) {
  return std::move(ProblemMaker(path, stretch, limits).problem);
}

}  // namespace batten::postproc
