// A curve at equal parameter steps in every span: the measure that the tables of Naseath 2007
// are made with. docs/algorithms/naseath.md says how it differs from a mean over the length.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// Steps per span that reproduce the tables.
inline constexpr int kNaseathSteps = 400;

struct ParameterSample {
  double parameter = 0;
  double distance = 0;             // mm along the curve from its start
  double speed = 0;                // mm per unit of the parameter
  double curvature = 0;            // 1/mm; 0 where the speed is 0
  Vector3 axis = Vector3::Zero();  // that it turns about there, of any length
};

// Every breakpoint once (seen from the span before it) and `steps` equal steps in every span;
// distances by the trapezoidal rule. Requires degree 3 or less; throws where steps < 1.
[[nodiscard]] std::vector<ParameterSample> parameter_samples(const BsplineCurve& curve, int steps);

// 0 without samples, as the next ones.
[[nodiscard]] double max_curvature(std::span<const ParameterSample> samples);

// Mean over the samples, each counted once whatever the distance to its neighbours: a short span
// weighs as much as a long one.
[[nodiscard]] double mean_curvature(std::span<const ParameterSample> samples);

// mm
[[nodiscard]] double sampled_length(std::span<const ParameterSample> samples);

// The integral of curvature^2 over the length (1/mm), trapezoidal rule.
[[nodiscard]] double bending(std::span<const ParameterSample> samples);

// How often the curve bends: sections in which it turns one way, about axes less than 90 degrees
// from those before, by `least_turn` (radians) or more in all.
[[nodiscard]] std::size_t bends_of(std::span<const ParameterSample> samples, double least_turn);

}  // namespace batten::geometry
