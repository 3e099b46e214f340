#include "geometry/path/path.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "geometry/basic/rounding.h"
#include "geometry/numeric/extrema.h"

namespace batten::geometry {
namespace {

// Below this part of the control polygon's size a derivative is rounding noise: the
// differences of coordinates of 1e4 mm carry 2e-12 mm, polygons are 1e-3 mm long or more.
constexpr double kNoDerivative = 1e-9;

Vector3 unit_or_zero(const Vector3& v) {
  const double length = v.norm();
  return length > 0 ? Vector3(v / length) : Vector3(Vector3::Zero());
}

// An arc in cylinder coordinates about its axis. Radius, angle and height are linear in t,
// so one moving frame (outward, forward, axis) holds all derivatives.
class ArcFrame {
 public:
  explicit ArcFrame(const Arc& arc) : axis_(arc.axis), center_(arc.center), sweep_(arc.sweep) {
    const Vector3 from = arc.start - center_;
    const Vector3 to = arc.end - center_;
    height_ = axis_.dot(from);
    rise_ = axis_.dot(to) - height_;
    const Vector3 from_radial = from - height_ * axis_;
    const Vector3 to_radial = to - (height_ + rise_) * axis_;
    radius_ = from_radial.norm();
    growth_ = to_radial.norm() - radius_;
    if (radius_ > 0) {
      outward_ = from_radial / radius_;
    } else {  // a spiral that starts on its axis: turn the direction of the end back
      const Vector3 out = unit_or_zero(to_radial);
      outward_ = std::cos(sweep_) * out - std::sin(sweep_) * axis_.cross(out);
    }
    forward_ = axis_.cross(outward_);
  }

  double radius(double t) const { return radius_ + t * growth_; }
  double greatest_radius() const { return std::max(radius_, radius_ + growth_); }
  double sweep() const { return sweep_; }
  double growth() const { return growth_; }

  Point3 point(double t) const {
    return center_ + radius(t) * outward(t) + (height_ + t * rise_) * axis_;
  }

  // First derivative by t in the frame (outward, forward, axis).
  Vector3 velocity(double t) const { return {growth_, radius(t) * sweep_, rise_}; }

  Vector3 acceleration(double t) const {
    return {-radius(t) * sweep_ * sweep_, 2 * growth_ * sweep_, 0};
  }

  Vector3 in_space(double t, const Vector3& local) const {
    const Vector3 out = outward(t);
    return local.x() * out + local.y() * axis_.cross(out) + local.z() * axis_;
  }

 private:
  Vector3 outward(double t) const {
    return std::cos(sweep_ * t) * outward_ + std::sin(sweep_ * t) * forward_;
  }

