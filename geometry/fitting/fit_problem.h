// What a fit (bspline_fit.h) is asked for: samples to keep near, straight zones and pins to keep
// exactly, and where spans start; and what differs between two such problems.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

struct FitSample {
  double parameter = 0;
  Point3 target = Point3::Zero();
  Vector3 along =
      Vector3::Zero();  // unit direction of free sliding; zero: the full distance counts
  double limit = 0;     // mm, > 0: no distance is greater
  double scatter = 0;   // mm, rms distance expected here; 0: only the limit counts
};

// The curve is exactly the straight line from `start` to `end` over [from, to], run at even
// speed, and so are its first two derivatives at both ends.
struct StraightZone {
  double from = 0;
  double to = 0;
  Point3 start = Point3::Zero();
  Point3 end = Point3::Zero();
};

// The curve passes here exactly, and may have a corner.
struct Pin {
  double parameter = 0;
  Point3 place = Point3::Zero();
};

struct FitProblem {
  std::vector<FitSample> samples;   // parameters increase
  std::vector<StraightZone> zones;  // do not overlap, in order
  std::vector<Pin> pins;            // in order; first and last are the ends of the curve
  std::vector<double> breakpoints;  // where spans start at first, strictly increasing, with the
                                    // ends, every pin and every end of a zone; none inside a zone
};

struct FitOptions {
  int max_refinements = 10;  // rounds of splitting the spans that cannot hold their samples
  int passes = 8;            // solutions per round that tell which spans those are
  int last_passes = 16;      // solutions, when weights have settled, to bring all inside
};

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
