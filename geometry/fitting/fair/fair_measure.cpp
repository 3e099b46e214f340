#include "geometry/fitting/fair/fair_measure.h"

#include <algorithm>
#include <cmath>

namespace batten::geometry {

namespace {

constexpr std::size_t kFairDegree = 3;

// Samples of a piece of the curve beside an edge: between them a bow rises by a sixteenth more.
// Many more where one of them is further off than this part of the limit.
constexpr int kParts = 4;
constexpr int kMoreParts = 24;
constexpr double kLookCloser = 0.6;

// Distance to an edge or to its neighbours, the least of them; `enough` ends the search.
double distance_beside(std::span<const Point3> points, std::size_t edge, const Point3& p,
                       double enough) {
  double nearest = distance_to_segment(p, points[edge], points[edge + 1]);
  if (nearest > enough && edge > 0) {
    nearest = std::min(nearest, distance_to_segment(p, points[edge - 1], points[edge]));
  }
  if (nearest > enough && edge + 2 < points.size()) {
    nearest = std::min(nearest, distance_to_segment(p, points[edge + 1], points[edge + 2]));
  }
  return nearest;
}

double worst_of_piece(SplineWalk& curve, std::span<const Point3> points, std::size_t edge,
                      double from, double to, int parts, double worst) {
  for (int k = 0; k < parts; ++k) {
    const Point3 here = curve.point_at(from + (to - from) * k / parts);
    worst = std::max(worst, distance_beside(points, edge, here, worst));
  }
  return worst;
}

}  // namespace

SplineWalk::SplineWalk(std::span<const double> knots, std::span<const Point3> control_points)
    : t_(knots), p_(control_points), span_(kFairDegree) {
  find_span(knots[kFairDegree]);
}

void SplineWalk::find_span(double u) {
  constexpr std::size_t kNear = 8;  // spans that are tried one by one
  if (u >= t_[span_] && (span_ + kNear >= p_.size() || u < t_[span_ + kNear])) {
    while (span_ + 1 < p_.size() && t_[span_ + 1] <= u) ++span_;
  } else if (u < t_[span_] && span_ >= kFairDegree + kNear && u >= t_[span_ - kNear]) {
    while (u < t_[span_]) --span_;
  } else {
    const auto begin = t_.begin() + kFairDegree;
    const auto end = t_.begin() + static_cast<std::ptrdiff_t>(p_.size());
    const auto above = std::upper_bound(begin, end, u);
    span_ = std::max(static_cast<std::size_t>(above - t_.begin()), kFairDegree + 1) - 1;
  }
  take_span();
}

// Taylor's series at the start of the span: de Boor's algorithm for the curve and its derivatives,
// where all that is left of it at a knot is written out.
void SplineWalk::take_span() {
  if (kept_[span_ % kKept] == span_) return;
  kept_[span_ % kKept] = span_;
  std::array<Vector3, 4>& power = power_[span_ % kKept];
  const double* t = &t_[span_];
  const Point3* p = &p_[span_];
  const Vector3 d0 = 3 / (t[1] - t[-2]) * (p[-2] - p[-3]);
  const Vector3 d1 = 3 / (t[2] - t[-1]) * (p[-1] - p[-2]);
  const Vector3 d2 = 3 / (t[3] - t[0]) * (p[0] - p[-1]);
  const Vector3 s0 = 2 / (t[1] - t[-1]) * (d1 - d0);
  const Vector3 s1 = 2 / (t[2] - t[0]) * (d2 - d1);
  const double low = (t[0] - t[-2]) / (t[1] - t[-2]);
  const double high = (t[0] - t[-1]) / (t[2] - t[-1]);
  const double middle = (t[0] - t[-1]) / (t[1] - t[-1]);
  const Point3 before = (1 - low) * p[-3] + low * p[-2];
  const Point3 after = (1 - high) * p[-2] + high * p[-1];
  power[0] = (1 - middle) * before + middle * after;
  power[1] = (1 - middle) * d0 + middle * d1;
  power[2] = 0.5 * s0;
  power[3] = (s1 - s0) / (6 * (t[1] - t[0]));
}

[[gnu::always_inline]] inline SplineWalk::Derivatives SplineWalk::derivatives_at(double u) {
  go_to(u);
  const std::array<Vector3, 4>& power = power_[span_ % kKept];
  const double x = u - t_[span_];
  return {power[1] + x * (2 * power[2] + 3 * x * power[3]), 2 * power[2] + 6 * x * power[3],
          6 * power[3]};
}

double SplineWalk::curvature_at(double u) {
  const auto [first, second, third] = derivatives_at(u);
  const double speed = first.norm();
  return speed == 0 ? 0 : first.cross(second).norm() / (speed * speed * speed);
}

double SplineWalk::third_by_length_at(double u) {
  const auto [first, second, third] = derivatives_at(u);
  const double speed = first.norm();
  if (speed == 0) return 0;
  // Of speed: its first and second derivative by the parameter.
  const double faster = first.dot(second) / speed;
  const double faster_yet = (second.squaredNorm() + first.dot(third) - faster * faster) / speed;
  const Vector3 bend = (second - faster / speed * first) / (speed * speed);
  const Vector3 rest = third - 3 * speed * faster * bend - faster_yet / speed * first;
  return rest.norm() / (speed * speed * speed);
}

double SplineWalk::nearer(double u, const Point3& p) {
  const Vector3 first = derivatives_at(u).first;
  const double squared = first.squaredNorm();
  return squared == 0 ? u : u + (p - point_at(u)).dot(first) / squared;
}

double SplineWalk::end_of_piece(double u) {
  go_to(u);
  return t_[span_ + 1];
}

double nearest_parameter(SplineWalk& curve, std::span<const Point3> points,
                         std::span<const double> start, std::size_t vertex) {
  const double from = start[vertex];
  if (vertex == 0 || vertex + 1 == start.size()) return from;
  const double low = 0.5 * (start[vertex - 1] + from);
  const double high = 0.5 * (from + start[vertex + 1]);
  double u = from;
  for (int step = 0; step < 2; ++step) {
    u = std::clamp(curve.nearer(u, points[vertex]), low, high);
  }
  return u;
}

double edge_deviation(SplineWalk& curve, const VertexPlaces& path, std::size_t edge, double limit) {
  const double from = path.parameters[edge];
  const double to = path.parameters[edge + 1];
  double worst = (curve.point_at(from) - path.points[edge]).norm();
  for (double a = from; a < to;) {
    const double b = std::min(to, std::max(curve.end_of_piece(a), std::nextafter(a, to)));
    worst = worst_of_piece(curve, path.points, edge, a, b, kParts, worst);
    if (worst > kLookCloser * limit) {
      worst = worst_of_piece(curve, path.points, edge, a, b, kMoreParts, worst);
    }
    a = b;
  }
  return std::max(worst, (curve.point_at(to) - path.points[edge + 1]).norm());
}

double greatest_deviation(const BsplineCurve& curve, const VertexPlaces& path, double limit) {
  SplineWalk walk(curve.basis().knots(), curve.control_points());
  double worst = 0;
  for (std::size_t edge = 0; edge + 1 < path.points.size(); ++edge) {
    worst = std::max(worst, edge_deviation(walk, path, edge, limit));
  }
  return worst;
}

double speed_at(SplineWalk& curve, double u, const TravelLimits& limits) {
  const double bend = std::max(curve.curvature_at(u), 1e-9);
  double speed = std::min(limits.speed, std::sqrt(limits.acceleration / bend));
  if (std::isfinite(limits.jerk)) {
    const double twist = std::max(curve.third_by_length_at(u), 1e-12);
    speed = std::min(speed, std::cbrt(limits.jerk / twist));
  }
  return speed;
}

bool exceeds(SplineWalk& curve, double u, const TravelLimits& limits) {
  const double allowed_third = limits.jerk / (limits.speed * limits.speed * limits.speed);
  if (std::isfinite(allowed_third) && curve.third_by_length_at(u) > allowed_third) return true;
  return curve.curvature_at(u) > limits.acceleration / (limits.speed * limits.speed);
}

double edge_time(SplineWalk& curve, const VertexPlaces& path, std::size_t edge,
                 const TravelLimits& limits) {
  constexpr int kSteps = 4;
  const double from = path.parameters[edge];
  const double step = (path.parameters[edge + 1] - from) / kSteps;
  double time = 0;
  Point3 before = curve.point_at(from);
  for (int k = 1; k <= kSteps; ++k) {
    const double speed = speed_at(curve, from + (k - 0.5) * step, limits);
    const Point3 here = curve.point_at(from + k * step);
    time += (here - before).norm() / speed;
    before = here;
  }
  return time;
}

}  // namespace batten::geometry
