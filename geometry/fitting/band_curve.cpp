#include "geometry/fitting/band_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/fitting/band_problem.h"

namespace batten::geometry {

namespace {

// The barrier counts for less by this factor as soon as a curve is near its least: some four
// Newton steps each.
constexpr double kSharpen = 20;

// A squared Newton decrement below which a curve is near the least of the barrier function, and
// one below which it is there.
constexpr double kNear = 0.5;
constexpr double kThere = 1e-3;

// A start outside is inside a band widened by this much more than it needs.
constexpr double kWider = 1.05;

// The band is no longer widened when the greatest ratio is below this: strictly inside, so that
// the barrier is finite.
constexpr double kInside = 0.9999;

// The part that the energy at the start has in what is made least, beside the widening.
constexpr double kTrace = 1e-3;

int rates_never() { return std::numeric_limits<int>::max(); }

class BandSolver {
 public:
  BandSolver(const BandProblem& problem, std::vector<Point3> start, int rates_from,
             const BarrierOptions& options)
      : problem_(problem), options_(options), band_(band_rows(problem, rates_from)) {
    if (start.size() != problem.basis.size()) {
      throw std::invalid_argument("solve_band: " + std::to_string(start.size()) +
                                  " points to start with, expected " +
                                  std::to_string(problem.basis.size()));
    }
    at_.points = std::move(start);
    for (const HeldPoint& held : problem.held) {
      Point3& p = at_.points[held.index];
      p = held.place + held.free * (p - held.place);
    }
  }

  BandCurve least_energy() {
    const BandEnd end = get_inside() ? descend() : BandEnd::kOutside;
    return result(end, band_.worst_ratio(at_.points, false));
  }

  BandCurve least_ratio() {
    BandEnd end = BandEnd::kOutside;
    if (get_inside()) end = shrink(Widening::kRates, 0);
    return result(end, band_.worst_ratio(at_.points, true));
  }

 private:
  [[nodiscard]] BandCurve result(BandEnd end, double worst_ratio) const {
    return {BsplineCurve(problem_.basis, at_.points), end, band_.energy(at_.points), worst_ratio,
            steps_};
  }

  [[nodiscard]] BandBarrier barrier(Widening widening) const {
    return {band_, problem_.held, at_.points.size(), widening};
  }

  bool get_inside() {
    if (band_.worst_ratio(at_.points, false) < 1) return true;
    shrink(Widening::kPlaces, kInside);
    return band_.worst_ratio(at_.points, false) < 1;
  }

  // Makes the greatest ratio as small as it gets, or just smaller than `enough`.
  BandEnd shrink(Widening widening, double enough) {
    BandBarrier f = barrier(widening);
    const bool rates = widening == Widening::kRates;
    at_.wide = kWider * band_.worst_ratio(at_.points, rates);
    if (!(at_.wide > 0)) return BandEnd::kLeast;
    const double energy = std::max(band_.energy(at_.points), band_.energy_of_moves());
    f.price = 1;
    f.energy = energy > 0 ? kTrace * at_.wide / energy : 0;
    f.weight = f.gap_times_weight() / at_.wide;
    return follow(
        f, [&] { return band_.worst_ratio(at_.points, rates) < enough; },
        [&] { return f.gap_times_weight() <= options_.gap * at_.wide * f.weight; });
  }

  // Makes the energy as small as it gets inside the band.
  BandEnd descend() {
    BandBarrier f = barrier(Widening::kNone);
    at_.wide = 1;
    const double noise = band_.energy_noise(at_.points);
    const double start = std::max(band_.energy(at_.points), noise);
    if (!(start > 0)) return BandEnd::kLeast;  // nothing has an energy: a line on one place
    f.energy = 1 / start;
    f.weight = f.gap_times_weight();
    return follow(
        // A straight run has no energy, and what is left of it is rounding.
        f, [&] { return band_.energy(at_.points) <= noise; },
        [&] {
          const double left = std::max(options_.gap * band_.energy(at_.points), noise);
          return f.gap_times_weight() * start <= left * f.weight;
        });
  }

