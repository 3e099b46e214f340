#include "postproc/machine/junction_speed.h"

#include <algorithm>
#include <cmath>

#include "geometry/numeric.h"
#include "postproc/machine/velocity_profile.h"

namespace batten::postproc {

using geometry::kSameDirection;
using geometry::Vector3;

double limit_along(const Vector3& direction, double axis_limit) {
  const double most = direction.cwiseAbs().maxCoeff();
  return most > 0 ? axis_limit / most : axis_limit;
}

// With phi the angle between the two segments (180 degrees: straight on), the circle of
// radius R that touches both leaves the corner by R (1 - sin(phi/2)) / sin(phi/2).
double junction_deviation_speed(const Vector3& before, const Vector3& after, double deviation,
                                double axis_acceleration) {
  const Vector3 turn = after - before;
  if (turn.norm() <= kSameDirection) return kNoLimit;
  const double sin_half = std::sqrt(std::max(0.0, (1 + before.dot(after)) / 2));
  // 1 - sin_half would lose all digits at small turns: (1 - s)(1 + s) = (1 - dot) / 2.
  const double one_minus_sin_half = turn.squaredNorm() / 4 / (1 + sin_half);
  const double acceleration = limit_along(turn.normalized(), axis_acceleration);
  return std::sqrt(acceleration * deviation * sin_half / one_minus_sin_half);
}

double velocity_step_speed(const Vector3& before, const Vector3& after, double axis_acceleration,
                           double period) {
  const double most = (after - before).cwiseAbs().maxCoeff();
  return most <= kSameDirection ? kNoLimit : axis_acceleration * period / most;
}

}  // namespace batten::postproc
