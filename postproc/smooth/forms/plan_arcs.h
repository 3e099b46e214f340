#pragma once

#include <vector>

#include "gcode/state/modal_state.h"
#include "geometry/path/path.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {

// Planes that the target takes arcs in, the active one first.
[[nodiscard]] std::vector<gcode::PlaneAxes> arc_planes(const PlanOptions& options);

// mm: the printed step of the ends of arcs.
[[nodiscard]] double arc_grid(const PlanOptions& options);

// Appends the piece; an arc in as many parts as the target needs, and chords within `deviation` of
// those parts that it refuses or that its own chords would leave further than
// options.max_deviation.
void append_taken(const geometry::PathPiece& piece, double deviation, const PlanOptions& options,
                  geometry::Path& path);

}  // namespace batten::postproc
