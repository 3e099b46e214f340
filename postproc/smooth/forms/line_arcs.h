// The lines and arcs that a run was cut from, where its vertices show them: each vertex is on its
// line or arc but for its rounding (geometry/arcs/line_arc_sections.h).
#pragma once

#include <optional>
#include <vector>

#include "geometry/arcs/line_arc_sections.h"
#include "geometry/fitting/fair/fair.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {

struct LineArcTuning {
  double roundings = 3;        // of coordinates, that a vertex may be off its line or circle
  std::size_t of_section = 3;  // vertices, in the mean: fewer are a curve
  double arc = 2 * geometry::kPi / 3;  // radians, of one that is written at the most
};
inline constexpr LineArcTuning kLineArcs;

// Of one plane.
struct LineArcs {
  int normal = 2;  // axis across it
  std::vector<geometry::LineArcSection> sections;
  bool is_certain = false;  // they are the path that was meant
};

// `rounded`: mm, greatest rounding error of a coordinate. They are certain where the vertices are
// off them (rms) by no more; those of other curves are off such sections by more.
// One circle may be a guess, as long as all points and edges are within `deviation` (mm) of it.
// Nothing for other runs: that have bends, lie in no plane of the axes, or have no arc.
[[nodiscard]] std::optional<LineArcs> line_arcs_of(const Run& run, double deviation,
                                                   double rounded);

// One move for each of them, from vertex to vertex. `fair`: of the run.
[[nodiscard]] std::vector<PlannedMove> moves_along(const LineArcs& shape, const Run& run,
                                                   const geometry::SmoothCurve& fair);

// They as the target takes them. Nothing where it takes no such arc, or they are more than
// most_arcs.
[[nodiscard]] std::optional<OutputPlan> plan_line_arcs(const LineArcs& shape, const Run& run,
                                                       const geometry::SmoothCurve& fair,
                                                       const PlanOptions& options);

}  // namespace batten::postproc
