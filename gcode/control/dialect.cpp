#include "gcode/control/dialect.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace batten::gcode {

double chord_error(const ArcChords& chords, double radius) {
  if (!(chords.longest > 0)) return chords.error;
  double length = chords.longest;
  if (chords.per_circle > 0) {
    const double wished = 2 * std::numbers::pi * radius / chords.per_circle;
    length = std::clamp(wished, chords.shortest, chords.longest);
  }
  const double half_angle = std::min(length / (2 * radius), std::numbers::pi / 2);
  return std::max(chords.error, radius * (1 - std::cos(half_angle)));
}

}  // namespace batten::gcode
