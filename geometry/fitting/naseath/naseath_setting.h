// What Naseath's smoother works on, the same in every pass, and the room that is left in the tube.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/fitting/naseath/naseath.h"
#include "geometry/fitting/naseath/naseath_categories.h"
#include "geometry/fitting/naseath/naseath_directions.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// Span j of a cubic hangs on the control points j to j + 3.
inline constexpr std::size_t kNaseathDegree = 3;

struct NaseathSetting {
  BsplineBasis basis;
  ControlPolygon original;
  EndLegs legs;
  std::vector<double> parameters;  // of influence, per point
  NaseathOptions options;

  // The curve of a polygon: on a ring its first three points come again at the end.
  [[nodiscard]] BsplineCurve curve_of(std::vector<Point3> points) const;
  [[nodiscard]] bool is_held(std::size_t i) const;
  [[nodiscard]] double at_tube() const { return options.accuracy * options.radius; }  // mm
};

// Throws as smooth_naseath says.
[[nodiscard]] NaseathSetting naseath_setting(const BsplineCurve& curve,
                                             const NaseathOptions& options);

// What is left of the tube's radius.
struct NaseathRoom {
  double least = 0;               // mm, over the whole curve
  std::vector<double> per_point;  // mm, over the spans that the point acts on
};

[[nodiscard]] NaseathRoom naseath_room(const NaseathSetting& setting,
                                       const ControlPolygon& polygon);

// mm: |moved - original| does not exceed it at any parameter, and is above the greatest by a
// ten-millionth of accuracy times radius at most.
[[nodiscard]] double naseath_displacement(const NaseathSetting& setting,
                                          const ControlPolygon& polygon);

}  // namespace batten::geometry
