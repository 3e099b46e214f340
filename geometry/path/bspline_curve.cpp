#include "geometry/path/bspline_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/basic/require.h"
#include "geometry/path/cubic_polynomial.h"

namespace batten::geometry {

BsplineBasis::BsplineBasis(int degree, std::vector<double> knots)
    : degree_(degree), knots_(std::move(knots)) {
  const auto refuse = [](const std::string& why) {
    throw std::invalid_argument("BsplineBasis: " + why);
  };
  if (degree < 1 || degree > kMaxDegree) {
    refuse(fmt::format("degree {}, expected 1 to {}", degree, kMaxDegree));
  }
  const std::size_t fewest = 2 * (static_cast<std::size_t>(degree) + 1);
  if (knots_.size() < fewest) {
    refuse(fmt::format("{} knots, expected {} or more (2 * (degree + 1))", knots_.size(), fewest));
  }
  const auto drop = std::is_sorted_until(knots_.begin(), knots_.end());
  if (drop != knots_.end()) {
    refuse(fmt::format("knot {} is below the one before it", drop - knots_.begin()));
  }
  if (!(first() < last())) {
    refuse(fmt::format("the interval from {:f} to {:f} is empty", first(), last()));
  }
}

BsplineBasis BsplineBasis::clamped(int degree, const std::vector<double>& breakpoints) {
  require(breakpoints.size() >= 2, "BsplineBasis::clamped: breakpoints",
          static_cast<double>(breakpoints.size()), "2 or more");
  const auto p = static_cast<std::size_t>(degree);
  std::vector<double> knots(p, breakpoints.front());
  knots.insert(knots.end(), breakpoints.begin(), breakpoints.end());
  knots.insert(knots.end(), p, breakpoints.back());
  return BsplineBasis(degree, std::move(knots));
}

std::size_t BsplineBasis::find_span(double u) const {
  const auto begin = knots_.begin() + degree_;
  const auto end = knots_.begin() + static_cast<std::ptrdiff_t>(size());
  if (u >= last()) u = std::nextafter(last(), first());
  // The last knot <= u; a parameter below the first counts as the first.
  const auto above = std::upper_bound(begin, end, std::max(u, first()));
  return static_cast<std::size_t>(std::distance(knots_.begin(), above)) - 1;
}

void BsplineBasis::evaluate(std::size_t span, double u, double* values) const {
  // Piegl and Tiller, algorithm A2.2; left[j] = u - t_{k+1-j}, right[j] = t_{k+j} - u.
  std::array<double, kMaxDegree + 1> left{};
  std::array<double, kMaxDegree + 1> right{};
  const auto& t = knots_;
  values[0] = 1;
  for (int j = 1; j <= degree_; ++j) {
    left[j] = u - t[span + 1 - j];
    right[j] = t[span + j] - u;
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      const double part = values[r] / (right[r + 1] + left[j - r]);
      values[r] = saved + right[r + 1] * part;
      saved = left[j - r] * part;
    }
    values[j] = saved;
  }
}

void BsplineBasis::evaluate_derivatives(std::size_t span, double u, int derivatives,
                                        double* values) const {
  // rows[q][j] is function span - q + j of degree q <= p. Derivatives are differences of those
  // (Piegl and Tiller, (2.9)): N'_{i,q} = q (N_{i,q-1}/(t_{i+q} - t_i) -
  // N_{i+1,q-1}/(t_{i+q+1} - t_{i+1})).
  const int p = degree_;
  const auto& t = knots_;
  std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1> rows{};
  rows[0][0] = 1;
  for (int q = 1; q <= p; ++q) {
    for (int j = 0; j <= q; ++j) {
      const std::size_t i = span - q + j;
      double value = 0;
      if (j > 0) value += (u - t[i]) / (t[i + q] - t[i]) * rows[q - 1][j - 1];
      if (j < q) value += (t[i + q + 1] - u) / (t[i + q + 1] - t[i + 1]) * rows[q - 1][j];
      rows[q][j] = value;
    }
  }
  const std::ptrdiff_t stride = p + 1;
  for (int d = 0; d <= derivatives; ++d) {
    if (d > p) {
      std::fill_n(values + d * stride, stride, 0.0);
      continue;
    }
    // Raise the degree from p - d back to p, one derivative each time.
    std::array<double, kMaxDegree + 2> row{};
    std::copy_n(rows[p - d].begin(), p - d + 1, row.begin());
    for (int q = p - d + 1; q <= p; ++q) {
      std::array<double, kMaxDegree + 2> next{};
      for (int j = 0; j <= q; ++j) {
        const std::size_t i = span - q + j;
        double value = 0;
        if (j > 0) value += row[j - 1] / (t[i + q] - t[i]);
        if (j < q) value -= row[j] / (t[i + q + 1] - t[i + 1]);
        next[j] = q * value;
      }
      row = next;
    }
    std::copy_n(row.begin(), stride, values + d * stride);
  }
}

