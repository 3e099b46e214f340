// The lines and arcs that the vertices of a path were taken from: CAM cuts an arc into chords, and
// each vertex is on it but for the rounding of its numbers.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/arcs/circle_fit.h"
#include "geometry/basic/point.h"

namespace batten::geometry {

// From one vertex to another.
struct LineArcSection {
  std::size_t first = 0;
  std::size_t last = 0;
  std::optional<CircleFit> circle;  // none: a line
};

struct LineArcLimits {
  double off = 0.001;    // mm: vertices from their line or circle, at most
  double chord = 0.01;   // mm: edges from the arc that they are chords of, at most
  std::size_t most = 0;  // sections; more are not looked for
};

// In order, each beginning where the one before it ends, from the first vertex to the last, and
// none across one of the `breaks` (ascending): each as far as a line or an arc goes that begins
// there. Nothing where there are more than the most. `points`: mm.
[[nodiscard]] std::optional<std::vector<LineArcSection>> line_arc_sections(
    std::span<const Point2> points, const LineArcLimits& limits,
    std::span<const std::size_t> breaks = {});

}  // namespace batten::geometry