  Vector3 axis_;
  Point3 center_;
  double sweep_;
  double height_;
  double rise_;
  double radius_;
  double growth_;
  Vector3 outward_;
  Vector3 forward_;
};

Vector3 bezier_first(const CubicBezier& b, double t) {
  const double s = 1 - t;
  return 3 * (s * s * (b.control[1] - b.control[0]) + 2 * s * t * (b.control[2] - b.control[1]) +
              t * t * (b.control[3] - b.control[2]));
}

Vector3 bezier_second(const CubicBezier& b, double t) {
  return 6 * ((1 - t) * (b.control[2] - 2 * b.control[1] + b.control[0]) +
              t * (b.control[3] - 2 * b.control[2] + b.control[1]));
}

Vector3 bezier_third(const CubicBezier& b) {
  return 6 * (b.control[3] - 3 * b.control[2] + 3 * b.control[1] - b.control[0]);
}

double polygon_length(const CubicBezier& b) {
  return (b.control[1] - b.control[0]).norm() + (b.control[2] - b.control[1]).norm() +
         (b.control[3] - b.control[2]).norm();
}

double curvature_of(const Vector3& first, const Vector3& second) {
  const double speed = first.norm();
  return speed > 0 ? first.cross(second).norm() / (speed * speed * speed) : 0.0;
}

// Halves [a, b] until two halves agree with the whole. The five-point rule gains a factor
// of 1000 per halving on smooth speeds, so the halves are far better than their difference
// to the whole; the depth ends the search at a cusp, where each half adds half as much.
template <typename Speed>
double integrate(const Speed& speed, double a, double b, double whole, double allowed, int depth) {
  const double middle = (a + b) / 2;
  const double left = gauss5(speed, a, middle);
  const double right = gauss5(speed, middle, b);
  if (depth == 0 || std::abs(left + right - whole) <= allowed) return left + right;
  return integrate(speed, a, middle, left, allowed, depth - 1) +
         integrate(speed, middle, b, right, allowed, depth - 1);
}

template <typename Speed>
double integrate_speed(const Speed& speed) {
  constexpr double kRelativeError = 1e-11;  // of the whole; a few sub-intervals add theirs
  constexpr int kDepth = 30;
  const double whole = gauss5(speed, 0, 1);
  return integrate(speed, 0.0, 1.0, whole, kRelativeError * whole, kDepth);
}

}  // namespace

Point3 start_point(const PathPiece& piece) {
  if (const auto* bezier = std::get_if<CubicBezier>(&piece)) return bezier->control[0];
  const auto* line = std::get_if<Line>(&piece);
  return line != nullptr ? line->start : std::get<Arc>(piece).start;
}

Point3 end_point(const PathPiece& piece) {
  if (const auto* bezier = std::get_if<CubicBezier>(&piece)) return bezier->control[3];
  const auto* line = std::get_if<Line>(&piece);
  return line != nullptr ? line->end : std::get<Arc>(piece).end;
}

Point3 point_at(const CubicBezier& piece, double t) {
  const Point3* p = piece.control;
  if (t <= 0) return p[0];
  if (t >= 1) return p[3];
  const double s = 1 - t;
  return s * s * s * p[0] + 3 * s * s * t * p[1] + 3 * s * t * t * p[2] + t * t * t * p[3];
}

Point3 point_at(const PathPiece& piece, double t) {
  if (t <= 0) return start_point(piece);
  if (t >= 1) return end_point(piece);
  if (const auto* line = std::get_if<Line>(&piece)) {
    return line->start + t * (line->end - line->start);
  }
  if (const auto* arc = std::get_if<Arc>(&piece)) return ArcFrame(*arc).point(t);
  return point_at(std::get<CubicBezier>(piece), t);
}

// Where the first derivative vanishes, Taylor's next term gives the direction: leaving the
// place for t < 1, arriving at it for t = 1.
Vector3 direction_at(const CubicBezier& b, double t) {
  const double nothing = kNoDerivative * polygon_length(b);
  const Vector3 first = bezier_first(b, t);
  if (first.norm() > nothing) return first.normalized();
  const Vector3 second = bezier_second(b, t);
  if (second.norm() > nothing) return (t < 1 ? 1.0 : -1.0) * second.normalized();
  return unit_or_zero(bezier_third(b));
}

Vector3 direction_at(const PathPiece& piece, double t) {
  if (const auto* line = std::get_if<Line>(&piece)) return unit_or_zero(line->end - line->start);
  if (const auto* arc = std::get_if<Arc>(&piece)) {
    const ArcFrame frame(*arc);
    return unit_or_zero(frame.in_space(t, frame.velocity(t)));
  }
  return direction_at(std::get<CubicBezier>(piece), t);
}

double radius_of(const Arc& arc) {
  const Vector3 out = arc.start - arc.center;
  return (out - out.dot(arc.axis) * arc.axis).norm();
}

double length_of(const PathPiece& piece) {
  if (const auto* line = std::get_if<Line>(&piece)) return (line->end - line->start).norm();
  if (const auto* arc = std::get_if<Arc>(&piece)) {
    const ArcFrame frame(*arc);
    if (frame.growth() == 0) return frame.velocity(0).norm();
    return integrate_speed([&frame](double t) { return frame.velocity(t).norm(); });
  }
  const auto& bezier = std::get<CubicBezier>(piece);
  return integrate_speed([&bezier](double t) { return bezier_first(bezier, t).norm(); });
}

double curvature_at(const PathPiece& piece, double t) {
  if (std::holds_alternative<Line>(piece)) return 0;
  if (const auto* arc = std::get_if<Arc>(&piece)) {
    const ArcFrame frame(*arc);
    return curvature_of(frame.velocity(t), frame.acceleration(t));
  }
  const auto& bezier = std::get<CubicBezier>(piece);
  return curvature_of(bezier_first(bezier, t), bezier_second(bezier, t));
}

double second_derivative_bound(const PathPiece& piece) {
  if (std::holds_alternative<Line>(piece)) return 0;
  if (const auto* arc = std::get_if<Arc>(&piece)) {
    const ArcFrame frame(*arc);
    const double inward = frame.greatest_radius() * frame.sweep() * frame.sweep();
    return std::hypot(inward, 2 * frame.growth() * frame.sweep());
  }
  const auto& bezier = std::get<CubicBezier>(piece);  // linear in t, so greatest at an end
  return std::max(bezier_second(bezier, 0).norm(), bezier_second(bezier, 1).norm());
}

CubicBezier sub_piece(const CubicBezier& piece, double t0, double t1) {
  const Point3* p = piece.control;
  // The blossom of the cubic at (t0,t0,t0), (t0,t0,t1), (t0,t1,t1), (t1,t1,t1).
  const auto blossom = [p](double u, double v, double w) -> Point3 {
    Point3 d[3];
    for (int i = 0; i < 3; ++i) d[i] = (1 - u) * p[i] + u * p[i + 1];
    for (int i = 0; i < 2; ++i) d[i] = (1 - v) * d[i] + v * d[i + 1];
    return (1 - w) * d[0] + w * d[1];
  };
  CubicBezier part;
  part.control[0] = t0 > 0 ? blossom(t0, t0, t0) : p[0];
  part.control[1] = blossom(t0, t0, t1);
  part.control[2] = blossom(t0, t1, t1);
  part.control[3] = t1 < 1 ? blossom(t1, t1, t1) : p[3];
  return part;
}

PathPiece sub_piece(const PathPiece& piece, double t0, double t1) {
  if (const auto* bezier = std::get_if<CubicBezier>(&piece)) return sub_piece(*bezier, t0, t1);
  const Point3 start = point_at(piece, t0);
  const Point3 end = point_at(piece, t1);
  const auto* arc = std::get_if<Arc>(&piece);
  if (arc == nullptr) return Line{start, end};
  return Arc{start, end, arc->center, arc->axis, arc->sweep * (t1 - t0)};
}

namespace {

bool turns_about_z(const Arc& arc) { return std::abs(arc.axis.z()) > 1 - kSameDirection; }

// About the same centre. An arc that is left on its inside by more than its radius goes on beyond
// the centre; on the centre itself it is a point.
PathPiece moved_arc(Arc moved, const Vector3& at_start, const Vector3& at_end) {
  moved.start += at_start;
  moved.end += at_end;
  const Vector3 out = moved.start - moved.center;
  if (std::hypot(out.x(), out.y()) <= kSamePlace) return Line{moved.start, moved.end};
  return moved;
}

class Parallel {
 public:
  Parallel(std::span<const PathPiece> path, double distance) : path_(path), distance_(distance) {}

