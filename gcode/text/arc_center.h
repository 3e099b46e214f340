// The printed centre of an arc between two printed ends.
#pragma once

#include <Eigen/Core>

namespace batten::gcode {

using PlanePoint = Eigen::Vector2d;  // in the arc's plane, in the program's units

// Centres that can be printed: `base` plus whole multiples of `step` on both axes. The base is
// the arc's start where centres are offsets, zero where they are absolute.
struct CenterGrid {
  PlanePoint base = PlanePoint::Zero();
  double step = 0;
};

// The whole multiples (not multiplied by the step) of the centre to be printed for an arc of
// this sweep (radians, either sign) from `start` to `end` about `wanted`.
//
// The printed centre is off the wanted one for two reasons. Across the bisector of the ends it
// makes the radii at the ends differ; along the bisector it keeps them equal and moves the middle
// of the arc, by the less the shorter the arc is. So a centre near the bisector is sought among
// those a few steps from the wanted one.
[[nodiscard]] PlanePoint printed_center(const PlanePoint& start, const PlanePoint& end,
                                        const PlanePoint& wanted, double sweep,
                                        const CenterGrid& grid);

}  // namespace batten::gcode
