// A finishing row that a feed is planned for, and machines for it.
#pragma once

#include <cmath>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "tests/support/paths.h"

namespace batten::postproc {

// Every axis alike.
inline KinematicPathLimits even_limits(double feed, double acceleration, double jerk) {
  KinematicPathLimits limits;
  limits.feed = feed;
  limits.acceleration.setConstant(acceleration);
  limits.jerk.setConstant(jerk);
  return limits;
}

// A finishing row: waves of some mm, not too sharp.
inline geometry::Point3 row_point(double x) {
  return {x, 3 * std::sin(0.25 * x) + 0.6 * std::sin(1.1 * x), 1.5 * std::sin(0.4 * x)};
}

// As a CAM system writes it: chords of that length, three decimals.
inline geometry::Path row_of_chords(double length, double chord) {
  std::vector<geometry::Point3> points;
  const int count = static_cast<int>(std::lround(length / chord));
  for (int i = 0; i <= count; ++i) {
    points.push_back(geometry::printed(row_point(length * i / count), 3));
  }
  return geometry::path_through(points);
}

// The same row as a smooth curve with pieces of that length.
inline geometry::BsplineCurve row_as_curve(double length, double piece) {
  std::vector<geometry::Point3> control;
  std::vector<double> knots;
  const int count = static_cast<int>(std::lround(length / piece)) + 3;
  for (int i = 0; i < count; ++i) {
    control.push_back(row_point((i - 1) * piece));
    if (i + 2 < count) knots.push_back(i);
  }
  return {geometry::BsplineBasis::clamped(3, knots), control};
}

}  // namespace batten::postproc
