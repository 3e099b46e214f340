#include "geometry/fitting/band_curve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/basic/operations.h"

namespace batten::geometry {

namespace {

using Eigen::Matrix3d;

// Four neighbouring control points, and the weights that make one value of them.
struct BandCombination {
  std::size_t first = 0;
  std::array<double, 4> weights{};

  [[nodiscard]] Vector3 of(const std::vector<Point3>& points) const {
    return weights[0] * points[first] + weights[1] * points[first + 1] +
           weights[2] * points[first + 2] + weights[3] * points[first + 3];
  }
};

// The value of the combination keeps |across (value - foot)| <= radius.
struct BandRow {
  BandCombination value;
  Point3 foot = Point3::Zero();
  Matrix3d across = Matrix3d::Identity();  // projector
  double radius = 1;
  bool rate = false;  // its radius may be widened by itself, as least_ratio_in_band does
};

// Adds value^T metric value.
struct EnergyTerm {
  BandCombination value;
  Matrix3d metric = Matrix3d::Identity();
};

struct BandRows {
  std::vector<BandRow> rows;
  std::vector<EnergyTerm> terms;

  [[nodiscard]] double energy(const std::vector<Point3>& points) const {
    double sum = 0;
    for (const EnergyTerm& term : terms) {
      const Vector3 value = term.value.of(points);
      sum += value.dot(term.metric * value);
    }
    return sum;
  }

  // What the energy rises to, at most, when control points are moved by the greatest radius of a
  // row that is no rate.
  [[nodiscard]] double energy_of_moves() const {
    double radius = 0;
    for (const BandRow& row : rows) {
      if (!row.rate) radius = std::max(radius, row.radius);
    }
    double sum = 0;
    for (const EnergyTerm& term : terms) {
      double size = 0;
      for (const double weight : term.value.weights) size += std::abs(weight) * radius;
      sum += term.metric.trace() * size * size;
    }
    return sum;
  }

  // What rounding of the points alone makes of the energy of a straight line.
  [[nodiscard]] double energy_noise(const std::vector<Point3>& points) const {
    double sum = 0;
    for (const EnergyTerm& term : terms) {
      double size = 0;
      for (std::size_t j = 0; j < 4; ++j) {
        size += std::abs(term.value.weights[j]) * points[term.value.first + j].norm();
      }
      sum += term.metric.trace() * std::pow(kBandTuning.rounding * size, 2);
    }
    return sum;
  }

