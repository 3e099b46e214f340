#include "gcode/text/arc_center.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten::gcode {
namespace {

// How many steps the centre may move along the bisector in search of a grid point near it. Among
// 16 steps of a line there are grid points within about a thirtieth of a step.
constexpr int kStepsAlong = 8;

// Ends closer than this many steps have no direction worth the name.
constexpr double kLeastChord = 4;

// What a step along the bisector costs at the least, so that the wanted centre wins where the
// choice is idle.
constexpr double kLeastCost = 0.05;

PlanePoint nearest(const PlanePoint& place, const CenterGrid& grid) {
  return ((place - grid.base) / grid.step).array().round().matrix();
}

// What a step along the bisector costs, per step across it: by so much it moves the middle of the
// arc. A step across makes the radii at the ends differ by up to two steps. So the centre that
// costs least moves no place of the arc by more than plain rounding of the centre could.
double cost_along(double sweep) { return std::max(1 - std::cos(sweep / 2), kLeastCost); }

}  // namespace

PlanePoint printed_center(const PlanePoint& start, const PlanePoint& end, const PlanePoint& wanted,
                          double sweep, const CenterGrid& grid) {
  const PlanePoint chord = end - start;
  if (chord.norm() < kLeastChord * grid.step) return nearest(wanted, grid);
  const PlanePoint across = chord.normalized();
  const PlanePoint along(-across.y(), across.x());
  const PlanePoint middle = (start + end) / 2;
  const PlanePoint equal_radii = middle + (wanted - middle).dot(along) * along;

  const double per_step_along = cost_along(sweep);
  PlanePoint best = nearest(equal_radii, grid);
  double least = std::numeric_limits<double>::infinity();
  for (int i = -kStepsAlong; i <= kStepsAlong; ++i) {
    const PlanePoint candidate = nearest(equal_radii + i * grid.step * along, grid);
    const PlanePoint off = grid.base + candidate * grid.step - equal_radii;
    const double cost = std::hypot(off.dot(across), per_step_along * off.dot(along));
    if (cost < least) {
      least = cost;
      best = candidate;
    }
  }
  return best;
}

}  // namespace batten::gcode