double BsplineBasis::greville(std::size_t i) const {
  double sum = 0;
  for (int j = 1; j <= degree_; ++j) sum += knots_[i + j];
  return sum / degree_;
}

namespace {

// A derivative shorter than this part of the curve's speed (control polygon by parameter)
// is zero: cancellation leaves some 1e-15 of it.
constexpr double kNoSpeed = 1e-12;

}  // namespace

BsplineCurve::BsplineCurve(BsplineBasis basis, std::vector<Point3> control_points)
    : basis_(std::move(basis)), control_points_(std::move(control_points)) {
  if (control_points_.size() != basis_.size()) {
    throw std::invalid_argument(
        fmt::format("BsplineCurve: {} control points, expected {} (knots - degree - 1)",
                    control_points_.size(), basis_.size()));
  }
}

Point3 BsplineCurve::point_at(double u) const {
  if (u <= first() && basis_.knots()[0] == first()) return control_points_.front();
  if (u >= last() && basis_.knots().back() == last()) return control_points_.back();
  const std::size_t span = basis_.find_span(u);
  std::array<double, kMaxDegree + 1> n{};
  basis_.evaluate(span, std::clamp(u, first(), last()), n.data());
  Point3 point = Point3::Zero();
  const std::size_t offset = span - degree();
  for (int j = 0; j <= degree(); ++j) point += n[j] * control_points_[offset + j];
  return point;
}

Vector3 BsplineCurve::derivative_at(double u, int order) const {
  const std::size_t span = basis_.find_span(u);
  constexpr std::size_t kOrder = kMaxDegree + 1;
  std::array<double, kOrder * kOrder> n{};
  if (order > degree()) return Vector3::Zero();
  basis_.evaluate_derivatives(span, std::clamp(u, first(), last()), order, n.data());
  Vector3 sum = Vector3::Zero();
  const int row = order * (degree() + 1);
  for (int j = 0; j <= degree(); ++j) {
    sum += n[row + j] * control_points_[span - degree() + j];
  }
  return sum;
}

Vector3 BsplineCurve::direction_at(double u) const {
  const std::size_t span = basis_.find_span(u);
  double polygon = 0;
  for (int j = 0; j < degree(); ++j) {
    polygon += (control_points_[span - j] - control_points_[span - j - 1]).norm();
  }
  const double width = basis_.knots()[span + 1] - basis_.knots()[span];
  const bool at_end = u >= last();
  for (int order = 1; order <= degree(); ++order) {
    const Vector3 d = derivative_at(u, order);
    const double size = d.norm() * std::pow(width, order);
    if (size > kNoSpeed * polygon && size > 0) {
      // Arriving at the end, even derivatives point backwards.
      const bool backwards = at_end && order % 2 == 0;
      return (backwards ? Vector3(-d) : d) / d.norm();
    }
  }
  return Vector3::Zero();
}

double BsplineCurve::curvature_at(double u) const {
  const Vector3 d1 = derivative_at(u, 1);
  const double speed = d1.norm();
  if (speed == 0) return 0;
  return d1.cross(derivative_at(u, 2)).norm() / (speed * speed * speed);
}

BsplineCurve BsplineCurve::part(double from, double to) const {
  if (!(first() <= from && from < to && to <= last())) {
    throw std::invalid_argument(fmt::format(
        "BsplineCurve::part: from {:f} to {:f}, expected an interval inside {:f} to {:f}", from, to,
        first(), last()));
  }
  const auto p = static_cast<std::size_t>(degree());
  const auto& t = basis_.knots();
  const auto inner_begin = std::upper_bound(t.begin(), t.end(), from);
  const auto inner_end = std::lower_bound(inner_begin, t.end(), to);
  std::vector<double> knots(p + 1, from);
  knots.insert(knots.end(), inner_begin, inner_end);
  knots.insert(knots.end(), p + 1, to);

  std::vector<Point3> points;
  points.reserve(knots.size() - p - 1);
  for (std::size_t i = 0; i + p + 1 < knots.size(); ++i) {
    // Any span of the support serves; the widest is the best conditioned.
    std::size_t widest = i;
    for (std::size_t j = i + 1; j <= i + p; ++j) {
      if (knots[j + 1] - knots[j] > knots[widest + 1] - knots[widest]) widest = j;
    }
    const double inside = 0.5 * (knots[widest] + knots[widest + 1]);
    points.push_back(blossom<Point3>(basis_, control_points_, basis_.find_span(inside),
                                     std::span(knots).subspan(i + 1, p)));
  }
  return {BsplineBasis(degree(), std::move(knots)), std::move(points)};
}

