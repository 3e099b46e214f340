#include "postproc/machine/feed_plan_problem.h"

#include <algorithm>
#include <cmath>

#include "postproc/machine/feed_plan_path.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

constexpr double kNone = KinematicPathLimits::kNone;

PlanWindow combined(double a, const PlanWindow& x, double b, const PlanWindow& y, double c,
                    const PlanWindow& z) {
  PlanWindow sum;
  for (int i = 0; i < 4; ++i) sum[i] = a * x[i] + b * y[i] + c * z[i];
  return sum;
}

class RowMaker {
 public:
  RowMaker(const KinematicPathLimits& limits, std::vector<PlanRow>& rows)
      : limits_(limits), rows_(rows) {}

  // Feed, speeds of the axes and normal acceleration are bounds on q.
  void add_speed(const LengthDerivatives& x, PlanPlace place, const PlanWeights& at) {
    const double speed = limits_along(x.first, limits_).speed;
    double most = speed * speed;
    const double curvature = x.second.norm();
    if (curvature > 0) most = std::min(most, limits_.normal_acceleration / curvature);
    add(PlanLimit::kUpper, place, combined(1 / most, at.q, 0, at.q, 0, at.q));
  }

  void add_bound(double speed, PlanPlace place, const PlanWeights& at) {
    if (std::isinf(speed)) return;
    add(PlanLimit::kUpper, place, combined(1 / (speed * speed), at.q, 0, at.q, 0, at.q));
  }

  void add_acceleration(const LengthDerivatives& x, PlanPlace place, const PlanWeights& at) {
    const auto row = [&](double second, double first, double limit) {
      if (std::isinf(limit) || (second == 0 && first == 0)) return;
      add(PlanLimit::kEven, place,
          combined(second / limit, at.q, first / (2 * limit), at.p, 0, at.r));
    };
    if (straight(x)) return row(0, 1, limits_along(x.first, limits_).acceleration);
    for (int i = 0; i < 3; ++i) row(x.second[i], x.first[i], limits_.acceleration[i]);
    row(0, 1, limits_.tangential_acceleration);
  }

  void add_jerk(const LengthDerivatives& x, PlanPlace place, const PlanWeights& at) {
    const auto row = [&](double third, double second, double first, double limit) {
      if (std::isinf(limit) || (third == 0 && second == 0 && first == 0)) return;
      add(PlanLimit::kJerk, place,
          combined(third / limit, at.q, 1.5 * second / limit, at.p, 0.5 * first / limit, at.r));
    };
    if (straight(x)) return row(0, 0, 1, limits_along(x.first, limits_).jerk);
    for (int i = 0; i < 3; ++i) row(x.third[i], x.second[i], x.first[i], limits_.jerk[i]);
    row(0, 0, 1, limits_.tangential_jerk);
  }

 private:
  static bool straight(const LengthDerivatives& x) {
    return x.second == Vector3::Zero() && x.third == Vector3::Zero();
  }
  void add(PlanLimit limit, PlanPlace place, const PlanWindow& c) {
    rows_.push_back({c, limit, place});
  }

  const KinematicPathLimits& limits_;
  std::vector<PlanRow>& rows_;
};

// The speed, one interval away from rest, at which the interval from rest keeps the jerk: its
// terms, each at the greater end, all of one sign.
double speed_after_rest(const PathPiece& piece, const GridInterval& interval, const PlanRest& rest,
                        const KinematicPathLimits& limits) {
  const LengthDerivatives a = derivatives_by_length(piece, interval.t0);
  const LengthDerivatives b = derivatives_by_length(piece, interval.t1);
  const double power = 2 * rest.power;
  const double by_p = 1.5 * power / rest.length;
  const double by_r = 0.5 * power * (power - 1) / (rest.length * rest.length);
  const auto greater = [](const Vector3& x, const Vector3& y) {
    return Vector3(x.cwiseAbs().cwiseMax(y.cwiseAbs()));
  };
  const Vector3 jerk = greater(a.third, b.third) + by_p * greater(a.second, b.second) +
                       by_r * greater(a.first, b.first);
  double cubed = by_r > 0 ? limits.tangential_jerk / by_r : kNone;
  for (int i = 0; i < 3; ++i) {
    if (jerk[i] > 0) cubed = std::min(cubed, limits.jerk[i] / jerk[i]);
  }
  return std::cbrt(cubed);
}

bool jerk_is_limited(const KinematicPathLimits& limits) {
  return !std::isinf(std::min(limits.jerk.minCoeff(), limits.tangential_jerk));
}

}  // namespace