  // The greatest distance over radius of the rows that are (are not) rates.
  [[nodiscard]] double worst_ratio(const std::vector<Point3>& points, bool rates) const {
    double worst = 0;
    for (const BandRow& row : rows) {
      if (row.rate != rates) continue;
      const Vector3 off = row.value.of(points) - row.foot;
      worst = std::max(worst, (row.across * off).norm() / row.radius);
    }
    return worst;
  }
};

constexpr int kRowDegree = 3;
constexpr std::size_t kFunctions = kRowDegree + 1;  // that are not zero on a span

// The derivative-th derivative of the curve at u.
BandCombination combination_at(const BsplineBasis& basis, double u, int derivative) {
  const double inside = std::clamp(u, basis.first(), basis.last());
  const std::size_t span = basis.find_span(inside);
  std::array<double, kFunctions * kFunctions> values{};
  basis.evaluate_derivatives(span, inside, derivative, values.data());
  BandCombination made;
  made.first = span - kRowDegree;
  for (std::size_t j = 0; j < 4; ++j) {
    made.weights[j] = values[static_cast<std::size_t>(derivative) * kFunctions + j];
  }
  return made;
}

Matrix3d across_of(const BandSample& sample) {
  Matrix3d along = sample.direction * sample.direction.transpose();
  switch (sample.shape) {
    case BandShape::kCylinder:
      return Matrix3d::Identity() - along;
    case BandShape::kSlab:
      return along;
    case BandShape::kBall:
      break;
  }
  return Matrix3d::Identity();
}

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("solve_band: " + what);
}

struct GaussPoint {
  double at;      // in [-1, 1]
  double weight;  // of all, 1
};

// Places that make the integral over a span exact: |C''|^2 is quadratic there, |C'''|^2 constant.
// Weights of any kind are seen at four.
std::vector<GaussPoint> gauss_points(const BandProblem& problem) {
  if (problem.weight) {
    const double inner = std::sqrt((3 - 2 * std::sqrt(1.2)) / 7);
    const double outer = std::sqrt((3 + 2 * std::sqrt(1.2)) / 7);
    const double more = (18 + std::sqrt(30.0)) / 72;
    const double less = (18 - std::sqrt(30.0)) / 72;
    return {{-outer, less}, {-inner, more}, {inner, more}, {outer, less}};
  }
  if (problem.energy == 3) return {{0, 1}};
  const double root = 1 / std::sqrt(3.0);
  return {{-root, 0.5}, {root, 0.5}};
}

Matrix3d metric_of(const EnergyWeight& weight) {
  const Vector3& d = weight.along;
  const double less = 1 - kBandTuning.next_to_nothing;
  return weight.weight * (Matrix3d::Identity() - less * d * d.transpose());
}

std::vector<EnergyTerm> energy_terms(const BandProblem& problem) {
  const auto& t = problem.basis.knots();
  const auto points = gauss_points(problem);
  std::vector<EnergyTerm> terms;
  for (std::size_t k = kRowDegree; k < problem.basis.size(); ++k) {
    if (!(t[k] < t[k + 1])) continue;
    const double width = t[k + 1] - t[k];
    for (const GaussPoint& point : points) {
      const double u = t[k] + 0.5 * width * (1 + point.at);
      const EnergyWeight weight = problem.weight ? problem.weight(u) : EnergyWeight{};
      terms.push_back({combination_at(problem.basis, u, problem.energy),
                       width * point.weight * metric_of(weight)});
    }
  }
  return terms;
}

// `rates_from`: the derivative from which samples are rates.
BandRows band_rows(const BandProblem& problem, int rates_from) {
  require(problem.basis.degree() == kRowDegree,
          "degree " + std::to_string(problem.basis.degree()) + ", expected 3");
  require(problem.energy == 2 || problem.energy == 3,
          "energy of derivative " + std::to_string(problem.energy) + ", expected 2 or 3");
  BandRows made;
  made.terms = energy_terms(problem);
  for (const BandSample& sample : problem.samples) {
    require(sample.radius > 0, "radius " + std::to_string(sample.radius) + ", expected above 0");
    require(sample.derivative >= 0 && sample.derivative <= kRowDegree,
            "derivative " + std::to_string(sample.derivative) + ", expected 0 to 3");
    BandRow row;
    row.value = combination_at(problem.basis, sample.parameter, sample.derivative);
    row.foot = sample.foot;
    row.across = across_of(sample);
    row.radius = sample.radius;
    row.rate = sample.derivative >= rates_from;
    made.rows.push_back(row);
  }
  for (const HeldPoint& held : problem.held) {
    require(held.index < problem.basis.size(), "held point " + std::to_string(held.index) + " of " +
                                                   std::to_string(problem.basis.size()));
  }
  return made;
}

// Symmetric positive definite systems whose unknowns are the control points of a cubic B-spline,
// with the axes coupled: blocks of 3 x 3, three of them below the diagonal. Factored and solved
// in linear time.
class BlockBandedMatrix {
 public:
  explicit BlockBandedMatrix(std::size_t size) : rows_(size) { set_zero(); }

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  void set_zero() {
    for (Row& row : rows_) row.fill(Matrix3d::Zero());
  }

  // Block (i, i - below), below <= kBands, below <= i. Only the lower half is kept; a diagonal
  // block is given whole.
  Matrix3d& at(std::size_t i, std::size_t below) { return rows_[i][below]; }

