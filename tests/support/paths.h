// Polylines that many tests use, as a CAM system would write them, each with a known truth.
// Lengths in mm.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"
#include "geometry/path/joined_curve.h"

namespace batten::geometry {

// As printed with so many decimals.
inline Point3 printed(const Point3& p, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return (p * unit).array().round() / unit;
}

// A line along x, its inner vertices `height` to the left and right of it in turn.
inline std::vector<Point3> zigzag_line(double length, double step, double height) {
  const int steps = static_cast<int>(std::lround(length / step));
  std::vector<Point3> points;
  for (int i = 0; i <= steps; ++i) {
    const bool end = i == 0 || i == steps;
    points.emplace_back(length * i / steps, end ? 0 : (i % 2 ? height : -height), 0);
  }
  return points;
}

// An arc about the origin from angle 0 over `sweep` in so many chords; its inner vertices are
// `noise` outside and inside in turn.
inline std::vector<Point3> arc_path(double radius, double sweep, int chords, double noise = 0) {
  std::vector<Point3> points;
  for (int i = 0; i <= chords; ++i) {
    const bool end = i == 0 || i == chords;
    const double r = radius + (end ? 0 : (i % 2 ? noise : -noise));
    const double angle = sweep * i / chords;
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
  }
  return points;
}

inline std::vector<Point3> noisy_half_circle(double radius, int chords, double noise) {
  return arc_path(radius, std::numbers::pi, chords, noise);
}

// A closed circle; first and last vertex are the same numbers.
inline std::vector<Point3> circle_path(double radius, int chords) {
  std::vector<Point3> points = arc_path(radius, 2 * std::numbers::pi, chords);
  points.back() = points.front();
  return points;
}

// A flat of six blocks of 5 mm along x, a rounding of 8 mm in eleven chords up to 45 degrees, a
// slope of six blocks; the inner vertices are off by up to `noise` along z, evenly.
inline std::vector<Point3> noisy_rounding(double noise, unsigned seed, double block = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-noise, noise);
  constexpr double kTurn = std::numbers::pi / 4;
  std::vector<Point3> points;
  for (int i = 0; i <= 6; ++i) points.emplace_back(block * (i - 6), 0, 0);
  for (int i = 1; i <= 11; ++i) {
    const double angle = kTurn * i / 11;
    points.emplace_back(8 * std::sin(angle), 0, 8 - 8 * std::cos(angle));
  }
  const Point3 joint = points.back();
  for (int i = 1; i <= 6; ++i)
    points.push_back(joint + i * block * Vector3(1, 0, 1) / std::sqrt(2));
  for (std::size_t i = 1; i + 1 < points.size(); ++i) points[i].z() += off(random);
  return points;
}

// Stairs going right and up by `step` in turn.
inline std::vector<Point3> staircase_path(int corners, double step) {
  std::vector<Point3> points = {Point3::Zero()};
  for (int i = 0; i <= corners; ++i) {
    const Vector3 move = i % 2 ? Vector3(0, step, 0) : Vector3(step, 0, 0);
    points.push_back(points.back() + move);
  }
  return points;
}

inline std::vector<Point3> helix_path(double radius, double pitch, double turns, int chords) {
  std::vector<Point3> points;
  for (int i = 0; i <= chords; ++i) {
    const double angle = 2 * std::numbers::pi * turns * i / chords;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                        pitch * turns * i / chords);
  }
  return points;
}

// Two lines along x joined by two half circles, closed, starting in the middle of the lower
// line. Every half circle has so many chords.
inline std::vector<Point3> slot_path(double length, double radius, int chords) {
  std::vector<Point3> points = {Point3(0, -radius, 0)};
  for (const double side : {1.0, -1.0}) {
    for (int i = 0; i <= chords; ++i) {
      const double angle = std::numbers::pi * (static_cast<double>(i) / chords - 0.5);
      points.emplace_back(side * (length / 2 + radius * std::cos(angle)),
                          side * radius * std::sin(angle), 0);
    }
  }
  points.push_back(points.front());
  return points;
}

// Chords of a curve as CAM systems make them: from each vertex on the curve as far as the
// chord stays within `tolerance` of it. `f` is sampled at `samples` + 1 places.
template <typename Function>
std::vector<Point3> greedy_chords(const Function& f, double from, double to, double tolerance,
                                  int decimals, int samples = 12000) {
  std::vector<Point3> fine;
  for (int i = 0; i <= samples; ++i) fine.push_back(f(from + (to - from) * i / samples));
  const auto holds = [&](std::size_t a, std::size_t b) {
    const Vector3 chord = fine[b] - fine[a];
    for (std::size_t i = a + 1; i < b; ++i) {
      const double t = std::clamp((fine[i] - fine[a]).dot(chord) / chord.squaredNorm(), 0.0, 1.0);
      if ((fine[i] - fine[a] - t * chord).norm() > tolerance) return false;
    }
    return true;
  };
  std::vector<Point3> points = {printed(fine[0], decimals)};
  for (std::size_t a = 0; a + 1 < fine.size();) {
    std::size_t b = a + 1;
    while (b + 1 < fine.size() && holds(a, b + 1)) ++b;
    points.push_back(printed(fine[b], decimals));
    a = b;
  }
  return points;
}

// A butterfly, closed, some 8 * scale mm wide, as greedy chords. (T. H. Fay's curve but for its
// smallest term, with which it would close after twelve turns only.)
inline std::vector<Point3> butterfly_path(double scale, double tolerance, int decimals) {
  const auto at = [scale](double u) {
    const double r = std::exp(std::sin(u)) - 2 * std::cos(4 * u);
    return Point3(scale * r * std::cos(u), scale * r * std::sin(u), 0);
  };
  return greedy_chords(at, 0.0, 2 * std::numbers::pi, tolerance, decimals, 20000);
}

// A surface of gentle waves with finer ones across them.
struct FinishSurface {
  static double height(double x, double y) {
    return 3 * std::sin(x / 6) * std::cos(y / 9) + 0.8 * std::sin(x / 2.3 + y / 5);
  }
  // Distance to first order, which is exact to the curvature times its square.
  static double distance(const Point3& p) {
    const double slope_x = 0.5 * std::cos(p.x() / 6) * std::cos(p.y() / 9) +
                           0.8 / 2.3 * std::cos(p.x() / 2.3 + p.y() / 5);
    const double slope_y =
        -std::sin(p.x() / 6) * std::sin(p.y() / 9) / 3 + 0.16 * std::cos(p.x() / 2.3 + p.y() / 5);
    return (p.z() - height(p.x(), p.y())) / std::hypot(1, slope_x, slope_y);
  }
  // One row along x from 0 to 60, three decimals.
  static std::vector<Point3> row(double y, double cam_tolerance) {
    return greedy_chords([y](double x) { return Point3(x, y, height(x, y)); }, 0.0, 60.0,
                         cam_tolerance, 3);
  }
};

}  // namespace batten::geometry
