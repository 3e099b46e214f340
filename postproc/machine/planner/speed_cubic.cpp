#include "postproc/machine/planner/speed_cubic.h"

#include <cmath>

namespace batten::postproc {

using geometry::Vector3;

Vector3 PlannedState::acceleration(const LengthDerivatives& x) const {
  return x.second * q + x.first * (p / 2);
}

Vector3 PlannedState::jerk(const LengthDerivatives& x) const {
  return (x.third * q + x.second * (1.5 * p) + x.first * (0.5 * r)) * std::sqrt(q);
}

PlannedState state_in(const double* w, double length, double s) {
  const double rise = (w[2] - w[0]) / length;
  const double r0 = (6 * rise - 4 * w[1] - 2 * w[3]) / length;
  const double third = 6 * (w[1] + w[3] - 2 * rise) / (length * length);
  return {w[0] + s * (w[1] + s * (r0 / 2 + s * third / 6)), w[1] + s * (r0 + s * third / 2),
          r0 + s * third};
}

double interval_seconds(double length, const double* w) {
  const double middle = state_in(w, length, 0.5 * length).q;
  return length / 6 * (1 / std::sqrt(w[0]) + 4 / std::sqrt(middle) + 1 / std::sqrt(w[2]));
}

}  // namespace batten::postproc
