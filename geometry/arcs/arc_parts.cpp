#include "geometry/arcs/arc_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace batten::geometry {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

// Radians. See the header; also the noise of a half turn that is one but for its last digits.
constexpr double kSameAngle = 1e-6;

// Radians from the start of the arc to the directions that it goes across, in its own sense.
std::vector<double> crossings(const Arc& arc, const Vector3& quadrant_from) {
  const Vector3 out = arc.start - arc.center;
  const Vector3 side = arc.axis.cross(quadrant_from);
  const double angle = std::atan2(out.dot(side), out.dot(quadrant_from));
  const double along = arc.sweep > 0 ? angle : -angle;
  const double length = std::abs(arc.sweep);
  std::vector<double> found;
  const double first = std::ceil((along + kSameAngle) / kQuarter) * kQuarter - along;
  for (double at = first; at < length - kSameAngle; at += kQuarter) found.push_back(at);
  return found;
}

}  // namespace

std::vector<Arc> arc_parts(const Arc& arc, const ArcPartsOptions& options) {
  const double length = std::abs(arc.sweep);
  std::vector<double> cuts = {0};
  if (!options.quadrant_from.isZero()) {
    const std::vector<double> across = crossings(arc, options.quadrant_from);
    cuts.insert(cuts.end(), across.begin(), across.end());
  }
  cuts.push_back(length);

  std::vector<Arc> parts;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double span = cuts[i + 1] - cuts[i];
    const double count = std::max(1.0, std::ceil((span - kSameAngle) / options.max_sweep));
    for (double k = 0; k < count; ++k) {
      const double from = (cuts[i] + span * k / count) / length;
      const bool last = i + 2 == cuts.size() && k + 1 == count;
      const double to = last ? 1 : (cuts[i] + span * (k + 1) / count) / length;
      if (from == 0 && to == 1) return {arc};
      parts.push_back(std::get<Arc>(sub_piece(arc, from, to)));
    }
  }
  return parts;
}

}  // namespace batten::geometry
