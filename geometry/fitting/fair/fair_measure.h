// Looks at a fair curve beside its polyline: where its vertices are, how far it leaves its edges,
// how long the machine takes. Everything edge by edge, so that what did not move is not looked at
// again.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// A cubic spline, quick to evaluate at parameters that mostly go forward.
class SplineWalk {
 public:
  // Both must outlive it. Clamped at the ends.
  SplineWalk(std::span<const double> knots, std::span<const Point3> control_points);

  [[nodiscard]] Point3 point_at(double u) {
    go_to(u);
    const std::array<Vector3, 4>& power = power_[span_ % kKept];
    const double x = u - t_[span_];
    return power[0] + x * (power[1] + x * (power[2] + x * power[3]));
  }
  [[nodiscard]] double curvature_at(double u);  // 1/mm; 0 where the first derivative vanishes
  // 1/mm^2: length of the third derivative by length; 0 where the first derivative vanishes.
  [[nodiscard]] double third_by_length_at(double u);

  // The parameter after one Newton step from u towards the point nearest to p.
  [[nodiscard]] double nearer(double u, const Point3& p);

  // The end of the polynomial piece that holds u: the first knot after it.
  [[nodiscard]] double end_of_piece(double u);

 private:
  // Spans whose coefficients are kept: an edge and its neighbours are looked at in turn.
  static constexpr std::size_t kKept = 8;

  struct Derivatives {
    Vector3 first;
    Vector3 second;
    Vector3 third;
  };
  [[nodiscard]] Derivatives derivatives_at(double u);
  void go_to(double u) {
    if (!(u >= t_[span_] && (u < t_[span_ + 1] || span_ + 1 == p_.size()))) find_span(u);
  }
  void find_span(double u);
  void take_span();

  std::span<const double> t_;
  std::span<const Point3> p_;
  std::size_t span_;
  // Coefficients by the parameter since the start of a span, and which spans these are.
  std::array<std::array<Vector3, 4>, kKept> power_;
  std::array<std::size_t, kKept> kept_{};
};

// A polyline and the parameters of its vertices on a curve.
struct VertexPlaces {
  std::span<const Point3> points;
  std::span<const double> parameters;
};

// The parameter of the point of the curve nearest to a vertex, near `start[vertex]`: not past the
// middle of the way to its neighbours there; the first and the last vertex stay.
[[nodiscard]] double nearest_parameter(SplineWalk& curve, std::span<const Point3> points,
                                       std::span<const double> start, std::size_t vertex);

// The greatest distance between an edge and the curve beside it, by samples, near in order; that
// of its vertices counts. Parts that may exceed `limit` are looked at more closely.
[[nodiscard]] double edge_deviation(SplineWalk& curve, const VertexPlaces& path, std::size_t edge,
                                    double limit);

// The greatest of them.
[[nodiscard]] double greatest_deviation(const BsplineCurve& curve, const VertexPlaces& path,
                                        double limit);

struct TravelLimits {
  double speed = 0;                                       // mm/s
  double acceleration = 0;                                // mm/s^2 across the path
  double jerk = std::numeric_limits<double>::infinity();  // mm/s^3 at a speed that is held
};

// mm/s: the speed that these limits allow at u if it is held there.
[[nodiscard]] double speed_at(SplineWalk& curve, double u, const TravelLimits& limits);

// Whether the curve bends or twists too much at u for the limits' own speed.
[[nodiscard]] bool exceeds(SplineWalk& curve, double u, const TravelLimits& limits);

// Seconds along the curve beside an edge, at that speed.
[[nodiscard]] double edge_time(SplineWalk& curve, const VertexPlaces& path, std::size_t edge,
                               const TravelLimits& limits);

}  // namespace batten::geometry
