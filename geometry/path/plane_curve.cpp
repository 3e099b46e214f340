#include "geometry/path/plane_curve.h"

#include <array>
#include <cmath>
#include <limits>

#include "geometry/basic/rounding.h"

namespace batten::geometry {
namespace {

constexpr double kLargestTurn = 1.0;  // radians per piece; keeps angles and bounds simple
constexpr int kTurnHalvings = 6;      // a cusp turns by any amount on any length

double turn(const Vector2& from, const Vector2& to) {
  return std::atan2(cross(from, to), from.dot(to));
}

// The zero vector where there is none.
Vector2 plane_direction(const CubicBezier& piece, double t) {
  return direction_at(piece, t).head<2>();
}

bool has_direction(const Vector2& direction) { return direction.norm() > kSameDirection; }

struct Turning {
  double signed_sum = 0;
  double total = 0;
};

// How the control polygon turns in the plane, from the first tangent to the last one.
Turning turning_of(const CubicBezier& piece) {
  Turning turning;
  Vector2 before = plane_direction(piece, 0);
  std::array<Vector2, 4> legs;
  for (int i = 0; i < 3; ++i) legs[i] = (piece.control[i + 1] - piece.control[i]).head<2>();
  legs[3] = plane_direction(piece, 1);
  for (const Vector2& leg : legs) {
    if (leg.norm() <= kSamePlace) continue;
    if (has_direction(before)) {
      const double angle = turn(before, leg);
      turning.signed_sum += angle;
      turning.total += std::abs(angle);
    }
    before = leg;
  }
  return turning;
}

}  // namespace

Vector2 unit_vector(double angle) { return {std::cos(angle), std::sin(angle)}; }

PlaneFrame PlaneFrame::across(const Vector3& axis) {
  int main = 0;
  axis.cwiseAbs().maxCoeff(&main);
  // The coordinate axis after the main one, turned across the axis, is the first: for +X this
  // gives (Y, Z, X), for +Z (X, Y, Z), for -Z (X, -Y, -Z).
  const Vector3 next = Vector3::Unit((main + 1) % 3);
  const Vector3 first = (next - next.dot(axis) * axis).normalized();
  PlaneFrame frame;
  frame.to_local.row(0) = first;
  frame.to_local.row(1) = axis.cross(first);
  frame.to_local.row(2) = axis;
  return frame;
}

PlaneCurve::PlaneCurve(const CurvePieces& pieces, const PlaneFrame& frame) {
  const std::size_t count = pieces.size();
  breaks_.reserve(count + 1);
  pieces_.reserve(count);
  start_angles_.reserve(count);
  end_angles_.reserve(count);
  breaks_.push_back(pieces.first());
  for (std::size_t i = 0; i < count; ++i) {
    CubicBezier local = pieces.piece(i);
    for (Point3& control : local.control) control = frame.local(control);
    append(local, pieces.breaks()[i], pieces.breaks()[i + 1], kTurnHalvings);
  }
}

void PlaneCurve::append(const CubicBezier& piece, double from, double to, int halvings) {
  const Turning turning = turning_of(piece);
  const double middle = (from + to) / 2;
  if (turning.total > kLargestTurn && halvings > 0 && from < middle && middle < to) {
    append(sub_piece(piece, 0, 0.5), from, middle, halvings - 1);
    append(sub_piece(piece, 0.5, 1), middle, to, halvings - 1);
    return;
  }
  const Vector2 start = plane_direction(piece, 0);
  const double before = end_angles_.empty() ? 0.0 : end_angles_.back();
  double angle = before;
  if (has_direction(start)) angle += turn(unit_vector(before), start);
  pieces_.push_back(piece);
  breaks_.push_back(to);
  start_angles_.push_back(angle);
  end_angles_.push_back(angle + turning.signed_sum);
}

double PlaneCurve::angle_in(std::size_t i, double u) const {
  const double t = local(i, u);
  if (t >= 1) return end_angles_[i];
  const Vector2 direction = plane_direction(pieces_[i], t);
  if (t <= 0 || !has_direction(direction)) return start_angles_[i];
  return start_angles_[i] + turn(unit_vector(start_angles_[i]), direction);
}

double PlaneCurve::angle_at(double u) const { return angle_in(index_of(u), u); }

double PlaneCurve::angle_before(double u) const {
  std::size_t i = index_of(u);
  if (i > 0 && u <= breaks_[i]) --i;
  return angle_in(i, u);
}

double PlaneCurve::curvature_at(double u) const {
  const std::size_t i = index_of(u);
  const double t = local(i, u);
  const double s = 1 - t;
  const auto& p = pieces_[i].control;
  const Vector3 d0 = p[1] - p[0];
  const Vector3 d1 = p[2] - p[1];
  const Vector3 d2 = p[3] - p[2];
  const Vector3 first = 3 * (s * s * d0 + 2 * s * t * d1 + t * t * d2);
  const Vector3 second = 6 * (s * (d1 - d0) + t * (d2 - d1));
  const double speed = first.head<2>().norm();
  if (speed <= kSameDirection * first.norm() || speed == 0) return 0;
  return cross(first.head<2>(), second.head<2>()) / (speed * speed * speed);
}

double PlaneCurve::slope_at(double u) const {
  const std::size_t i = index_of(u);
  const Vector3 direction = direction_at(pieces_[i], local(i, u));
  const double across = direction.head<2>().norm();
  if (across <= kSameDirection) return std::numeric_limits<double>::infinity();
  return direction.z() / across;
}

}  // namespace batten::geometry
