#include "geometry/fitting/naseath/naseath_polygon.h"

#include <cmath>
#include <limits>

namespace batten::geometry {

namespace {

// Legs whose directions differ by less than this (sine of the angle) do not turn. A straight end
// gives three control points on one line to within rounding, and the class of the third must not
// hang on that. Some 4,500 rounding steps, as kSameKnot.
constexpr double kNoTurn = 1e-12;

constexpr std::size_t kFewestInGroup = 3;

bool same_way(const Vector3& a, const Vector3& b) { return a.dot(b) > 0; }

SmoothGroup longest_from(const ControlPolygon& polygon, const std::vector<Vector3>& turns,
                         std::size_t first, std::size_t most) {
  SmoothGroup group{first, 1};
  while (group.count < most) {
    const auto steps = static_cast<std::ptrdiff_t>(group.count);
    const Vector3& last = turns[polygon.index(first, steps - 1)];
    if (!same_way(last, turns[polygon.index(first, steps)])) break;
    ++group.count;
  }
  return group;
}

// Where to begin looking for groups, so that none is cut in two: after a place on the ring
// where the turns do not agree. The number of points where there is no such place.
std::size_t first_break(const ControlPolygon& polygon, const std::vector<Vector3>& turns) {
  std::size_t i = 0;
  while (i < turns.size() && same_way(turns[polygon.index(i, -1)], turns[i])) ++i;
  return i;
}

void enter_group(const ControlPolygon& polygon, const SmoothGroup& group,
                 NaseathCategories& categories) {
  for (std::size_t step = 0; step < group.count; ++step) {
    const bool apex =
        step == group.to_apex() || (group.has_two_apexes() && step == group.to_apex() + 1);
    categories.of_point[polygon.index(group.first, static_cast<std::ptrdiff_t>(step))] =
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
  const Vector3 back = unit(polygon.at(i, -1) - polygon.at(i));
  const Vector3 on = unit(polygon.at(i, 1) - polygon.at(i));
  return unit(back + on);
}

// The two neighbours of an end, nearer one first, seen inwards from it.
struct EndNeighbours {
  Point3 near;
  Point3 far;
};

EndNeighbours end_neighbours(const ControlPolygon& polygon, std::size_t end) {
  const std::ptrdiff_t inward = end == 0 ? 1 : -1;
  return {polygon.at(end, inward), polygon.at(end, 2 * inward)};
}

// Across the original leg, towards the line through the two neighbours.
Vector3 end_direction(const ControlPolygon& polygon, std::size_t end, const Vector3& leg) {
  const auto [near, far] = end_neighbours(polygon, end);
  const Vector3 to_line = across(near - polygon.points[end], unit(far - near));
  if (to_line.norm() < kNoDirection) return Vector3::Zero();
  return unit(across(to_line, unit(leg)));
}

// Between the two apexes i and i + 1: across the leg that joins them, to the inner side.
Vector3 double_apex_direction(const ControlPolygon& polygon, std::size_t i) {
  const Vector3 leg = unit(polygon.at(i, 1) - polygon.at(i));
  const Vector3 inward = polygon.at(i, 2) - polygon.at(i, 1) + polygon.at(i, -1) - polygon.at(i);
  return unit(across(inward, leg));
}

void set_group(const ControlPolygon& polygon, const SmoothGroup& group,
               std::vector<Vector3>& directions) {
  const std::size_t apex = polygon.index(group.first, static_cast<std::ptrdiff_t>(group.to_apex()));
  const Vector3 with =
      group.has_two_apexes() ? double_apex_direction(polygon, apex) : bisector(polygon, apex);
  for (std::size_t step = 0; step < group.count; ++step) {
    const std::size_t i = polygon.index(group.first, static_cast<std::ptrdiff_t>(step));
    directions[i] = unit(kApexShare * with - bisector(polygon, i));
  }
  directions[apex] = with;
  if (group.has_two_apexes()) directions[polygon.index(apex, 1)] = with;
}

// Along the bisector of two legs to the line through their ends: 2 a b cos(half angle)/(a + b).
double bisector_length(const ControlPolygon& polygon, std::size_t i, const Vector3& direction) {
  const Vector3 back = polygon.at(i, -1) - polygon.at(i);
  const double a = back.norm();
  const double b = (polygon.at(i, 1) - polygon.at(i)).norm();
  return a > 0 && b > 0 ? 2 * b * back.dot(direction) / (a + b) : 0;
}

}  // namespace

std::size_t ControlPolygon::index(std::size_t i, std::ptrdiff_t by) const {
  const auto m = static_cast<std::ptrdiff_t>(points.size());
  const std::ptrdiff_t there = static_cast<std::ptrdiff_t>(i) + by;
  return static_cast<std::size_t>(closed ? (there % m + m) % m : there);
}

std::vector<Vector3> turns_of(const ControlPolygon& polygon) {
  std::vector<Vector3> turns(polygon.size(), Vector3::Zero());
  const std::size_t margin = polygon.closed ? 0 : 1;
  for (std::size_t i = margin; i + margin < polygon.size(); ++i) {
    const Vector3 before = polygon.at(i) - polygon.at(i, -1);
    const Vector3 after = polygon.at(i, 1) - polygon.at(i);
    const Vector3 turn = before.cross(after);
    if (turn.norm() > kNoTurn * before.norm() * after.norm()) turns[i] = turn;
  }
  return turns;
}

NaseathCategories categories_of(const ControlPolygon& polygon) {
  const std::size_t m = polygon.size();
  const std::vector<Vector3> turns = turns_of(polygon);
  NaseathCategories categories;
  categories.of_point.assign(m, NaseathCategory::kRipple);

  std::size_t begin = 0;
  std::size_t left = m;  // points not looked at yet; on an open polygon the ends turn nowhere
  if (polygon.closed) {
    begin = first_break(polygon, turns);
    if (begin == m) {
      categories.turns_one_way = true;
      return categories;
    }
  } else {
    categories.of_point.front() = categories.of_point.back() = NaseathCategory::kEnd;
  }
  for (std::size_t i = begin; left > 0;) {
    const SmoothGroup group = longest_from(polygon, turns, i, left);
    if (group.count >= kFewestInGroup) enter_group(polygon, group, categories);
    left -= group.count;
    if (left > 0) i = polygon.index(i, static_cast<std::ptrdiff_t>(group.count));
  }
  return categories;
}

EndLegs end_legs(const ControlPolygon& polygon) {
  const std::size_t m = polygon.size();
  return {polygon.points[1] - polygon.points[0], polygon.points[m - 1] - polygon.points[m - 2]};
}

std::vector<Vector3> naseath_directions(const ControlPolygon& polygon,
                                        const NaseathCategories& categories, const EndLegs& legs) {
  const std::size_t m = polygon.size();
  std::vector<Vector3> directions(m, Vector3::Zero());
  for (std::size_t i = 0; i < m; ++i) {
    if (categories.of_point[i] == NaseathCategory::kRipple) directions[i] = bisector(polygon, i);
  }
  for (const SmoothGroup& group : categories.groups) set_group(polygon, group, directions);
  if (!polygon.closed) {
    directions.front() = end_direction(polygon, 0, legs.first);
    directions.back() = end_direction(polygon, m - 1, legs.last);
  }
  return directions;
}

double distance_to_target(const ControlPolygon& polygon, const NaseathCategories& categories,
                          std::size_t i, const Vector3& direction) {
  if (categories.of_point[i] == NaseathCategory::kRipple) {
    return bisector_length(polygon, i, direction);
  }
  if (categories.of_point[i] != NaseathCategory::kEnd) {
    return std::numeric_limits<double>::infinity();
  }
  const auto [near, far] = end_neighbours(polygon, i);
  const Vector3 along = unit(far - near);
  const Vector3 to_line = across(near - polygon.points[i], along);
  const Vector3 step = across(direction, along);
  return step.norm() < kNoDirection ? 0 : to_line.dot(step) / step.squaredNorm();
}

}  // namespace batten::geometry
