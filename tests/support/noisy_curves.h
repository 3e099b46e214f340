// Curves that a smoother can spoil: a helix with two wrong points, a line with a sawtooth, a U.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "tests/support/naseath_cases.h"

namespace batten::geometry {

// The cubic through the points, chord-length knots, no curvature at the ends.
inline BsplineCurve natural_cubic_through(const std::vector<Point3>& through) {
  std::vector<double> knots = {0};
  for (std::size_t i = 1; i < through.size(); ++i) {
    knots.push_back(knots.back() + (through[i] - through[i - 1]).norm());
  }
  const BsplineBasis basis = BsplineBasis::clamped(3, knots);
  const auto m = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(m, m);
  Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(m, 3);
  const auto set = [&](Eigen::Index row, double u, int derivative) {
    double values[12];
    const std::size_t span = basis.find_span(u);
    basis.evaluate_derivatives(span, u, 2, values);
    for (int j = 0; j < 4; ++j) {
      equations(row, static_cast<Eigen::Index>(span) - 3 + j) = values[derivative * 4 + j];
    }
  };
  for (std::size_t i = 0; i < through.size(); ++i) {
    set(static_cast<Eigen::Index>(i), knots[i], 0);
    sides.row(static_cast<Eigen::Index>(i)) = through[i].transpose();
  }
  set(m - 2, knots.front(), 2);
  set(m - 1, knots.back(), 2);
  const Eigen::MatrixXd solution = equations.partialPivLu().solve(sides);
  std::vector<Point3> points;
  for (Eigen::Index i = 0; i < m; ++i) points.emplace_back(solution.row(i).transpose());
  return {basis, points};
}

// Two turns of radius 20 and pitch 6 pi through 60 points, two of them wrong.
inline BsplineCurve helix_with_two_wrong_points() {
  std::vector<Point3> points;
  for (int i = 0; i < 60; ++i) {
    const double t = 4 * std::numbers::pi * i / 59;
    points.emplace_back(20 * std::cos(t), 20 * std::sin(t), 3 * t);
  }
  points[20].z() += 0.2;
  points[41] += Vector3(0.15, 0.1, 0);
  return natural_cubic_through(points);
}

// 30 control points on a line, 1e-6 mm to and fro.
inline BsplineCurve line_with_sawtooth() {
  std::vector<Point3> points;
  for (int i = 0; i < 30; ++i) points.emplace_back(3.4 * i, i % 2 == 0 ? 1e-6 : -1e-6, 0);
  return uniform_cubic(points);
}

inline BsplineCurve u_shaped_curve() {
  return uniform_cubic({{0, 30, 0},
                        {0, 15, 0},
                        {0, 4, 0},
                        {1.2, .8, 0},
                        {4, 0, 0},
                        {6, 0, 0},
                        {8.8, .8, 0},
                        {10, 4, 0},
                        {10, 15, 0},
                        {10, 30, 0}});
}

}  // namespace batten::geometry