  // Until it is `enough`, or the barrier so sharp that its least is the least of what is priced.
  template <typename Enough, typename Sharp>
  BandEnd follow(BandBarrier& f, const Enough& enough, const Sharp& sharp) {
    while (steps_ < options_.max_steps) {
      const auto decrement = f.step(at_);
      ++steps_;
      if (enough()) return BandEnd::kLeast;
      const bool last = sharp();
      if (!decrement || *decrement < (last ? kThere : kNear)) {
        if (last) return BandEnd::kLeast;
        f.weight *= kSharpen;
      }
    }
    return BandEnd::kStepLimit;
  }

  const BandProblem& problem_;
  BarrierOptions options_;
  BandRows band_;
  BarrierPoint at_;
  int steps_ = 0;
};

}  // namespace

BandCurve solve_band(const BandProblem& problem, std::vector<Point3> start,
                     const BarrierOptions& options) {
  return BandSolver(problem, std::move(start), rates_never(), options).least_energy();
}

BandCurve least_ratio_in_band(const BandProblem& problem, std::vector<Point3> start,
                              int from_derivative, const BarrierOptions& options) {
  return BandSolver(problem, std::move(start), from_derivative, options).least_ratio();
}

namespace {

using Eigen::Matrix3d;

// Added to the diagonal in parts of itself: what the band and the energy leave free (a straight
// run may slide along itself) must not make the system singular. Ten thousand times the rounding
// of a pivot, and too little to slow any step down.
constexpr double kDamping = 1e-12;
constexpr int kMoreDamping = 6;  // times a hundred each, where rounding still wins

// No step goes further towards the edge of the band than this part of the way.
constexpr double kMostOfTheWay = 0.99;

double dot(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

// The lower triangle with l * l^T = m; of `m` only the lower half is read.
bool lower_root(Matrix3d& m) {
  Matrix3d l = Matrix3d::Zero();
  for (int j = 0; j < 3; ++j) {
    for (int i = j; i < 3; ++i) {
      double sum = m(i, j);
      for (int k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
      if (i > j) {
        l(i, j) = sum / l(j, j);
        continue;
      }
      if (!(sum > 0)) return false;
      l(j, j) = std::sqrt(sum);
    }
  }
  m = l;
  return true;
}

// x * l^-T, l lower.
void divide_by_transposed(Matrix3d& x, const Matrix3d& l) {
  for (int i = 0; i < 3; ++i) {
    x(i, 0) /= l(0, 0);
    x(i, 1) = (x(i, 1) - x(i, 0) * l(1, 0)) / l(1, 1);
    x(i, 2) = (x(i, 2) - x(i, 0) * l(2, 0) - x(i, 1) * l(2, 1)) / l(2, 2);
  }
}

void forwards(const Matrix3d& l, Point3& x) {
  x[0] /= l(0, 0);
  x[1] = (x[1] - l(1, 0) * x[0]) / l(1, 1);
  x[2] = (x[2] - l(2, 0) * x[0] - l(2, 1) * x[1]) / l(2, 2);
}

void backwards(const Matrix3d& l, Point3& x) {
  x[2] /= l(2, 2);
  x[1] = (x[1] - l(2, 1) * x[2]) / l(1, 1);
  x[0] = (x[0] - l(1, 0) * x[1] - l(2, 0) * x[2]) / l(0, 0);
}

}  // namespace

void BlockBandedMatrix::set_zero() {
  for (Row& row : rows_) row.fill(Matrix3d::Zero());
}

void BlockBandedMatrix::restrict(std::size_t i, const Matrix3d& free) {
  const std::size_t before = std::min(i, kBands);
  for (std::size_t k = 1; k <= before; ++k) rows_[i][k] = free * rows_[i][k];
  for (std::size_t k = 1; k <= kBands && i + k < rows_.size(); ++k) {
    rows_[i + k][k] = rows_[i + k][k] * free;
  }
  rows_[i][0] = free * rows_[i][0] * free + (Matrix3d::Identity() - free);
}

bool BlockBandedMatrix::factor() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[i];
    const std::size_t before = std::min(i, kBands);
    for (std::size_t k = before; k >= 1; --k) {
      for (std::size_t m = k + 1; m <= before; ++m) {
        row[k].noalias() -= row[m] * rows_[i - k][m - k].transpose();
      }
      divide_by_transposed(row[k], rows_[i - k][0]);
    }
    for (std::size_t k = 1; k <= before; ++k) row[0].noalias() -= row[k] * row[k].transpose();
    if (!lower_root(row[0])) return false;
  }
  return true;
}

void BlockBandedMatrix::solve(std::vector<Point3>& right) const {
  const std::size_t n = rows_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = std::min(i, kBands);
    for (std::size_t k = 1; k <= before; ++k) right[i].noalias() -= rows_[i][k] * right[i - k];
    forwards(rows_[i][0], right[i]);
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = 1; k <= kBands && i + k < n; ++k) {
      right[i].noalias() -= rows_[i + k][k].transpose() * right[i + k];
    }
    backwards(rows_[i][0], right[i]);
  }
}

