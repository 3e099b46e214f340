#include "postproc/arc_moves.h"

#include <algorithm>
#include <cmath>

namespace batten::postproc {
namespace {

using geometry::Path;

// Chords for an arc, each within `deviation` of it.
Path chords_for(const geometry::Arc& arc, double deviation) {
  const double radius =
      (arc.start - arc.center - (arc.start - arc.center).dot(arc.axis) * arc.axis).norm();
  const double half_angle = std::acos(std::max(1 - deviation / radius, 0.0));
  const auto count = std::max(1, static_cast<int>(std::ceil(std::abs(arc.sweep) / 2 / half_angle)));
  Path chords;
  geometry::Point3 place = arc.start;
  for (int i = 1; i <= count; ++i) {
    const geometry::Point3 next = geometry::point_at(arc, static_cast<double>(i) / count);
    chords.push_back(geometry::Line{place, next});
    place = next;
  }
  return chords;
}

}  // namespace

std::vector<gcode::PlaneAxes> arc_planes(const PlanOptions& options) {
  std::vector<gcode::PlaneAxes> planes;
  for (const gcode::PlaneAxes& each : gcode::kPlaneAxes) {
    if (options.target->takes_arcs_in(each.plane)) planes.push_back(each);
  }
  std::stable_partition(planes.begin(), planes.end(), [&](const gcode::PlaneAxes& each) {
    return each.plane == options.active_plane;
  });
  return planes;
}

double arc_grid(const PlanOptions& options) {
  return gcode::printed_step(options.target->arc_ends(options.units), options.units);
}

void append_taken(const geometry::PathPiece& piece, double deviation, const PlanOptions& options,
                  Path& path) {
  const auto* arc = std::get_if<geometry::Arc>(&piece);
  if (arc == nullptr || options.target->arc_complaint(*arc, options.units).empty()) {
    path.push_back(piece);
    return;
  }
  const Path chords = chords_for(*arc, deviation);
  path.insert(path.end(), chords.begin(), chords.end());
}

}  // namespace batten::postproc