PlanWeights plan_weights(PlanPlace place, double length) {
  const double h = length;
  const double k = 6 / (h * h);
  switch (place) {
    case PlanPlace::kStart:
      return {{1, 0, 0, 0}, {0, 1, 0, 0}, {-k, -4 / h, k, -2 / h}};
    case PlanPlace::kEnd:
      return {{0, 0, 1, 0}, {0, 0, 0, 1}, {k, 2 / h, -k, 4 / h}};
    case PlanPlace::kMiddle:
      break;
  }
  return {{0.5, h / 8, 0.5, -h / 8}, {-1.5 / h, -0.25, 1.5 / h, -0.25}, {0, -1 / h, 0, 1 / h}};
}

PlanProblem make_plan_problem(std::span<const PathPiece> pieces, const PlanGrid& grid,
                              const KinematicPathLimits& limits) {
  PlanProblem problem;
  const bool from_rest = grid.bounds.front() == 0;
  const bool to_rest = grid.bounds.back() == 0;
  const double power = jerk_is_limited(limits) ? 2.0 / 3 : 0.5;
  const std::size_t first = from_rest ? 1 : 0;
  const std::size_t last = grid.intervals.size() - (to_rest ? 1 : 0);
  if (from_rest) problem.start = {grid.intervals.front().length, power};
  if (to_rest) problem.end = {grid.intervals.back().length, power};

  RowMaker maker(limits, problem.rows);
  for (std::size_t k = first; k < last; ++k) {
    const GridInterval& interval = grid.intervals[k];
    const PathPiece& piece = pieces[interval.piece];
    problem.first_rows.push_back(problem.rows.size());
    problem.lengths.push_back(interval.length);
    const auto add = [&](PlanPlace place, double t, bool with_acceleration) {
      const LengthDerivatives x = derivatives_by_length(piece, t);
      const PlanWeights at = plan_weights(place, interval.length);
      if (with_acceleration) maker.add_speed(x, place, at);
      if (with_acceleration) maker.add_acceleration(x, place, at);
      maker.add_jerk(x, place, at);
    };
    // Speed and acceleration run on from the end of the interval before, unless the bend jumps.
    const bool new_piece = k == first || grid.intervals[k - 1].piece != interval.piece;
    add(PlanPlace::kStart, interval.t0, new_piece);
    add(PlanPlace::kMiddle, middle_of(piece, interval), true);
    add(PlanPlace::kEnd, interval.t1, true);
    const PlanWeights start = plan_weights(PlanPlace::kStart, interval.length);
    const PlanWeights end = plan_weights(PlanPlace::kEnd, interval.length);
    maker.add_bound(grid.bounds[k], PlanPlace::kStart, start);
    if (k == first && from_rest) {
      const GridInterval& rest = grid.intervals.front();
      maker.add_bound(speed_after_rest(pieces[rest.piece], rest, problem.start, limits),
                      PlanPlace::kStart, start);
    }
    if (k + 1 == last) {
      double bound = kNone;
      if (!to_rest) bound = grid.bounds[k + 1];
      maker.add_bound(bound, PlanPlace::kEnd, end);
      if (to_rest) {
        const GridInterval& rest = grid.intervals.back();
        maker.add_bound(speed_after_rest(pieces[rest.piece], rest, problem.end, limits),
                        PlanPlace::kEnd, end);
      }
    }
  }
  problem.first_rows.push_back(problem.rows.size());
  return problem;
}

PlanState state_in(const double* w, double length, double s) {
  const double rise = (w[2] - w[0]) / length;
  const double r0 = (6 * rise - 4 * w[1] - 2 * w[3]) / length;
  const double third = 6 * (w[1] + w[3] - 2 * rise) / (length * length);
  return {w[0] + s * (w[1] + s * (r0 / 2 + s * third / 6)), w[1] + s * (r0 + s * third / 2),
          r0 + s * third};
}

// One Newton step from the middle by parameter.
double middle_of(const PathPiece& piece, const GridInterval& interval) {
  const double t = 0.5 * (interval.t0 + interval.t1);
  const double missing = 0.5 * interval.length - length_between(piece, interval.t0, t);
  const double rate = length_between(piece, interval.t0, interval.t1) / (interval.t1 - interval.t0);
  const double quarter = 0.25 * (interval.t1 - interval.t0);
  return t + std::clamp(missing / rate, -quarter, quarter);
}

double interval_seconds(double length, const double* w) {
  const double middle = 0.5 * (w[0] + w[2]) + length / 8 * (w[1] - w[3]);
  return length / 6 * (1 / std::sqrt(w[0]) + 4 / std::sqrt(middle) + 1 / std::sqrt(w[2]));
}

double planned_seconds(const PlanProblem& problem, std::span<const double> x) {
  const std::size_t n = problem.intervals();
  double time = problem.start.time() / std::sqrt(x[0]) + problem.end.time() / std::sqrt(x[2 * n]);
  for (std::size_t i = 0; i < n; ++i) {
    time += interval_seconds(problem.lengths[i], x.data() + 2 * i);
  }
  return time;
}

}  // namespace batten::postproc
