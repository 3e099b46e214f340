#include "gcode/curves/g5_chopping.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "geometry/basic/point.h"
#include "geometry/path/bezier_halves.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;

// The settings of their sources, which no setting of the machine changes.
constexpr double kNear = 0.1;  // mm, |x| + |y| between the curve and the middle of its chord
constexpr double kLeastStep = 0.002;
constexpr double kGreatestStep = 0.1;

double sum_of_axes(const Point3& a, const Point3& b) {
  return std::abs(a.x() - b.x()) + std::abs(a.y() - b.y());
}

// The chord from t to the place that is found, step by step as they do.
class Chopper {
 public:
  explicit Chopper(const CubicBezier& piece) : piece_(piece) {}

  std::vector<double> chop() {
    std::vector<double> ends;
    while (t_ < 1) {
      const double end = end_after(std::min(t_ + step_, 1.0));
      step_ = end - t_;
      t_ = end;
      ends.push_back(t_);
    }
    return ends;
  }

 private:
  // Halved while the chord is off; doubled only where it was not.
  [[nodiscard]] double end_after(double end) const {
    bool halved = false;
    while (end - t_ >= kLeastStep) {
      const double middle = 0.5 * (t_ + end);
      if (is_near(middle, end)) break;
      end = middle;
      halved = true;
    }
    while (!halved && end - t_ <= kGreatestStep) {
      const double twice = t_ + 2 * (end - t_);
      if (twice >= 1 || !is_near(end, twice)) break;
      end = twice;
    }
    return end;
  }

  [[nodiscard]] bool is_near(double middle, double end) const {
    const Point3 of_chord =
        0.5 * (geometry::point_at(piece_, t_) + geometry::point_at(piece_, end));
    return sum_of_axes(geometry::point_at(piece_, middle), of_chord) <= kNear;
  }

  const CubicBezier& piece_;
  double t_ = 0;
  double step_ = kGreatestStep;
};

// The distance from a chord is convex, 0 at its ends, and the inner control points have weights
// whose sum is 3 t (1 - t): the curve is off by 3/4 of the greater of theirs at the most.
double flatness(const CubicBezier& part) {
  const auto& p = part.control;
  const geometry::Vector3 way = p[3] - p[0];
  const double square = way.squaredNorm();
  const auto off = [&](const Point3& point) {
    const geometry::Vector3 to = point - p[0];
    const double along = square > 0 ? std::clamp(to.dot(way) / square, 0.0, 1.0) : 0;
    return (to - along * way).norm();
  };
  return 0.75 * std::max(off(p[1]), off(p[2]));
}

}  // namespace

std::vector<double> chopped_at(const CubicBezier& piece) { return Chopper(piece).chop(); }

double chopping_error(const CubicBezier& piece) {
  double most = 0;
  double from = 0;
  CubicBezier rest = piece;
  for (const double end : chopped_at(piece)) {
    CubicBezier part = rest;
    if (end < 1) std::tie(part, rest) = geometry::parts_at(rest, (end - from) / (1 - from));
    most = std::max(most, flatness(part));
    from = end;
  }
  return most;
}

}  // namespace batten::gcode
