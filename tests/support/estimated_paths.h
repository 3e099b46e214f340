// Paths of all the kinds that a feed is planned for, with machines for them.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan.h"
#include "tests/support/method_cases.h"
#include "tests/support/naseath_cases.h"
#include "tests/support/paths.h"
#include "tests/support/planned_paths.h"

namespace batten::postproc {

struct EstimateCase {
  std::string name;
  geometry::Path path;
  KinematicPathLimits limits;
  PlanEnds ends;
};

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

// Left and right in turn, tangent to each other: radii from `least` to six times that.
inline geometry::Path chain_of_arcs(int count, double least, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> unit(0, 1);
  geometry::Path path;
  geometry::Point3 at = geometry::Point3::Zero();
  double angle = 0;
  for (int i = 0; i < count; ++i) {
    const double side = i % 2 == 0 ? 1 : -1;
    const double radius = least * (1 + 5 * unit(random));
    const double sweep = side * (0.2 + 1.5 * unit(random));
    const geometry::Vector3 left(-std::sin(angle), std::cos(angle), 0);
    const geometry::Point3 center = at + side * radius * left;
    angle += sweep;
    const geometry::Point3 end =
        center - side * radius * geometry::Vector3(-std::sin(angle), std::cos(angle), 0);
    path.emplace_back(geometry::Arc{at, end, center, {0, 0, 1}, sweep});
    at = end;
  }
  return path;
}

// Lines and the tangent arcs between them.
inline geometry::Path slots(int count, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> unit(0.1, 1);
  geometry::Path path;
  geometry::Point3 at = geometry::Point3::Zero();
  double angle = 0;
  for (int i = 0; i < count; ++i) {
    const geometry::Vector3 forward(std::cos(angle), std::sin(angle), 0);
    const geometry::Point3 end = at + 10 * unit(random) * forward;
    path.emplace_back(geometry::Line{at, end});
    const double side = random() % 2 == 0 ? 1 : -1;
    const double sweep = side * 3 * unit(random);
    const double radius = 8 * unit(random);
    const geometry::Vector3 left(-forward.y(), forward.x(), 0);
    const geometry::Point3 center = end + side * radius * left;
    angle += sweep;
    at = center - side * radius * geometry::Vector3(-std::sin(angle), std::cos(angle), 0);
    path.emplace_back(geometry::Arc{end, at, center, {0, 0, 1}, sweep});
  }
  return path;
}

inline KinematicPathLimits thesis_limits() {
  KinematicPathLimits limits;
  limits.feed = 400;
  limits.tangential_acceleration = limits.normal_acceleration = 4000;
  limits.tangential_jerk = 20000;
  return limits;
}

// Every kind but random curves.
inline std::vector<EstimateCase> estimate_cases() {
  std::vector<EstimateCase> cases;
  const auto add = [&](const std::string& name, geometry::Path path,
                       const KinematicPathLimits& limits, PlanEnds ends = {}) {
    cases.push_back({name, std::move(path), limits, ends});
  };
  const KinematicPathLimits slow = corner_limits();
  const KinematicPathLimits fast = even_limits(100, 3000, 50000);
  KinematicPathLimits stepping = fast;  // a control that passes kinks of some mm/s
  stepping.speed_step.setConstant(2);
  for (const double chord : {0.05, 0.2, 1.0}) {
    const std::string size = std::to_string(chord).substr(0, 4);
    const double length = std::min(60.0, 200 * chord);
    add("chords " + size + ", corner machine", row_of_chords(length, chord), slow);
    add("chords " + size + ", fast", row_of_chords(length, chord), fast);
    add("chords " + size + ", steps of 2 mm/s", row_of_chords(length, chord), stepping);
  }
  for (const double piece : {0.2, 1.0, 4.0}) {
    const std::string size = std::to_string(piece).substr(0, 4);
    const double length = std::min(60.0, 150 * piece);
    add("row, pieces " + size + ", corner machine", path_of(row_as_curve(length, piece)), slow);
    add("row, pieces " + size + ", fast", path_of(row_as_curve(length, piece)), fast);
  }
  for (const double radius : {0.2, 2.0, 20.0}) {
    const std::string size = std::to_string(radius).substr(0, 4);
    add("arcs " + size + ", corner machine", chain_of_arcs(20, radius, 1), slow);
    add("arcs " + size + ", fast", chain_of_arcs(20, radius, 2), fast);
  }
  add("slots, corner machine", slots(6, 1), slow);
  add("slots, fast", slots(6, 2), fast);
  add("star", geometry::path_through(geometry::star_path()), slow);
  add("star, fast", geometry::path_through(geometry::star_path()), fast);
  add("one line", {geometry::Line{{0, 0, 0}, {300, 20, 0}}}, fast);
  add("corner, usual .1", ozcan_path(12.92, 12.92), slow);
  add("corner, usual .05", ozcan_path(12.99, 12.99), slow);
  add("corner, optimum .1", ozcan_path(12.67, 12.95), slow);
  add("corner, optimum .05", ozcan_path(12.86, 12.99), slow);
  add("corner, found .1", ozcan_path(12.635, 12.918), slow);
  add("corner, five points .1", guo_path_of(0.1, geometry::GuoApex::kAllowed), slow);
  add("corner, five points .05", guo_path_of(0.05, geometry::GuoApex::kAllowed), slow);
  add("corner, half .1", guo_path_of(0.1, geometry::GuoApex::kHalfTolerance), slow);
  add("corner, half .05", guo_path_of(0.05, geometry::GuoApex::kHalfTolerance), slow);
  for (const char* name : {"tc1", "tc2", "tc3", "tc5a", "tc5b", "tc6"}) {
    add(name, path_of(geometry::curve_of_case(name)), thesis_limits(), {100, 100});
    add(std::string(name) + ", from rest", path_of(geometry::curve_of_case(name)), thesis_limits());
  }
  return cases;
}

}  // namespace batten::postproc
