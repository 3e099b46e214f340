// What papers tell of a curve beside its greatest curvature.
#pragma once

#include <span>

#include "geometry/path/parameter_samples.h"

namespace batten::geometry {

// Mean over the samples, each counted once whatever the distance to its neighbours: a short span
// weighs as much as a long one. 0 without samples.
inline double mean_curvature(std::span<const ParameterSample> samples) {
  if (samples.empty()) return 0;
  double sum = 0;
  for (const ParameterSample& sample : samples) sum += sample.curvature;
  return sum / static_cast<double>(samples.size());
}

// mm
inline double sampled_length(std::span<const ParameterSample> samples) {
  return samples.empty() ? 0 : samples.back().distance;
}

}  // namespace batten::geometry