BandBarrier::BandBarrier(const BandRows& band, const std::vector<HeldPoint>& held,
                         std::size_t points, Widening widening)
    : band_(band), held_(held), widening_(widening), hessian_(points), factors_(points) {
  for (const BandRow& row : band.rows) {
    if (takes_part(row)) gap_times_weight_ += 2;
  }
}

bool BandBarrier::takes_part(const BandRow& row) const {
  return !(row.rate && widening_ == Widening::kPlaces);
}

bool BandBarrier::is_widened(const BandRow& row) const {
  return widening_ == (row.rate ? Widening::kRates : Widening::kPlaces);
}

void BandBarrier::add(const BandCombination& value, const Vector3& gradient,
                      const Eigen::Matrix3d& curvature) {
  for (std::size_t i = 0; i < 4; ++i) {
    gradient_[value.first + i] += value.weights[i] * gradient;
    for (std::size_t j = 0; j <= i; ++j) {
      hessian_.at(value.first + i, i - j).noalias() +=
          (value.weights[i] * value.weights[j]) * curvature;
    }
  }
}

void BandBarrier::add_mixed(const BandCombination& value, const Vector3& mixed) {
  for (std::size_t i = 0; i < 4; ++i) mixed_[value.first + i] += value.weights[i] * mixed;
}

// -log(f^2 - |e|^2), e = across (value - foot) / radius, f the widening.
void BandBarrier::add_row(const BandRow& row, const BarrierPoint& at) {
  const Vector3 off = row.value.of(at.points) - row.foot;
  const Vector3 e = row.across * off / row.radius;
  const double f = is_widened(row) ? at.wide : 1;
  const double left = 1 / (f * f - e.squaredNorm());
  const double r = row.radius;
  add(row.value, 2 * left / r * e,
      2 * left / (r * r) * row.across + 4 * left * left / (r * r) * e * e.transpose());
  if (is_widened(row)) {
    wide_gradient_ -= 2 * f * left;
    wide_curvature_ += 4 * f * f * left * left - 2 * left;
    add_mixed(row.value, -4 * f * left * left / r * e);
  }
}

void BandBarrier::add_energy(const BarrierPoint& at) {
  const double priced = 2 * weight * energy;
  for (const EnergyTerm& term : band_.terms) {
    const Eigen::Matrix3d metric = priced * term.metric;
    add(term.value, metric * term.value.of(at.points), metric);
  }
}

void BandBarrier::assemble(const BarrierPoint& at) {
  hessian_.set_zero();
  gradient_.assign(at.points.size(), Point3::Zero());
  mixed_.assign(at.points.size(), Point3::Zero());
  wide_gradient_ = weight * price;
  wide_curvature_ = 0;
  add_energy(at);
  for (const BandRow& row : band_.rows) {
    if (takes_part(row)) add_row(row, at);
  }
  for (const HeldPoint& held : held_) {
    hessian_.restrict(held.index, held.free);
    gradient_[held.index] = held.free * gradient_[held.index];
    mixed_[held.index] = held.free * mixed_[held.index];
  }
}

bool BandBarrier::factor() {
  double damping = kDamping;
  for (int attempt = 0; attempt < kMoreDamping; ++attempt, damping *= 100) {
    factors_ = hessian_;
    for (std::size_t i = 0; i < factors_.size(); ++i) {
      factors_.at(i, 0).diagonal() *= 1 + damping;
    }
    if (factors_.factor()) return true;
  }
  return false;
}