  std::optional<Path> make() {
    last_ = first_shift();
    for (const PathPiece& piece : path_) {
      const Vector3 start = shift_at(piece, 0);
      join(start_point(piece), start);
      last_ = start;
      const Vector3 end = shift_at(piece, 1);
      if (const auto* line = std::get_if<Line>(&piece)) {
        made_.push_back(Line{line->start + start, line->end + end});
      } else if (const auto* arc = std::get_if<Arc>(&piece); arc && turns_about_z(*arc)) {
        made_.push_back(moved_arc(*arc, start, end));
      } else {
        return std::nullopt;
      }
      last_ = end;
    }
    return std::move(made_);
  }

 private:
  [[nodiscard]] Vector3 first_shift() const {
    for (const PathPiece& piece : path_) {
      const Vector3 left = left_of(direction_at(piece, 0));
      if (!left.isZero()) return distance_ * left;
    }
    return Vector3::Zero();
  }

  // That of the piece before where this one has no side.
  [[nodiscard]] Vector3 shift_at(const PathPiece& piece, double t) const {
    const Vector3 left = left_of(direction_at(piece, t));
    return left.isZero() ? last_ : Vector3(distance_ * left);
  }

  void join(const Point3& vertex, const Vector3& next) {
    const double turn = std::atan2(last_.x() * next.y() - last_.y() * next.x(), last_.dot(next));
    if (std::abs(turn) <= kSameDirection) return;
    made_.push_back(Arc{vertex + last_, vertex + next, vertex, Vector3::UnitZ(), turn});
  }

  std::span<const PathPiece> path_;
  double distance_;  // to the left, negative: to the right
  Vector3 last_ = Vector3::Zero();
  Path made_;
};

}  // namespace

Vector3 left_of(const Vector3& direction) {
  const Vector3 left(-direction.y(), direction.x(), 0);
  const double length = left.norm();
  return length <= kSameDirection ? Vector3(Vector3::Zero()) : Vector3(left / length);
}

std::optional<Path> parallel_path(std::span<const PathPiece> path, Side side, double distance) {
  if (side == Side::kBoth) return std::nullopt;
  return Parallel(path, side == Side::kLeft ? distance : -distance).make();
}

}  // namespace batten::geometry