BsplineCurve ring_of(const std::vector<double>& breakpoints,
                     const std::vector<Point3>& control_points) {
  constexpr std::size_t kDegree = 3;
  const std::size_t n = control_points.size();
  require(n >= kDegree, "ring_of: control points", static_cast<double>(n), "3 or more");
  require(breakpoints.size() == n + 1, "ring_of: breakpoints",
          static_cast<double>(breakpoints.size()), "one more than control points");
  const bool increase =
      std::ranges::adjacent_find(breakpoints, std::greater_equal{}) == breakpoints.end();
  require(increase, "ring_of: breakpoints from", breakpoints.front(), "strictly increasing ones");
  // Round once more at either end: the knots of the spans before and after, and the points whose
  // functions reach over the begin. Function 1 has its middle knot there.
  const double once = breakpoints.back() - breakpoints.front();
  std::vector<double> knots;
  for (std::size_t i = n - kDegree; i < n; ++i) knots.push_back(breakpoints[i] - once);
  knots.insert(knots.end(), breakpoints.begin(), breakpoints.end());
  for (std::size_t i = 1; i <= kDegree; ++i) knots.push_back(breakpoints[i] + once);
  std::vector<Point3> points = {control_points.back()};
  points.insert(points.end(), control_points.begin(), control_points.end());
  points.insert(points.end(), control_points.begin(), control_points.begin() + 2);
  const BsplineCurve round(BsplineBasis(kDegree, std::move(knots)), std::move(points));
  return round.part(breakpoints.front(), breakpoints.back());
}

std::vector<double> BsplineCurve::breakpoints() const {
  const auto begin = basis_.knots().begin() + degree();
  const auto end = basis_.knots().begin() + static_cast<std::ptrdiff_t>(basis_.size()) + 1;
  std::vector<double> distinct;
  std::unique_copy(begin, end, std::back_inserter(distinct));
  return distinct;
}

std::vector<CubicBezier> BsplineCurve::bezier_pieces() const {
  const int p = degree();
  require(p <= 3, "BsplineCurve::bezier_pieces: degree", p, "3 or less");
  const auto& t = basis_.knots();
  std::vector<CubicBezier> pieces;
  pieces.reserve(basis_.size() - p);
  for (std::size_t span = p; span < basis_.size(); ++span) {
    const double a = t[span];
    const double b = t[span + 1];
    if (!(a < b)) continue;
    std::array<Point3, 4> q;
    for (int bs = 0; bs <= p; ++bs) {
      std::array<double, 3> arguments{};
      for (int j = 0; j < p; ++j) arguments[j] = j < bs ? b : a;
      q[bs] = blossom<Point3>(basis_, control_points_, span, arguments);
    }
    // Neighbours share their joint to the last bit.
    if (!pieces.empty()) q[0] = pieces.back().control[3];
    // Raise lower degrees: point i of degree d + 1 is (i q_{i-1} + (d + 1 - i) q_i)/(d + 1).
    for (int d = p; d < 3; ++d) {
      q[d + 1] = q[d];
      for (int i = d; i >= 1; --i) q[i] = (i * q[i - 1] + (d + 1 - i) * q[i]) / (d + 1);
    }
    pieces.push_back({{q[0], q[1], q[2], q[3]}});
  }
  return pieces;
}

namespace {

// A half is nearer to its polygon by a quarter, so twenty halvings take a millimetre to 1e-12 mm.
constexpr int kMostHalvings = 20;

// `reached` is the greatest |displacement| met so far in the span, so its maximum is no less: a
// part whose bound is less than `slack` above that need not be looked at.
double bound_of(const CubicBezier& piece, double slack, int halvings, double& reached) {
  reached = std::max({reached, piece.control[0].norm(), piece.control[3].norm()});
  double bound = 0;
  for (const Point3& p : piece.control) bound = std::max(bound, p.norm());
  if (bound <= reached + slack || halvings == 0) return bound;
  const auto [left, right] = halves(piece);
  return std::max(bound_of(left, slack, halvings - 1, reached),
                  bound_of(right, slack, halvings - 1, reached));
}

}  // namespace

std::vector<double> displacement_bounds(const BsplineCurve& displacement, double slack) {
  std::vector<double> bounds;
  for (const CubicBezier& piece : displacement.bezier_pieces()) {
    double reached = 0;
    bounds.push_back(bound_of(piece, slack, kMostHalvings, reached));
  }
  return bounds;
}

}  // namespace batten::geometry
