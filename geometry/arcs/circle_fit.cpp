#include "geometry/arcs/circle_fit.h"

#include <cmath>
#include <cstddef>

#include "geometry/basic/operations.h"
#include "geometry/basic/rounding.h"

namespace batten::geometry {

namespace {

constexpr int kSteps = 6;  // of Gauss-Newton, from a circle through three of the points

// Nothing where they are on one line.
std::optional<Point2> center_through(const Point2& a, const Point2& b, const Point2& c) {
  const Vector2 u = b - a;
  const Vector2 v = c - a;
  const double area = 2 * (u.x() * v.y() - u.y() * v.x());
  if (std::abs(area) <= kSamePlace * kSamePlace) return std::nullopt;
  const Vector2 off(v.y() * u.squaredNorm() - u.y() * v.squaredNorm(),
                    u.x() * v.squaredNorm() - v.x() * u.squaredNorm());
  return a + off / area;
}

// The centre has one freedom, along the bisector of the ends, or two where they are one place.
class CircleSearch {
 public:
  CircleSearch(std::span<const Point2> points, const Point2& center)
      : points_(points), center_(center) {
    const Vector2 chord = points.back() - points.front();
    is_closed_ = chord.norm() <= kSamePlace;
    if (is_closed_) return;
    along_ = Vector2(-chord.y(), chord.x()).normalized();
    const Point2 middle = 0.5 * (points.front() + points.back());
    center_ = middle + (center - middle).dot(along_) * along_;
  }

  [[nodiscard]] Point2 center() const { return center_; }

  void step() {
    const Vector2 to_start = (center_ - points_.front()).normalized();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    Vector2 sum = Vector2::Zero();
    const double radius = (center_ - points_.front()).norm();
    for (const Point2& p : points_) {
      const Vector2 from = center_ - p;
      const double length = from.norm();
      if (!(length > 0)) return;
      const Vector2 slope = from / length - to_start;
      squares += slope * slope.transpose();
      sum += slope * (length - radius);
    }
    if (is_closed_) {
      center_ -= squares.ldlt().solve(sum);
      return;
    }
    const double square = along_.dot(squares * along_);
    if (square > 0) center_ -= along_.dot(sum) / square * along_;
  }

 private:
  std::span<const Point2> points_;
  Point2 center_;
  Vector2 along_ = Vector2::Zero();
  bool is_closed_ = false;
};

bool goes_round(std::span<const Point2> points, const CircleLimits& limits, CircleFit& circle) {
  const auto from_center = [&](std::size_t i) -> Vector2 { return points[i] - circle.center; };
  circle.angles.assign(1, 0);
  double squares = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector2 a = from_center(i - 1);
    const Vector2 b = from_center(i);
    const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    const bool is_other_way = i > 1 && turn * circle.angles.back() <= 0;
    if (is_other_way || turn == 0) return false;
    circle.angles.push_back(circle.angles.back() + turn);
    const double off = std::abs(b.norm() - circle.radius);
    squares += off * off;
    const double sagitta = circle.radius * (1 - std::cos(turn / 2));
    if (off > limits.off || sagitta > limits.chord) return false;
  }
  circle.rms = std::sqrt(squares / static_cast<double>(points.size()));
  return std::abs(circle.angles.back()) <= 2 * kPi * (1 + kSameDirection);
}

}  // namespace

std::optional<CircleFit> fit_circle(std::span<const Point2> points, const CircleLimits& limits) {
  if (points.size() < kFewestOnCircle) return std::nullopt;
  const std::size_t third = points.size() / 3;
  const auto center = center_through(points.front(), points[third], points[2 * third]);
  if (!center) return std::nullopt;
  // Most paths are no circle, and a few of their points show it.
  const double radius = (*center - points.front()).norm();
  for (std::size_t k = 1; k <= 8; ++k) {
    const Point2& p = points[k * (points.size() - 1) / 8];
    if (std::abs((*center - p).norm() - radius) > 8 * limits.off) return std::nullopt;
  }
  count_operations(kSteps * points.size());
  CircleSearch search(points, *center);
  for (int i = 0; i < kSteps; ++i) search.step();
  CircleFit circle;
  circle.center = search.center();
  circle.radius = (circle.center - points.front()).norm();
  if (!goes_round(points, limits, circle)) return std::nullopt;
  return circle;
}

}  // namespace batten::geometry
