// What differs between two problems of a fit.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/fitting/bspline_fit.h"

namespace batten::geometry {

struct SampleChanges {
  static constexpr std::size_t kNew = static_cast<std::size_t>(-1);
  std::vector<std::size_t> was;  // per sample: the old one at the same place, or kNew
  std::vector<bool> altered;     // per sample: new, or with another direction, limit or scatter
  std::vector<double> gone;      // parameters of old samples that are no more, increasing

  [[nodiscard]] bool any() const;
};

// Parameters increase in both.
[[nodiscard]] SampleChanges changes_of(std::span<const FitSample> before,
                                       std::span<const FitSample> after);

// Parts of the parameter; single places have from == to.
struct ParameterRange {
  double from = 0;
  double to = 0;
};

// Pins and zones that are in one problem only, increasing; some may overlap.
[[nodiscard]] std::vector<ParameterRange> changed_places(std::span<const Pin> pins_before,
                                                         std::span<const Pin> pins_after,
                                                         std::span<const StraightZone> zones_before,
                                                         std::span<const StraightZone> zones_after);

// Every pin and both ends of every zone, increasing, each once.
[[nodiscard]] std::vector<double> required_breaks(const FitProblem& problem);

// The breakpoints `now`, but for the parts that are `rebuilt`: these start again from the
// breakpoints of `problem`. With every pin and zone of `problem`, which take the place of
// breakpoints nearer than `closest`.
[[nodiscard]] std::vector<double> breaks_of(const FitProblem& problem, std::span<const double> now,
                                            std::span<const ParameterRange> rebuilt,
                                            double closest);

}  // namespace batten::geometry
