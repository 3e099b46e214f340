// How a smoothed run is said in the target's words: lines or arcs along its curve, cut where
// the feed changes, with the run's comments at their places.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gcode/dialect.h"
#include "geometry/fair.h"
#include "geometry/path.h"
#include "postproc/machine/cycle_time.h"
#include "postproc/options.h"
#include "postproc/section.h"

namespace batten::postproc {

enum class OutputForm { kArcs, kLines };

struct PlannedMove {
  geometry::PathPiece piece;                 // Line or Arc
  double feed = 0;                           // mm/min
  std::vector<std::size_t> comments_before;  // indices into Run::comments
};

struct OutputPlan {
  OutputForm form = OutputForm::kLines;
  std::vector<PlannedMove> moves;
};

struct PlanOptions {
  const gcode::Dialect* target = nullptr;
  const Machine* machine = nullptr;
  gcode::Units units = gcode::Units::kMillimetre;
  gcode::Plane active_plane = gcode::Plane::kXY;
  Prefer prefer = Prefer::kTime;
  double max_deviation = 0.005;  // mm, moves to curve: the share of the form
};

// Chords with vertices on the curve.
[[nodiscard]] OutputPlan plan_lines(const Run& run, const geometry::FairPath& fair,
                                    const PlanOptions& options);

// Arcs in the plane that fits (the active one first); nothing when the run lies in no plane
// that the target takes arcs in.
[[nodiscard]] std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::FairPath& fair,
                                                  const PlanOptions& options);

}  // namespace batten::postproc