  // Leaves unknown i the directions that the projector `free` keeps: in the others the solution
  // is 0, if the right side is 0 there.
  void restrict(std::size_t i, const Matrix3d& free) {
    for (std::size_t k = 1; k <= std::min(i, kBands); ++k) rows_[i][k] = free * rows_[i][k];
    for (std::size_t k = 1; k <= kBands && i + k < rows_.size(); ++k) {
      rows_[i + k][k] = rows_[i + k][k] * free;
    }
    rows_[i][0] = free * rows_[i][0] * free + (Matrix3d::Identity() - free);
  }

  // Replaces the matrix by its Cholesky factor, with the inverses of its diagonal blocks. Returns
  // false when a pivot is not positive.
  [[nodiscard]] bool factor() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      Row& row = rows_[i];
      const std::size_t before = std::min(i, kBands);
      for (std::size_t k = before; k >= 1; --k) {
        for (std::size_t m = k + 1; m <= before; ++m) {
          row[k].noalias() -= row[m] * rows_[i - k][m - k].transpose();
        }
        row[k] = row[k] * rows_[i - k][0].transpose();
      }
      for (std::size_t k = 1; k <= before; ++k) row[0].noalias() -= row[k] * row[k].transpose();
      const Eigen::LLT<Matrix3d> root(row[0]);
      if (root.info() != Eigen::Success) return false;
      row[0] = root.matrixL().solve(Matrix3d::Identity());
    }
    return true;
  }

  // After factor(): `right` becomes the solution.
  void solve(std::vector<Point3>& right) const {
    const std::size_t n = rows_.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 1; k <= std::min(i, kBands); ++k) right[i] -= rows_[i][k] * right[i - k];
      right[i] = rows_[i][0] * right[i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = 1; k <= kBands && i + k < n; ++k) {
        right[i] -= rows_[i + k][k].transpose() * right[i + k];
      }
      right[i] = rows_[i][0].transpose() * right[i];
    }
  }

 private:
  static constexpr std::size_t kBands = 3;       // blocks below the diagonal
  using Row = std::array<Matrix3d, kBands + 1>;  // diagonal first, then below
  std::vector<Row> rows_;
};

// Which rows are widened by the common factor.
enum class Widening {
  kNone,       // none
  kPositions,  // all but the rates, which do not count
  kRates,      // the rates; the others stay as they are
};

struct BarrierPoint {
  std::vector<Point3> points;
  double wide = 1;
};

