// What the plans of arcs share: the planes of the target, the arcs that it does not take, and the
// chords that the control itself makes of those that it takes.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "gcode/controls/arc_rules.h"
#include "gcode/state/modal_state.h"
#include "geometry/arcs/biarc.h"
#include "geometry/fitting/fair/fair.h"
#include "geometry/path/path.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {

// Planes that the target takes arcs in, the active one first.
[[nodiscard]] std::vector<gcode::PlaneAxes> arc_planes(const PlanOptions& options);

// mm: the printed step of the ends of arcs.
[[nodiscard]] double arc_grid(const PlanOptions& options);

// mm: max_deviation, but for what is kept for chords in place of arcs.
[[nodiscard]] double arc_deviation(const PlanOptions& options);

// In as many parts as the target needs, none of which turns by more than `most` (radians).
[[nodiscard]] std::vector<geometry::Arc> parts_of(
    const geometry::Arc& arc, const gcode::Control& target,
    double most = std::numeric_limits<double>::infinity());

// Appends the piece; an arc in as many parts as the target needs, and chords within `deviation`
// (mm) of those parts that it refuses.
void append_taken(const geometry::PathPiece& piece, double deviation, const PlanOptions& options,
                  geometry::Path& path);

// What the target's chords of the run's own arcs leave of these, by place. Both must live as long.
class RunChords {
 public:
  RunChords(const Run& run, const gcode::ArcChords& chords);

  // mm: the greatest between two vertices, or what the target itself aims at; without an arc there,
  // new ones may have any.
  [[nodiscard]] double greatest(std::size_t first, std::size_t last) const;

 private:
  const Run& run_;
  std::vector<double> errors_;  // of its arcs
  double aimed_at_ = 0;
};

// Whether the target's chords of an arc are counted as part of its distance from the run.
[[nodiscard]] bool takes_chords_off(const PlanOptions& options);

// How far the run is to the left and to the right of the curve along one of its edges, mm.
struct BesideCurve {
  double left = 0;
  double right = 0;
};

// The path that arcs follow: a place for each vertex, increasing, which vertex of the run it is,
// and how far the run is beside it at each edge (none: it is the run itself).
struct FollowedPath {
  std::vector<double> places;
  std::vector<std::size_t> vertices;
  std::vector<BesideCurve> beside;
  RunChords before;
  double tolerance;

  [[nodiscard]] geometry::ArcRunning::Room room(double from, double to) const;
};

// What the search for arcs has to know of the target's own chords.
[[nodiscard]] geometry::ArcRunning running_of(const PlanOptions& options, FollowedPath path);

// Replaces arcs that the target would cut too coarsely by chords of ours.
void put_own_chords(const Run& run, const geometry::SmoothCurve& fair, const PlanOptions& options,
                    OutputPlan& plan);

}  // namespace batten::postproc
