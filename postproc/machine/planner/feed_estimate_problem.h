// What the quick estimate's search solves: one stretch as sums over its ordinates, with its limits.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_estimate_parts.h"
#include "postproc/machine/planner/feed_plan_envelope.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_plan_problem.h"

namespace batten::postproc {

struct EstimateInterval {
  std::size_t piece = 0;  // the place whose derivatives stand for the interval
  double t = 0;
  double length = 0;                                // mm
  double speed = 0;                                 // mm/s, roughly, in its middle: a bound
  double inner_bound = KinematicPathLimits::kNone;  // mm/s, the least of the joints inside
  double end_bound = KinematicPathLimits::kNone;    // mm/s, of the joint at its end
};

// How the search begins or ends.
struct EstimateEnd {
  enum class Kind {
    kFree,    // at most `speed`, with any acceleration
    kSlow,    // at `speed`, acceleration 0; the next node is near
    kArc,     // at `speed`, far below that of the next node, `length` mm away: constant jerk
    kMoving,  // at `speed` with `acceleration`
  };
  Kind kind = Kind::kFree;
  double speed = 0;         // mm/s
  double acceleration = 0;  // mm/s^2
  double length = 0;        // mm
};

// A stretch between two slow places, or a part of the way of one.
struct EstimateStretch {
  std::vector<EstimateInterval> intervals;
  EstimateEnd start;
  EstimateEnd end;
};

// A node at every place where the machine could have changed its speed: `density` of them in the
// time sqrt(v / jerk). Parts that are shorter than that are joined. `w` is the greatest potential
// at the ends of the parts, one more than parts. Of `start` and `end` kind and speed are given;
// a slow end becomes an arc where the speed soon is much greater.
[[nodiscard]] EstimateStretch make_estimate_stretch(std::span<const EstimatePart> parts,
                                                    std::span<const double> w,
                                                    const Potential& potential,
                                                    const EstimateEnd& start,
                                                    const EstimateEnd& end, double density);

// One interval.
struct EstimateCell {
  double length = 0;
  // q, p and r in the middle as sums over three neighbouring ordinates.
  LimitWindow q_of{};
  LimitWindow p_of{};
  LimitWindow r_of{};
  std::size_t first_row = 0;
  std::size_t jerk_rows = 0;  // these first
  std::size_t rows = 0;
  double most = KinematicPathLimits::kNone;  // of q in the middle
};

// A node between two intervals: q = before * u[k] + after * u[k + 1].
struct EstimateKnot {
  double before = 0;
  double after = 1;
  double weight = 0;                         // mm, of 1 / sqrt(q) in the time
  double most = KinematicPathLimits::kNone;  // of q
};

// What holds at an end of the stretch.
struct EstimateTie {
  bool ties = false;  // ordinate 1 = factor * ordinate 0 + offset
  bool pins = false;  // ordinates 0 and 1 are these
  double factor = 0;
  double offset = 0;
  double value = 0;
  double next = 0;
  double arc_length = 0;
  double arc_speed = 0;
};

struct EstimateProblem {
  std::vector<EstimateCell> cells;
  std::vector<EstimateKnot> knots;  // one more than cells
  std::vector<LimitWindow> rows;    // over q, p and r in the middle of their cell
  EstimateTie start;
  EstimateTie end;
};

[[nodiscard]] EstimateProblem make_estimate_problem(std::span<const geometry::PathPiece> path,
                                                    const EstimateStretch& stretch,
                                                    const KinematicPathLimits& limits);

// The linear system of one step of the quick estimate's search.

// Symmetric, two sub-diagonals, positive. At least two rows.
class EstimateMatrix {
 public:
  explicit EstimateMatrix(std::size_t size) : rows_(size) {}

  void set_zero() { std::fill(rows_.begin(), rows_.end(), Row{}); }
  // The entry (row, row - left).
  double& at(std::size_t row, int left) { return rows_[row][left]; }

  // Overwrites the matrix by its factors L D L^T.
  void factor() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      Row& row = rows_[i];
      double diagonal = row[0];
      if (i > 1) {
        const double far = row[2];
        row[1] -= far * rows_[i - 1][1];
        row[2] = far * rows_[i - 2][0];
        diagonal -= far * row[2];
      }
      if (i > 0) {
        const double near = row[1];
        row[1] = near * rows_[i - 1][0];
        diagonal -= near * row[1];
      }
      row[0] = 1 / std::max(diagonal, 1e-300);
    }
  }

  // After factor(), in place.
  void solve(std::vector<double>& x) const {
    const std::size_t n = rows_.size();
    x[1] -= rows_[1][1] * x[0];
    for (std::size_t i = 2; i < n; ++i) x[i] -= rows_[i][1] * x[i - 1] + rows_[i][2] * x[i - 2];
    for (std::size_t i = 0; i < n; ++i) x[i] *= rows_[i][0];
    x[n - 2] -= rows_[n - 1][1] * x[n - 1];
    for (std::size_t i = n - 2; i-- > 0;) {
      x[i] -= rows_[i + 1][1] * x[i + 1] + rows_[i + 2][2] * x[i + 2];
    }
  }

 private:
  // The diagonal (after factor() its inverse), then to the left of it.
  using Row = std::array<double, 3>;

  std::vector<Row> rows_;
};

}  // namespace batten::postproc
