// A stretch of a cubic B-spline curve, cut once into its Bezier pieces, with the places
// that an approximation by lines or arcs must respect: corners and straight runs.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// Two pieces that meet under a greater angle (radians) meet in a corner. Far above the
// tangent noise of a fit (1e-6), far below a corner that anyone would keep (a degree).
inline constexpr double kCornerAngle = 2e-3;

// A piece whose control points are this close (mm) to its chord is straight: above the
// noise of solved control points, below the last decimal that a program carries.
inline constexpr double kOnLine = 1e-7;

// Parameters of a stretch that is one straight line to within kOnLine.
struct StraightRun {
  double from;
  double to;
};

// Bezier pieces one after the other: piece i runs over [breaks()[i], breaks()[i + 1]].
class PieceRow {
 public:
  [[nodiscard]] std::size_t size() const { return pieces_.size(); }
  [[nodiscard]] const CubicBezier& piece(std::size_t i) const { return pieces_[i]; }
  [[nodiscard]] const std::vector<double>& breaks() const { return breaks_; }

  // The piece that holds u; the later one at a break (the last one at the end).
  [[nodiscard]] std::size_t index_of(double u) const;

  [[nodiscard]] Point3 point_at(double u) const;
  // The same for who knows the piece that holds u.
  [[nodiscard]] Point3 point_in(std::size_t i, double u) const;

  // The piece's own parameter at u, 0..1 (clamped to the piece).
  [[nodiscard]] double local(std::size_t i, double u) const;

  // The part of piece i between two parameters of the curve (clamped to the piece).
  [[nodiscard]] CubicBezier part(std::size_t i, double from, double to) const;

 protected:
  std::vector<double> breaks_;
  std::vector<CubicBezier> pieces_;
};

class CurvePieces : public PieceRow {
 public:
  // Requires degree 3 or less and first() <= from < to <= last(). Linear cost.
  CurvePieces(const BsplineCurve& curve, double from, double to);

  [[nodiscard]] double first() const { return breaks_.front(); }
  [[nodiscard]] double last() const { return breaks_.back(); }

  // Unit tangents at u, seen from below and from above; they differ at corners only.
  [[nodiscard]] Vector3 arriving(double u) const;
  [[nodiscard]] Vector3 leaving(double u) const;

  // Places inside where the tangent turns by more than kCornerAngle, increasing.
  [[nodiscard]] std::vector<double> corners() const;

  // Longest stretches of whole pieces that are straight, increasing, not overlapping.
  [[nodiscard]] std::vector<StraightRun> straight_runs() const;
};

// A stretch of curve for those who cut it more than once.
struct MarkedPieces {
  // As CurvePieces.
  MarkedPieces(const BsplineCurve& curve, double from, double to)
      : pieces(curve, from, to), corners(pieces.corners()), straight_runs(pieces.straight_runs()) {}

  CurvePieces pieces;
  std::vector<double> corners;             // as CurvePieces gives them
  std::vector<StraightRun> straight_runs;  // the same
};

}  // namespace batten::geometry
