#include "geometry/arcs/line_arc_sections.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/basic/operations.h"

namespace batten::geometry {

namespace {

// Whether the vertices between the ends are beside the line between these, one behind the other.
bool is_line(std::span<const Point2> points, double limit) {
  count_operations(points.size());
  const Vector2 chord = points.back() - points.front();
  const double length = chord.norm();
  if (!(length > 0)) return false;
  double passed = 0;
  for (const Point2& p : points.subspan(1)) {
    const Vector2 from = p - points.front();
    const double along = from.dot(chord) / length;
    const double across = (chord.x() * from.y() - chord.y() * from.x()) / length;
    if (std::abs(across) > limit || along <= passed) return false;
    passed = along;
  }
  return true;
}

// mm: of an arc above its chord; one that rises by next to nothing is a line.
double rise_of(const CircleFit& circle) {
  return circle.radius * (1 - std::cos(circle.angles.back() / 2));
}

// The last index, up to `end`, up to which the points are something, if they are up to `least`;
// else 0. Looked for in doubled steps, and between the last two of these.
template <typename Is>
std::size_t farthest(std::size_t least, std::size_t end, const Is& is) {
  if (least > end || !is(least)) return 0;
  std::size_t good = least;
  std::size_t bad = end + 1;
  while (good < end && bad > end) {
    const std::size_t next = std::min(end, 2 * good);
    (is(next) ? good : bad) = next;
  }
  while (good < end && bad - good > 1) {
    const std::size_t middle = good + (bad - good) / 2;
    (is(middle) ? good : bad) = middle;
  }
  return good;
}

// From the first of the points, by their indices there. The first points of an arc may be on a
// line, too.
LineArcSection longest_section(std::span<const Point2> points, const LineArcLimits& limits) {
  const std::size_t end = points.size() - 1;
  const auto are_line = [&](std::size_t last) {
    return is_line(points.first(last + 1), limits.off);
  };
  LineArcSection line{0, std::max<std::size_t>(1, farthest(1, end, are_line)), {}};
  LineArcSection arc;
  arc.last = farthest(kFewestOnCircle - 1, end, [&](std::size_t last) {
    auto circle = fit_circle(points.first(last + 1), {limits.off, limits.chord});
    if (!circle && !are_line(last)) return false;
    arc.circle = std::move(circle);
    return true;
  });
  const bool is_arc = arc.circle && rise_of(*arc.circle) > limits.off;
  return is_arc && arc.last > line.last ? arc : line;
}

}  // namespace

std::optional<std::vector<LineArcSection>> line_arc_sections(std::span<const Point2> points,
                                                             const LineArcLimits& limits,
                                                             std::span<const std::size_t> breaks) {
  std::vector<LineArcSection> sections;
  for (std::size_t first = 0; first + 1 < points.size();) {
    if (sections.size() >= limits.most) return std::nullopt;
    const auto next = std::ranges::upper_bound(breaks, first);
    const std::size_t end = next == breaks.end() ? points.size() - 1 : *next;
    LineArcSection section = longest_section(points.subspan(first, end - first + 1), limits);
    section.first = first;
    section.last += first;
    first = section.last;
    sections.push_back(std::move(section));
  }
  return sections;
}

}  // namespace batten::geometry
