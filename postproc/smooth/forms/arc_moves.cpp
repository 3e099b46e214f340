#include "postproc/smooth/forms/arc_moves.h"

#include <algorithm>
#include <cmath>

#include "gcode/controls/arc_rules.h"
#include "gcode/state/units.h"
#include "geometry/arcs/arc_parts.h"

namespace batten::postproc {
namespace {

using geometry::Path;

double radius_of(const geometry::Arc& arc) {
  const geometry::Vector3 out = arc.start - arc.center;
  return (out - out.dot(arc.axis) * arc.axis).norm();
}

// Chords for an arc, each within `deviation` of it.
Path chords_for(const geometry::Arc& arc, double deviation) {
  const double radius = radius_of(arc);
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

geometry::ArcPartsOptions parts_for(const geometry::Arc& arc, const gcode::Dialect& target) {
  geometry::ArcPartsOptions parts;
  parts.max_sweep = target.max_arc_sweep();
  const gcode::PlaneAxes* plane = gcode::plane_across(arc.axis);
  if (target.needs_single_quadrants() && plane != nullptr) {
    parts.quadrant_from = geometry::Vector3::Unit(plane->first);
  }
  return parts;
}

// The control takes it, and its own chords are no coarser than chords of ours would be.
bool is_taken(const geometry::Arc& arc, const PlanOptions& options) {
  const gcode::Dialect& target = *options.target;
  return gcode::arc_refusal(target, arc, options.units).empty() &&
         gcode::chord_error(target.arc_chords(), radius_of(arc)) <= options.max_deviation;
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
  if (arc == nullptr) {
    path.push_back(piece);
    return;
  }
  for (const geometry::Arc& part : geometry::arc_parts(*arc, parts_for(*arc, *options.target))) {
    if (is_taken(part, options)) {
      path.push_back(part);
      continue;
    }
    const Path chords = chords_for(part, deviation);
    path.insert(path.end(), chords.begin(), chords.end());
  }
}

}  // namespace batten::postproc
