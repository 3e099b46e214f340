// Where Naseath's smoother moves each control point. (Naseath 2007, chapter 3;
// docs/algorithms/naseath.md, step 3.)
#pragma once

#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/naseath/naseath_categories.h"

namespace batten::geometry {

// The first and the last leg of the polygon before it was smoothed, in the order of travel. The
// ends of an open polygon move across these. Not used on a ring.
struct EndLegs {
  Vector3 first = Vector3::Zero();
  Vector3 last = Vector3::Zero();
};

[[nodiscard]] EndLegs end_legs(const ControlPolygon& polygon);

// Unit vectors, one per point; zero where a point has nowhere to go.
[[nodiscard]] std::vector<Vector3> naseath_directions(const ControlPolygon& polygon,
                                                      const NaseathCategories& categories,
                                                      const EndLegs& legs);

// How far point i may go along its direction before it passes the line through its two
// neighbours (mm). Infinite where it is not a ripple or an end: those have no line to pass.
[[nodiscard]] double distance_to_target(const ControlPolygon& polygon,
                                        const NaseathCategories& categories, std::size_t i,
                                        const Vector3& direction);

}  // namespace batten::geometry