std::optional<BandBarrier::Direction> BandBarrier::direction(const BarrierPoint& at) {
  assemble(at);
  if (!factor()) return std::nullopt;
  Direction found;
  found.points = gradient_;
  for (Point3& p : found.points) p = -p;
  factors_.solve(found.points);
  if (widening_ != Widening::kNone) {
    // The system has one more row and column: eliminated.
    std::vector<Point3> other = mixed_;
    factors_.solve(other);
    const double curvature = wide_curvature_ - dot(mixed_, other);
    if (!(curvature > 0)) return std::nullopt;
    found.wide = (-wide_gradient_ - dot(mixed_, found.points)) / curvature;
    for (std::size_t i = 0; i < other.size(); ++i) found.points[i] -= found.wide * other[i];
  }
  // What rounding leaks into directions that a held point may not take.
  for (const HeldPoint& held : held_) {
    found.points[held.index] = held.free * found.points[held.index];
  }
  found.decrement = -dot(gradient_, found.points) - wide_gradient_ * found.wide;
  return found;
}

void BandBarrier::find_lines(const BarrierPoint& at, const Direction& along) {
  lines_.clear();
  for (const BandRow& row : band_.rows) {
    if (!takes_part(row)) continue;
    const Vector3 off = row.value.of(at.points) - row.foot;
    const Vector3 change = row.value.of(along.points);
    const Vector3 e = row.across * off / row.radius;
    const Vector3 de = row.across * change / row.radius;
    const double f = is_widened(row) ? at.wide : 1;
    const double df = is_widened(row) ? along.wide : 0;
    lines_.push_back({f * f - e.squaredNorm(), f * df - e.dot(de), df * df - de.squaredNorm()});
  }
}

double BandBarrier::best_length(const BarrierPoint& at, const Direction& along) {
  find_lines(at, along);
  double farthest = std::numeric_limits<double>::infinity();
  for (const Line& line : lines_) {
    const double square = line.slope * line.slope - line.value * line.bend;
    if (square < 0) continue;
    const double below = std::sqrt(square) - line.slope;
    if (below > 0) farthest = std::min(farthest, line.value / below);
  }
  double slope = price * along.wide;
  double bend = 0;
  for (const EnergyTerm& term : band_.terms) {
    const Vector3 change = 2 * energy * term.metric * term.value.of(along.points);
    slope += change.dot(term.value.of(at.points));
    bend += change.dot(term.value.of(along.points));
  }
  // First and second derivative of the function along the direction.
  const auto derivatives = [&](double a) {
    double first = weight * (slope + a * bend);
    double second = weight * bend;
    for (const Line& line : lines_) {
      const double value = line.value + a * (2 * line.slope + a * line.bend);
      const double change = 2 * (line.slope + a * line.bend) / value;
      first -= change;
      second += change * change - 2 * line.bend / value;
    }
    return std::pair(first, second);
  };
  // The function is convex: a search between a place where it falls and one where it rises.
  constexpr double kNearEnough = 0.1;
  constexpr int kTries = 20;
  const double at_start = std::abs(derivatives(0).first);
  double low = 0;
  double high = std::min(1.0, kMostOfTheWay * farthest);
  double length = high;
  for (int i = 0; i < kTries; ++i) {
    const auto [first, second] = derivatives(length);
    if (std::abs(first) <= kNearEnough * at_start || (first < 0 && length == high)) return length;
    (first < 0 ? low : high) = length;
    length -= first / second;
    if (!(length > low && length < high)) length = 0.5 * (low + high);
  }
  return low;
}

std::optional<double> BandBarrier::step(BarrierPoint& at) {
  const auto along = direction(at);
  if (!along || !(along->decrement > 0)) return std::nullopt;
  const double length = best_length(at, *along);
  if (!(length > 0)) return std::nullopt;
  for (std::size_t i = 0; i < at.points.size(); ++i) at.points[i] += length * along->points[i];
  at.wide += length * along->wide;
  return along->decrement;
}

}  // namespace batten::geometry
