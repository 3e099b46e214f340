// Polylines on which the methods of smoothing are compared. Lengths in mm.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

// The corner of Ozcan, Riviere-Lorphevre and Ducobu 2018: two lines at a right angle.
inline std::vector<Point3> ozcan_corner_path() { return {{0, 0, 0}, {13, 13, 0}, {26, 0, 0}}; }

// r = exp(sin t) - 2 cos 4t + sin((2t - pi) / 24)^5, 80 segments, ten times as large: the figure
// of Guo, Yan and Wang 2023, who do not print its places.
inline std::vector<Point3> guo_butterfly() {
  std::vector<Point3> points;
  for (int i = 0; i <= 80; ++i) {
    const double t = 2 * std::numbers::pi * i / 80;
    const double r = std::exp(std::sin(t)) - 2 * std::cos(4 * t) +
                     std::pow(std::sin((2 * t - std::numbers::pi) / 24), 5);
    points.emplace_back(10 * r * std::cos(t), 10 * r * std::sin(t), 0);
  }
  return points;
}

// A hexagon in space, as theirs.
inline std::vector<Point3> guo_hexagon() {
  return {{0, 0, 0},     {10, 0, 4},    {15, 8.66, 0}, {10, 17.32, 4},
          {0, 17.32, 0}, {-5, 8.66, 4}, {0, 0, 0}};
}

// A star with five points: ten corners, 36 degrees between the legs at its tips and 108 between
// them. It starts in the middle of a leg, so that every corner is an inner one.
inline std::vector<Point3> star_path(double radius = 20) {
  const double tips_to_dents = (3 - std::sqrt(5.0)) / 2;  // of the regular pentagram
  std::vector<Point3> corners;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 ? radius * tips_to_dents : radius;
    const double angle = std::numbers::pi * (0.5 + i / 5.0);
    corners.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
  }
  std::vector<Point3> points = {0.5 * (corners.back() + corners.front())};
  points.insert(points.end(), corners.begin(), corners.end());
  points.push_back(points.front());
  return points;
}

}  // namespace batten::geometry
