// The curves of tests/cases/naseath.json, with what an independent program found of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/naseath/naseath.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/parameter_samples.h"
#include "tests/support/places.h"

namespace batten::geometry {

// The entry of that name; "distinct_knots", "control_points" and the figures beside them.
inline nlohmann::json naseath_case(const std::string& name) {
  std::ifstream file(BATTEN_SOURCE_DIR "/tests/cases/naseath.json");
  return nlohmann::json::parse(file).at(name);
}

inline std::vector<Point3> points_of(const nlohmann::json& pairs) {
  std::vector<Point3> points;
  for (const auto& pair : pairs) points.emplace_back(pair[0], pair[1], 0);
  return points;
}

inline BsplineCurve curve_in(const nlohmann::json& given) {
  return {BsplineBasis::clamped(3, given.at("distinct_knots").get<std::vector<double>>()),
          points_of(given.at("control_points"))};
}

inline BsplineCurve curve_of_case(const std::string& name) { return curve_in(naseath_case(name)); }

// The method as the thesis has it, and as we repaired it.
inline NaseathOptions literal(double radius, int held_points = 0) {
  NaseathOptions options;
  options.radius = radius;
  options.held_points = held_points;
  options.repairs = NaseathRepairs::none();
  return options;
}

inline NaseathOptions repaired(double radius, int held_points = 0) {
  NaseathOptions options;
  options.radius = radius;
  options.held_points = held_points;
  return options;
}

inline double greatest_curvature(const BsplineCurve& curve) {
  return max_curvature(parameter_samples(curve, kNaseathSteps));
}

// The greatest distance of two points with one index; both must be as many.
inline double farthest(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, (a[i] - b[i]).norm());
  }
  return most;
}

// A clamped cubic on the knots 0, 1, 2 ..
inline BsplineCurve uniform_cubic(std::vector<Point3> points) {
  std::vector<double> knots;
  for (std::size_t i = 0; i + 2 < points.size(); ++i) knots.push_back(static_cast<double>(i));
  return {BsplineBasis::clamped(3, knots), std::move(points)};
}

}  // namespace batten::geometry
