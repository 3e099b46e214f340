#include "geometry/path/curve_pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace batten::geometry {
namespace {

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double distance_to_line(const Point3& p, const Point3& on_line, const Vector3& direction) {
  return (p - on_line).cross(direction).norm();
}

// Straight, and the control points go forward, so the piece does not double back on itself.
bool is_straight(const CubicBezier& piece) {
  const Vector3 chord = piece.control[3] - piece.control[0];
  const double length = chord.norm();
  if (length <= kOnLine) return false;
  const Vector3 along = chord / length;
  double before = 0;
  for (int i = 1; i < 4; ++i) {
    const double at = along.dot(piece.control[i] - piece.control[0]);
    if (at < before - kOnLine) return false;
    if (distance_to_line(piece.control[i], piece.control[0], along) > kOnLine) return false;
    before = at;
  }
  return true;
}

}  // namespace

CurvePieces::CurvePieces(const BsplineCurve& curve, double from, double to) {
  if (!(curve.first() <= from && from < to && to <= curve.last())) {
    throw std::invalid_argument(
        fmt::format("CurvePieces: from {:f} to {:f}, expected an interval inside {:f} to {:f}",
                    from, to, curve.first(), curve.last()));
  }
  const bool whole = from == curve.first() && to == curve.last();
  const BsplineCurve section = whole ? curve : curve.part(from, to);
  breaks_ = section.breakpoints();
  pieces_ = section.bezier_pieces();
}

std::size_t PieceRow::index_of(double u) const {
  const auto after = std::upper_bound(breaks_.begin(), breaks_.end(), u);
  const auto i = after - breaks_.begin() - 1;
  return static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(pieces_.size()) - 1));
}

double PieceRow::local(std::size_t i, double u) const {
  return std::clamp((u - breaks_[i]) / (breaks_[i + 1] - breaks_[i]), 0.0, 1.0);
}

Point3 PieceRow::point_in(std::size_t i, double u) const {
  return geometry::point_at(pieces_[i], local(i, u));
}

Vector3 CurvePieces::arriving(double u) const {
  std::size_t i = index_of(u);
  if (i > 0 && u <= breaks_[i]) --i;
  return geometry::direction_at(pieces_[i], local(i, u));
}

Vector3 CurvePieces::leaving(double u) const {
  const std::size_t i = index_of(u);
  return geometry::direction_at(pieces_[i], local(i, u));
}

CubicBezier PieceRow::part(std::size_t i, double from, double to) const {
  const double t0 = local(i, from);
  const double t1 = local(i, to);
  if (t0 == 0 && t1 == 1) return pieces_[i];
  return geometry::sub_piece(pieces_[i], t0, t1);
}

std::vector<double> CurvePieces::corners() const {
  std::vector<double> found;
  for (std::size_t i = 1; i < pieces_.size(); ++i) {
    const Vector3 in = geometry::direction_at(pieces_[i - 1], 1);
    const Vector3 out = geometry::direction_at(pieces_[i], 0);
    if (angle_between(in, out) > kCornerAngle) found.push_back(breaks_[i]);
  }
  return found;
}

std::vector<StraightRun> CurvePieces::straight_runs() const {
  std::vector<StraightRun> runs;
  std::size_t end = 0;
  for (std::size_t i = 0; i < pieces_.size(); i = end) {
    end = i + 1;
    if (!is_straight(pieces_[i])) continue;
    // Extend along the line through the run's first piece, re-aimed at the farthest end so
    // far: a long first line decides, and no later piece leaves it by more than the noise.
    const Point3 start = pieces_[i].control[0];
    Vector3 along = (pieces_[i].control[3] - start).normalized();
    double reach = (pieces_[i].control[3] - start).norm();
    for (; end < pieces_.size() && is_straight(pieces_[end]); ++end) {
      const Point3& next = pieces_[end].control[3];
      const double onward = along.dot(next - start);
      const double allowed = kOnLine * std::max(1.0, (onward - reach) / reach);
      if (onward < reach || distance_to_line(next, start, along) > allowed) break;
      const Vector3 aimed = (next - start).normalized();
      if (distance_to_line(pieces_[end].control[0], start, aimed) > kOnLine) break;
      along = aimed;
      reach = onward;
    }
    // Many tiny pieces of a bend can each pass; together they are no line.
    const auto on_line = [&](const CubicBezier& piece) {
      return distance_to_line(piece.control[3], start, along) <= 2 * kOnLine;
    };
    const auto first = pieces_.begin() + static_cast<std::ptrdiff_t>(i);
    const auto last = pieces_.begin() + static_cast<std::ptrdiff_t>(end);
    if (std::all_of(first, last, on_line)) runs.push_back({breaks_[i], breaks_[end]});
  }
  return runs;
}

}  // namespace batten::geometry
