// A section of a cubic B-spline curve, cut once into its Bezier pieces, with what an approximation
// by lines or arcs must respect: corners and straight runs.
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

struct StraightRun {  // parameters of a section that is one straight line to within kOnLine
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

  [[nodiscard]] Point3 point_at(double u) const { return point_in(index_of(u), u); }

  // In piece i, of which parameters of the curve are clamped to the piece: the position at u, the
  // piece's own parameter there (0..1), and the part between two of them.
  [[nodiscard]] Point3 point_in(std::size_t i, double u) const;
  [[nodiscard]] double local(std::size_t i, double u) const;
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

  // Parameters inside where the tangent turns by more than kCornerAngle, increasing.
  [[nodiscard]] std::vector<double> corners() const;

  // The longest of whole pieces, increasing, not overlapping.
  [[nodiscard]] std::vector<StraightRun> straight_runs() const;
};

// CurvePieces with their corners and straight runs, for those who cut them more than once.
struct MarkedPieces {
  explicit MarkedPieces(const BsplineCurve& curve)
      : MarkedPieces(curve, curve.first(), curve.last()) {}
  MarkedPieces(const BsplineCurve& curve, double from, double to)
      : pieces(curve, from, to), corners(pieces.corners()), straight_runs(pieces.straight_runs()) {}

  CurvePieces pieces;
  std::vector<double> corners;
  std::vector<StraightRun> straight_runs;
};

}  // namespace batten::geometry
