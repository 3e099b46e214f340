// Cubic B-splines as a smoother makes them: knots of uneven spacing that go with the length, bends
// of all sizes, in the plane or in space. And the golden curve that every format is tried on.
#pragma once

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::tests {

// Control points (0,0) (10,0) (20,10) (30,10) (40,0), knots 0 0 0 0 0.4 1 1 1 1. Its Bezier pieces:
// (0,0) (10,0) (14,4) (18,6.4) and (18,6.4) (24,10) (30,10) (40,0).
inline geometry::BsplineCurve golden_curve() {
  using geometry::Point3;
  return {
      geometry::BsplineBasis(3, {0, 0, 0, 0, 0.4, 1, 1, 1, 1}),
      {Point3(0, 0, 0), Point3(10, 0, 0), Point3(20, 10, 0), Point3(30, 10, 0), Point3(40, 0, 0)}};
}

// Starts at a place with three decimals. Legs of 0.5 to 8 mm; the direction turns by 0.9 radians
// per leg at the most. In the plane: at a height of -1.
inline geometry::BsplineCurve random_curve(unsigned seed, bool in_space) {
  using geometry::Point3;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0, 1);
  const auto between = [&](double least, double most) {
    return least + (most - least) * part(random);
  };
  const auto thousandths = [&](double most) {
    return std::round(1000 * between(-most, most)) / 1000;
  };
  Point3 place(thousandths(100), thousandths(100), in_space ? thousandths(20) : -1);
  const int spans = 1 + static_cast<int>(between(0, 24));
  double heading = between(0, 6.28);
  double slope = 0;
  std::vector<Point3> points = {place};
  std::vector<double> breaks = {0};
  for (int i = 0; i < spans; ++i) {
    breaks.push_back(breaks.back() + between(0.5, 8));
  }
  const geometry::BsplineBasis basis = geometry::BsplineBasis::clamped(3, breaks);
  for (std::size_t i = 1; i < basis.size(); ++i) {
    heading += between(-0.9, 0.9);
    if (in_space) slope = between(-0.6, 0.6);
    const double step = basis.greville(i) - basis.greville(i - 1);
    place += step * geometry::Vector3(std::cos(heading), std::sin(heading), slope);
    points.push_back(place);
  }
  return {basis, std::move(points)};
}

}  // namespace batten::tests
