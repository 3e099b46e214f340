// What each point of a control polygon is to Naseath's smoother: part of a smooth group, an
// apex, a ripple or an end; and where it moves. (Naseath 2007, chapter 3;
// docs/algorithms/naseath.md, steps 1 to 3.)
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

// The control polygon of a curve. On a ring every index counts modulo the number of points, so
// the last point is followed by the first.
struct ControlPolygon {
  std::vector<Point3> points;
  bool closed = false;

  [[nodiscard]] std::size_t size() const { return points.size(); }
  // The index `by` points after i (before it, where negative). On an open polygon the caller
  // stays inside.
  [[nodiscard]] std::size_t index(std::size_t i, std::ptrdiff_t by) const;
  [[nodiscard]] const Point3& at(std::size_t i, std::ptrdiff_t by = 0) const {
    return points[index(i, by)];
  }
};

// The turn at point i: the cross product of the legs before and after it, or exactly zero where
// the legs are parallel but for rounding, and at the ends of an open polygon.
[[nodiscard]] std::vector<Vector3> turns_of(const ControlPolygon& polygon);

enum class NaseathCategory {
  kEnd,     // first or last point of an open polygon
  kRipple,  // turns to and fro
  kSide,    // of a smooth group, but not its apex: beginning, ending or between
  kApex,    // the middle one of a group, or one of its two middle ones
};

// Three or more neighbouring points that turn the same way. Indices count modulo the polygon's
// size on a ring.
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
  // A ring that turns one way all round. It has no group, since no point is the first of it:
  // all are ripples.
  bool turns_one_way = false;
};

[[nodiscard]] NaseathCategories categories_of(const ControlPolygon& polygon);

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
