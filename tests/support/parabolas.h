// The two parabolas of Hamdan, Alwan and Hussein (2005), with what closed forms say of them.
// Lengths in mm.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// y = c1 x^2 + c2 x + c3 as one cubic span, x being the parameter.
struct Parabola {
  double c1, c2, c3, from, to;

  double y(double x) const { return (c1 * x + c2) * x + c3; }
  double slope(double x) const { return 2 * c1 * x + c2; }

  BsplineCurve curve() const {
    const double third = (to - from) / 3;
    return BsplineCurve(BsplineBasis::clamped(3, {from, to}),
                        {{from, y(from), 0},
                         {from + third, y(from) + third * slope(from), 0},
                         {to - third, y(to) - third * slope(to), 0},
                         {to, y(to), 0}});
  }

  // Greatest distance of the curve from the chord over [a, b]: |c1| dx^2 / (4 sqrt(1 + s^2)),
  // s the slope of the chord, which is the slope of the curve in its middle.
  double deviation(double a, double b) const {
    return std::abs(c1) * (b - a) * (b - a) / (4 * std::hypot(1, slope((a + b) / 2)));
  }

  double greatest_deviation(std::span<const double> x) const {
    double greatest = 0;
    for (std::size_t i = 1; i < x.size(); ++i)
      greatest = std::max(greatest, deviation(x[i - 1], x[i]));
    return greatest;
  }

  double chords_length(std::span<const double> x) const {
    double length = 0;
    for (std::size_t i = 1; i < x.size(); ++i) {
      length += std::hypot(x[i] - x[i - 1], y(x[i]) - y(x[i - 1]));
    }
    return length;
  }
};

inline constexpr Parabola kFlatParabola{-0.043, 1, 0.01, 2, 11};
inline constexpr Parabola kSteepParabola{2, -1, 1, 1, 10};

// How many chords or links each method needs for them.
struct ParabolaRow {
  const char* name;
  Parabola parabola;
  double tolerance;
  double first_step;  // of ILCA
  std::size_t ilca, blca, greedy, links;
};

inline constexpr ParabolaRow kParabolaRows[] = {
    {"flat, coarse", kFlatParabola, .05, 3, 5, 8, 4, 4},
    {"flat, fine", kFlatParabola, .005, 3, 14, 26, 13, 10},
    {"flat, finer", kFlatParabola, .0005, 3, 42, 80, 40, 29},
    {"flat, finest", kFlatParabola, .00005, 3, 132, 251, 126, 89},
    {"steep, coarse", kSteepParabola, .045, 2, 15, 16, 8, 6},
    {"steep, fine", kSteepParabola, .0045, 2, 51, 49, 24, 18},
    {"steep, finer", kSteepParabola, .00045, 2, 167, 151, 75, 54},
    {"steep, finest", kSteepParabola, .000045, 2, 531, 475, 238, 168},
};

// The same curve turned out of the plane and moved.
inline BsplineCurve in_space(const BsplineCurve& curve) {
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()) *
                                Eigen::AngleAxisd(-1.1, Vector3(3, -1, 1).normalized()))
                                   .toRotationMatrix();
  std::vector<Point3> points;
  for (const Point3& p : curve.control_points()) points.push_back(turn * p + Point3(5, -7, 11));
  return BsplineCurve(curve.basis(), points);
}

}  // namespace batten::geometry
