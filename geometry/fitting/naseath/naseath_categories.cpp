#include "geometry/fitting/naseath/naseath_categories.h"

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

}  // namespace batten::geometry
