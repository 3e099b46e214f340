#include "geometry/path/bspline_basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace batten::geometry {

BsplineBasis::BsplineBasis(int degree, std::vector<double> knots)
    : degree_(degree), knots_(std::move(knots)) {
  if (degree < 1 || degree > kMaxDegree) {
    throw std::invalid_argument("BsplineBasis: degree " + std::to_string(degree) +
                                ", expected 1 to " + std::to_string(kMaxDegree));
  }
  const std::size_t fewest = 2 * (static_cast<std::size_t>(degree) + 1);
  if (knots_.size() < fewest) {
    throw std::invalid_argument("BsplineBasis: " + std::to_string(knots_.size()) +
                                " knots, expected " + std::to_string(fewest) +
                                " or more (2 * (degree + 1))");
  }
  const auto drop = std::is_sorted_until(knots_.begin(), knots_.end());
  if (drop != knots_.end()) {
    throw std::invalid_argument("BsplineBasis: knot " +
                                std::to_string(std::distance(knots_.begin(), drop)) +
                                " is below the one before it");
  }
  if (!(first() < last())) {
    throw std::invalid_argument("BsplineBasis: the interval from " + std::to_string(first()) +
                                " to " + std::to_string(last()) + " is empty");
  }
}

BsplineBasis BsplineBasis::clamped(int degree, const std::vector<double>& breakpoints) {
  if (breakpoints.size() < 2) {
    throw std::invalid_argument("BsplineBasis::clamped: " + std::to_string(breakpoints.size()) +
                                " breakpoints, expected 2 or more");
  }
  const auto p = static_cast<std::size_t>(degree);
  std::vector<double> knots;
  knots.reserve(breakpoints.size() + 2 * p);
  knots.insert(knots.end(), p, breakpoints.front());
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
  // The functions of every degree q <= p at u; the derivatives of degree p are differences
  // of those (Piegl and Tiller, (2.9)): N'_{i,q} = q (N_{i,q-1}/(t_{i+q} - t_i) -
  // N_{i+1,q-1}/(t_{i+q+1} - t_{i+1})). rows[q][j] is function span - q + j of degree q.
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

}  // namespace batten::geometry
