// What each point of a control polygon is to Naseath's smoother: part of a smooth group, an
// apex, a ripple or an end; and where it moves. (Naseath 2007, chapter 3;
// docs/algorithms/naseath.md, steps 1 to 3.)
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

using ControlPolygon = std::vector<Point3>;

// The turn at point i: the cross product of the legs before and after it, or exactly zero where
// the legs are parallel but for rounding, and at the ends.
[[nodiscard]] std::vector<Vector3> turns_of(const ControlPolygon& polygon);

enum class NaseathCategory {
  kEnd,     // first or last point
  kRipple,  // turns to and fro
  kSide,    // of a smooth group, but not its apex: beginning, ending or between
  kApex,    // the middle one of a group, or one of its two middle ones
};

// Three or more neighbouring points that turn the same way.
struct SmoothGroup {
  std::size_t first = 0;
  std::size_t count = 0;

  // Steps from `first` to the apex; of two, to the first one.
  [[nodiscard]] std::size_t to_apex() const { return (count - 1) / 2; }
  [[nodiscard]] bool has_two_apexes() const { return count % 2 == 0; }
};

struct NaseathCategories {
  std::vector<NaseathCategory> of_point;
  std::vector<SmoothGroup> groups;  // in order of their first points
};

[[nodiscard]] NaseathCategories categories_of(const ControlPolygon& polygon);

// The first and the last leg of the polygon before it was smoothed, in the order of travel. The
// ends move across these.
struct EndLegs {
  Vector3 first = Vector3::Zero();
  Vector3 last = Vector3::Zero();
};

[[nodiscard]] EndLegs end_legs(const ControlPolygon& polygon);

// Unit vectors, one per point; zero where a point has nowhere to go.
[[nodiscard]] std::vector<Vector3> naseath_directions(const ControlPolygon& polygon,
                                                      const NaseathCategories& categories,
                                                      const EndLegs& legs);

}  // namespace batten::geometry