double dot(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

// The barrier function of a band problem, and Newton steps on it.
//
//   t * (energy * E(x) + price * wide) - sum of log(wide_i^2 - |distance_i / radius_i|^2)
//
// with x the control points, E the energy, and wide_i the factor by which the radius of row i is
// widened: 1, or `wide` for the rows that are being shrunk. This logarithm is self-concordant, so
// Newton's method with a line search always arrives.
class BandBarrier {
 public:
  // `band` and `held` must outlive it.
  BandBarrier(const BandRows& band, const std::vector<HeldPoint>& held, std::size_t points,
              Widening widening)
      : band_(band), held_(held), widening_(widening), hessian_(points), factors_(points) {
    for (const BandRow& row : band.rows) {
      if (takes_part(row)) gap_times_weight += 2;
    }
  }

  double weight = 1;  // t
  double energy = 1;
  double price = 0;
  // Where the function is least, what is priced is above its least value by at most this over
  // `weight`: two for each logarithm of a square.
  double gap_times_weight = 0;

  // One Newton step with the best step length. Gives the squared Newton decrement before the
  // step, about twice what the function was above its least value; nothing where rounding no
  // longer allows a step. Requires `at` strictly inside.
  [[nodiscard]] std::optional<double> step(BarrierPoint& at) {
    count_operations(3 * at.points.size() + 2 * band_.rows.size());
    const auto along = direction(at);
    if (!along || !(along->decrement > 0)) return std::nullopt;
    const double length = best_length(at, *along);
    if (!(length > 0)) return std::nullopt;
    for (std::size_t i = 0; i < at.points.size(); ++i) at.points[i] += length * along->points[i];
    at.wide += length * along->wide;
    return along->decrement;
  }

 private:
  struct Direction {
    std::vector<Point3> points;
    double wide = 0;
    double decrement = 0;  // squared
  };
  // The argument of one logarithm along a direction: value + 2 slope a + bend a^2.
  struct Line {
    double value;
    double slope;
    double bend;
  };

  [[nodiscard]] bool takes_part(const BandRow& row) const {
    return !(row.rate && widening_ == Widening::kPositions);
  }

  [[nodiscard]] bool is_widened(const BandRow& row) const {
    return widening_ == (row.rate ? Widening::kRates : Widening::kPositions);
  }

  void add(const BandCombination& value, const Vector3& gradient, const Matrix3d& curvature) {
    for (std::size_t i = 0; i < 4; ++i) {
      gradient_[value.first + i] += value.weights[i] * gradient;
      for (std::size_t j = 0; j <= i; ++j) {
        hessian_.at(value.first + i, i - j).noalias() +=
            (value.weights[i] * value.weights[j]) * curvature;
      }
    }
  }

  // -log(f^2 - |e|^2), e = across (value - foot) / radius, f the widening.
  void add_row(const BandRow& row, const BarrierPoint& at) {
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
      const Vector3 mixed = -4 * f * left * left / r * e;
      for (std::size_t i = 0; i < 4; ++i)
        mixed_[row.value.first + i] += row.value.weights[i] * mixed;
    }
  }

  void assemble(const BarrierPoint& at) {
    hessian_.set_zero();
    gradient_.assign(at.points.size(), Point3::Zero());
    mixed_.assign(at.points.size(), Point3::Zero());
    wide_gradient_ = weight * price;
    wide_curvature_ = 0;
    for (const EnergyTerm& term : band_.terms) {
      const Matrix3d metric = 2 * weight * energy * term.metric;
      add(term.value, metric * term.value.of(at.points), metric);
    }
    for (const BandRow& row : band_.rows) {
      if (takes_part(row)) add_row(row, at);
    }
    for (const HeldPoint& held : held_) {
      hessian_.restrict(held.index, held.free);
      gradient_[held.index] = held.free * gradient_[held.index];
      mixed_[held.index] = held.free * mixed_[held.index];
    }
  }

  [[nodiscard]] bool factor() {
    double damping = kBandTuning.damping;
    for (int attempt = 0; attempt < kBandTuning.more_damping; ++attempt, damping *= 100) {
      factors_ = hessian_;
      for (std::size_t i = 0; i < factors_.size(); ++i) {
        factors_.at(i, 0).diagonal() *= 1 + damping;
      }
      if (factors_.factor()) return true;
    }
    return false;
  }

  [[nodiscard]] std::optional<Direction> direction(const BarrierPoint& at) {
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

  void find_lines(const BarrierPoint& at, const Direction& along) {
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

  [[nodiscard]] double best_length(const BarrierPoint& at, const Direction& along) {
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
    // The function is convex: a search between a length where it falls and one where it rises.
    const double enough = kBandTuning.search_near_enough * std::abs(derivatives(0).first);
    double low = 0;
    double high = std::min(1.0, kBandTuning.most_of_the_way * farthest);
    double length = high;
    for (int i = 0; i < kBandTuning.search_tries; ++i) {
      const auto [first, second] = derivatives(length);
      if (std::abs(first) <= enough || (first < 0 && length == high)) return length;
      (first < 0 ? low : high) = length;
      length -= first / second;
      if (!(length > low && length < high)) length = 0.5 * (low + high);
    }
    return low;
  }

  const BandRows& band_;
  const std::vector<HeldPoint>& held_;
  Widening widening_;
  BlockBandedMatrix hessian_;
  BlockBandedMatrix factors_;
  std::vector<Point3> gradient_;
  std::vector<Point3> mixed_;  // second derivatives by a control point and by `wide`
  double wide_gradient_ = 0;
  double wide_curvature_ = 0;
  std::vector<Line> lines_;
};

class BandSolver {
 public:
  BandSolver(const BandProblem& problem, std::vector<Point3> start, int rates_from, double gap)
      : problem_(problem), gap_(gap), band_(band_rows(problem, rates_from)) {
    require(start.size() == problem.basis.size(), std::to_string(start.size()) +
                                                      " points to start with, expected " +
                                                      std::to_string(problem.basis.size()));
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

  bool get_inside() {
    if (band_.worst_ratio(at_.points, false) < 1) return true;
    shrink(Widening::kPositions, kBandTuning.inside);
    return band_.worst_ratio(at_.points, false) < 1;
  }

  // Makes the greatest ratio as small as it gets, or just smaller than `enough`.
  BandEnd shrink(Widening widening, double enough) {
    BandBarrier f(band_, problem_.held, at_.points.size(), widening);
    const bool rates = widening == Widening::kRates;
    at_.wide = kBandTuning.wider * band_.worst_ratio(at_.points, rates);
    if (!(at_.wide > 0)) return BandEnd::kLeast;
    const double energy = std::max(band_.energy(at_.points), band_.energy_of_moves());
    f.price = 1;
    f.energy = energy > 0 ? kBandTuning.trace * at_.wide / energy : 0;
    f.weight = f.gap_times_weight / at_.wide;
    return follow(
        f, [&] { return band_.worst_ratio(at_.points, rates) < enough; },
        [&] { return f.gap_times_weight <= gap_ * at_.wide * f.weight; });
  }

  // Makes the energy as small as it gets inside the band.
  BandEnd descend() {
    BandBarrier f(band_, problem_.held, at_.points.size(), Widening::kNone);
    at_.wide = 1;
    const double noise = band_.energy_noise(at_.points);
    const double start = std::max(band_.energy(at_.points), noise);
    if (!(start > 0)) return BandEnd::kLeast;  // nothing has an energy: a line on one point
    f.energy = 1 / start;
    f.weight = f.gap_times_weight;
    return follow(
        // A straight run has no energy, and what is left of it is rounding.
        f, [&] { return band_.energy(at_.points) <= noise; },
        [&] {
          const double left = std::max(gap_ * band_.energy(at_.points), noise);
          return f.gap_times_weight * start <= left * f.weight;
        });
  }

  // Until it is `enough`, or the barrier so sharp that its least is the least of what is priced.
  template <typename Enough, typename Sharp>
  BandEnd follow(BandBarrier& f, const Enough& enough, const Sharp& sharp) {
    while (steps_ < kBandTuning.max_steps) {
      const auto decrement = f.step(at_);
      ++steps_;
      if (enough()) return BandEnd::kLeast;
      const bool last = sharp();
      if (!decrement || *decrement < (last ? kBandTuning.there : kBandTuning.near)) {
        if (last) return BandEnd::kLeast;
        f.weight *= kBandTuning.sharpen;
      }
    }
    return BandEnd::kStepLimit;
  }

  const BandProblem& problem_;
  double gap_;
  BandRows band_;
  BarrierPoint at_;
  int steps_ = 0;
};

}  // namespace

BandCurve solve_band(const BandProblem& problem, std::vector<Point3> start, double gap) {
  constexpr int kNone = std::numeric_limits<int>::max();
  return BandSolver(problem, std::move(start), kNone, gap).least_energy();
}

BandCurve least_ratio_in_band(const BandProblem& problem, std::vector<Point3> start,
                              int from_derivative) {
  return BandSolver(problem, std::move(start), from_derivative, kBandTuning.gap).least_ratio();
}

}  // namespace batten::geometry
