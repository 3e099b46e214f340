// The cubic B-spline of least energy that stays in a band: at given parameters its places (or its
// derivatives) keep given distances from given ones. A convex problem, solved by Newton's method
// on a logarithmic barrier: every curve on the way is strictly inside.
// Method: docs/algorithms/band_curve.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/band_problem.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct BarrierOptions {
  int max_steps = 200;
  // Ends when the energy is known to be above the least one by this part at most.
  double gap = 1e-5;
};

enum class BandEnd {
  kLeast,      // the least energy, to within the gap
  kStepLimit,  // inside the band, but the energy may not be the least
  kOutside,    // no curve on this basis was found that is inside
};

struct BandCurve {
  BsplineCurve curve;
  BandEnd end = BandEnd::kOutside;
  double energy = 0;
  double worst_ratio = 0;  // the greatest distance over radius at a sample
  int steps = 0;           // Newton steps, each linear in samples and control points
};

// `start`: control points to begin with; held points are put where they have to be. It may be
// outside: then the band is widened to hold it and shrunk again, as far as it goes.
//
// Throws std::invalid_argument when the degree is not 3, a radius is not positive, or the number
// of points does not fit the basis.
[[nodiscard]] BandCurve solve_band(const BandProblem& problem, std::vector<Point3> start,
                                   const BarrierOptions& options);

// The curve for which the greatest ratio of distance over radius is least, over the samples with
// a derivative >= `from_derivative`; the others keep their radius (it is widened as well if the
// start is outside). Of the energy only a trace counts. worst_ratio is that greatest ratio, and
// `end` is kLeast when it is known to be the least to within the gap.
[[nodiscard]] BandCurve least_ratio_in_band(const BandProblem& problem, std::vector<Point3> start,
                                            int from_derivative, const BarrierOptions& options);

// The barrier function of a band problem, and Newton steps on it.
//
//   t * (energy * E(x) + price * wide) - sum of log(wide_i^2 - |distance_i / radius_i|^2)
//
// with x the control points, E the energy, and wide_i the factor by which the radius of row i is
// widened: 1, or `wide` for the rows that are being shrunk. This logarithm is self-concordant, so
// Newton's method with a line search always arrives.

// Symmetric positive definite systems whose unknowns are the control points of a cubic B-spline,
// with the axes coupled: blocks of 3 x 3, three of them below the diagonal. Factored and solved
// in linear time.
class BlockBandedMatrix {
 public:
  static constexpr std::size_t kBands = 3;  // blocks below the diagonal

  explicit BlockBandedMatrix(std::size_t size) : rows_(size) { set_zero(); }

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  void set_zero();

  // Block (i, i - below), below <= kBands, below <= i. Only the lower half is kept; a diagonal
  // block is given whole.
  Eigen::Matrix3d& at(std::size_t i, std::size_t below) { return rows_[i][below]; }
  [[nodiscard]] const Eigen::Matrix3d& at(std::size_t i, std::size_t below) const {
    return rows_[i][below];
  }

  // Leaves unknown i the directions that the projector `free` keeps: in the others the solution
  // is 0, if the right side is 0 there.
  void restrict(std::size_t i, const Eigen::Matrix3d& free);

  // Replaces the matrix by its Cholesky factor. Returns false when a pivot is not positive.
  [[nodiscard]] bool factor();

  // After factor(): `right` becomes the solution.
  void solve(std::vector<Point3>& right) const;

 private:
  using Row = std::array<Eigen::Matrix3d, kBands + 1>;  // diagonal first, then below
  std::vector<Row> rows_;
};

// Which rows are widened by the common factor.
enum class Widening {
  kNone,    // none
  kPlaces,  // all but the rates, which do not count
  kRates,   // the rates; the others stay as they are
};

struct BarrierPoint {
  std::vector<Point3> points;
  double wide = 1;
};

class BandBarrier {
 public:
  // `band` and `held` must outlive it.
  BandBarrier(const BandRows& band, const std::vector<HeldPoint>& held, std::size_t points,
              Widening widening);

  double weight = 1;  // t
  double energy = 1;
  double price = 0;

  // Where the function is least, what is priced is above its least value by at most this over
  // `weight`: two for each logarithm of a square.
  [[nodiscard]] double gap_times_weight() const { return gap_times_weight_; }

  // One Newton step with the best step length. Gives the squared Newton decrement before the
  // step, about twice what the function was above its least value; nothing where rounding no
  // longer allows a step. Requires `at` strictly inside.
  [[nodiscard]] std::optional<double> step(BarrierPoint& at);

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

  [[nodiscard]] bool takes_part(const BandRow& row) const;
  [[nodiscard]] bool is_widened(const BandRow& row) const;
  void assemble(const BarrierPoint& at);
  void add_row(const BandRow& row, const BarrierPoint& at);
  void add_energy(const BarrierPoint& at);
  void add(const BandCombination& value, const Vector3& gradient, const Eigen::Matrix3d& curvature);
  void add_mixed(const BandCombination& value, const Vector3& mixed);
  [[nodiscard]] bool factor();
  [[nodiscard]] std::optional<Direction> direction(const BarrierPoint& at);
  void find_lines(const BarrierPoint& at, const Direction& along);
  [[nodiscard]] double best_length(const BarrierPoint& at, const Direction& along);

  const BandRows& band_;
  const std::vector<HeldPoint>& held_;
  Widening widening_;
  double gap_times_weight_ = 0;

  BlockBandedMatrix hessian_;
  BlockBandedMatrix factors_;
  std::vector<Point3> gradient_;
  std::vector<Point3> mixed_;  // second derivatives by a control point and by `wide`
  double wide_gradient_ = 0;
  double wide_curvature_ = 0;
  std::vector<Line> lines_;
};

}  // namespace batten::geometry
