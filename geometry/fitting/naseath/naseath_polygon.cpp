#include "geometry/fitting/naseath/naseath_polygon.h"

namespace batten::geometry {

namespace {

// Legs whose directions differ by less than this (sine of the angle) do not turn. A straight end
// gives three control points on one line to within rounding, and the class of the third must not
// hang on that. Some 4,500 rounding steps, as kSameKnot.
constexpr double kNoTurn = 1e-12;

constexpr std::size_t kFewestInGroup = 3;

bool same_way(const Vector3& a, const Vector3& b) { return a.dot(b) > 0; }

SmoothGroup longest_from(const std::vector<Vector3>& turns, std::size_t first) {
  SmoothGroup group{first, 1};
  for (std::size_t i = first + 1; i < turns.size() && same_way(turns[i - 1], turns[i]); ++i) {
    ++group.count;
  }
  return group;
}

void enter_group(const SmoothGroup& group, NaseathCategories& categories) {
  for (std::size_t step = 0; step < group.count; ++step) {
    const bool apex =
        step == group.to_apex() || (group.has_two_apexes() && step == group.to_apex() + 1);
    categories.of_point[group.first + step] =
        apex ? NaseathCategory::kApex : NaseathCategory::kSide;
  }
  categories.groups.push_back(group);
}

// Shorter vectors (mm, or sums of unit vectors) are rounding and have no direction.
constexpr double kNoDirection = 1e-12;

// A side point goes with its apex, this many parts to one of its own bisector.
constexpr double kApexShare = 9;

Vector3 unit(const Vector3& v) {
  const double size = v.norm();
  return size < kNoDirection ? Vector3::Zero() : Vector3(v / size);
}

// `v` without its part along the unit vector `along`.
Vector3 across(const Vector3& v, const Vector3& along) { return v - v.dot(along) * along; }

Vector3 bisector(const ControlPolygon& polygon, std::size_t i) {
  const Vector3 back = unit(polygon[i - 1] - polygon[i]);
  const Vector3 on = unit(polygon[i + 1] - polygon[i]);
  return unit(back + on);
}

// Across the original leg, towards the line through the two neighbours.
Vector3 end_direction(const Point3& end, const Point3& near, const Point3& far,
                      const Vector3& leg) {
  const Vector3 to_line = across(near - end, unit(far - near));
  if (to_line.norm() < kNoDirection) return Vector3::Zero();
  return unit(across(to_line, unit(leg)));
}

// Between the two apexes i and i + 1: across the leg that joins them, to the inner side.
Vector3 double_apex_direction(const ControlPolygon& polygon, std::size_t i) {
  const Vector3 leg = unit(polygon[i + 1] - polygon[i]);
  const Vector3 inward = polygon[i + 2] - polygon[i + 1] + polygon[i - 1] - polygon[i];
  return unit(across(inward, leg));
}

void set_group(const ControlPolygon& polygon, const SmoothGroup& group,
               std::vector<Vector3>& directions) {
  const std::size_t apex = group.first + group.to_apex();
  const Vector3 with =
      group.has_two_apexes() ? double_apex_direction(polygon, apex) : bisector(polygon, apex);
  for (std::size_t i = group.first; i < group.first + group.count; ++i) {
    directions[i] = unit(kApexShare * with - bisector(polygon, i));
  }
  directions[apex] = with;
  if (group.has_two_apexes()) directions[apex + 1] = with;
}

}  // namespace

std::vector<Vector3> turns_of(const ControlPolygon& polygon) {
  std::vector<Vector3> turns(polygon.size(), Vector3::Zero());
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Vector3 before = polygon[i] - polygon[i - 1];
    const Vector3 after = polygon[i + 1] - polygon[i];
    const Vector3 turn = before.cross(after);
    if (turn.norm() > kNoTurn * before.norm() * after.norm()) turns[i] = turn;
  }
  return turns;
}

NaseathCategories categories_of(const ControlPolygon& polygon) {
  const std::vector<Vector3> turns = turns_of(polygon);
  NaseathCategories categories;
  categories.of_point.assign(polygon.size(), NaseathCategory::kRipple);
  categories.of_point.front() = categories.of_point.back() = NaseathCategory::kEnd;
  for (std::size_t i = 0; i < turns.size();) {
    const SmoothGroup group = longest_from(turns, i);
    if (group.count >= kFewestInGroup) enter_group(group, categories);
    i += group.count;
  }
  return categories;
}

EndLegs end_legs(const ControlPolygon& polygon) {
  const std::size_t m = polygon.size();
  return {polygon[1] - polygon[0], polygon[m - 1] - polygon[m - 2]};
}

std::vector<Vector3> naseath_directions(const ControlPolygon& polygon,
                                        const NaseathCategories& categories, const EndLegs& legs) {
  const std::size_t m = polygon.size();
  std::vector<Vector3> directions(m, Vector3::Zero());
  for (std::size_t i = 0; i < m; ++i) {
    if (categories.of_point[i] == NaseathCategory::kRipple) directions[i] = bisector(polygon, i);
  }
  for (const SmoothGroup& group : categories.groups) set_group(polygon, group, directions);
  directions.front() = end_direction(polygon[0], polygon[1], polygon[2], legs.first);
  directions.back() = end_direction(polygon[m - 1], polygon[m - 2], polygon[m - 3], legs.last);
  return directions;
}

}  // namespace batten::geometry
