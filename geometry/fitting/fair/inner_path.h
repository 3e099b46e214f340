// A path inside the bends of the one that was meant, as long as the chords that were cut of it.
// Method: docs/algorithms/fair.md, section Inside the bends.
#pragma once

#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/fair/fair.h"

namespace batten::geometry {

// The vertices of a polyline, drawn inwards along the bend of `curve` at each, by a third of the
// height of the chords beside it but `most` (mm) at most; the first and the last stay.
//
// A chord over an angle a of a circle is shorter than its arc by a^2 / 24 of it, and its height is
// a^2 / 8 of the radius: the arc of the circle whose radius is a third of the height less is as
// long as the chord, and its distance from the circle is less than half of the chord's (0.46, rms).
[[nodiscard]] std::vector<Point3> drawn_inwards(std::span<const Point3> points,
                                                const SmoothCurve& curve, double most);

}  // namespace batten::geometry
