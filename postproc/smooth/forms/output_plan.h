// How a smoothed run is said in the target's words: lines, arcs or curves along its curve, cut
// where the feed changes, with the run's comments at their places.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gcode/control/control.h"
#include "geometry/arcs/arc_spline.h"
#include "geometry/fitting/fair/fair.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/path.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/methods/run_curve.h"

namespace batten::postproc {

enum class OutputForm { kArcs, kLines, kCurves };

struct PlannedMove {
  geometry::PathPiece piece;                 // a CubicBezier only as part of a PlannedCurve
  double feed = 0;                           // mm/min
  std::vector<std::size_t> comments_before;  // indices into Run::comments
};

// Moves that are written together as one curve of the target: the curve's Bezier pieces.
struct PlannedCurve {
  std::size_t first = 0;         // index into OutputPlan::moves
  std::size_t count = 0;         // as many as the curve has pieces
  geometry::BsplineCurve curve;  // a clamped cubic
};

// The moves chain to within kSamePlace, from the run's first point to its last.
struct OutputPlan {
  OutputForm form = OutputForm::kLines;
  std::vector<PlannedMove> moves;
  std::vector<PlannedCurve> curves;         // in order
  std::vector<std::size_t> comments_after;  // those that stood on the run's last blocks
  double error = 0;  // mm, moves to curve, as the height of equal chords with their ends on the
                     // curve; 0: not known, max_deviation at most
  bool chords_for_steps = false;  // see plan_lines
};

struct PlanOptions {
  const gcode::Control* target = nullptr;
  const Machine* machine = nullptr;
  gcode::Units units = gcode::Units::kMillimetre;
  gcode::Plane active_plane = gcode::Plane::kXY;
  Prefer prefer = Prefer::kTime;
  double max_deviation = 0.005;    // mm, moves to curve: the share of the form
  double keep_corner_angle = 3.2;  // radians: see geometry::FairOptions
  Linearize linearize = Linearize::kChord;
  std::size_t most_moves = 0;  // lines that prefer accuracy become coarser for it; 0: any number
  geometry::ArcEffort arc_effort = geometry::ArcEffort::kQuick;  // of plan_arcs
};

// All plans cut the curve where the feed changes, and put each comment before the move that
// starts at or first after the comment's vertex. All throw std::invalid_argument when `fair`
// does not have one parameter per point of the run.

// Lines along the curve, as `linearize` says; chords where the equal steps of ilca would be too
// many (geometry/chords/ilca.h), which the plan tells. minlink, ilca and blca take all of
// max_deviation; the vertices of minlink alone leave the curve. How fine chords are depends on the
// preference:
//   time      half of max_deviation, but all of it where chords would be shorter than twice the
//             way of one block period at the feed: the control would slow down for them;
//   accuracy  as fine as the block period and most_moves allow, down to a tenth of the rounding of
//             the printed numbers, and all of max_deviation where even that is too much for the
//             control; balanced (geometry/chords/linearize.h);
//   size      all of max_deviation.
[[nodiscard]] OutputPlan plan_lines(const Run& run, const geometry::SmoothCurve& fair,
                                    const PlanOptions& options);

// Arcs in a plane that the target takes arcs in and that the run lies in, the active plane
// first. A run in space: helices and lines in the plane that needs the fewest, where the target
// takes helices and they are fewer than the run's motions. Nothing when no plane serves. Arcs that
// the target would refuse are chords already. Comments are placed by the length along the moves,
// which may be one short move off.
[[nodiscard]] std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::SmoothCurve& fair,
                                                  const PlanOptions& options);

// Few arcs in the band around the run's vertices themselves, where max_deviation is measured
// from; of the fair curve only the direction is taken where the path is cut. Every joint is
// tangent but for corners in which no arc of the target's least radius fits. The run lies in a
// plane that the target takes arcs in; nothing otherwise, or when no chain was found.
[[nodiscard]] std::optional<OutputPlan> plan_arc_spline(const Run& run,
                                                        const geometry::SmoothCurve& fair,
                                                        const PlanOptions& options);

// Curves of the target, on few control points: the curve is fitted anew within max_deviation where
// that takes fewer. Long straight parts are lines, and so is what the target does not take as a
// curve. Curves end at corners. Nothing when the target has no curves or none serves here.
[[nodiscard]] std::optional<OutputPlan> plan_curves(const Run& run,
                                                    const geometry::SmoothCurve& fair,
                                                    const PlanOptions& options);

// The same for who makes more than one plan of a curve, and so has it in its pieces: `pieces` is
// all of fair.curve.

[[nodiscard]] OutputPlan plan_lines(const Run& run, const geometry::SmoothCurve& fair,
                                    const geometry::MarkedPieces& pieces,
                                    const PlanOptions& options);

[[nodiscard]] std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::SmoothCurve& fair,
                                                  const geometry::MarkedPieces& pieces,
                                                  const CurvatureProfile& bends,
                                                  const PlanOptions& options);

// The parts of a smoothed run between changes of feed, and where its comments go.

// A part of the curve that is run at one feed.
struct FeedStretch {
  double from = 0;  // parameters of the curve
  double to = 0;
  double feed = 0;  // mm/min
};

// In order, each starting where the one before it ends, from the curve's first parameter to its
// last. None is empty; neighbours have different feeds.
//
// Throws std::invalid_argument when `fair` does not have one parameter per point of the run, or
// when the run has no feed.
[[nodiscard]] std::vector<FeedStretch> feed_stretches(const Run& run,
                                                      const geometry::SmoothCurve& fair);

// Puts the run's comments into the plan. `starts`: the curve's parameter at the start of each
// move, not decreasing.
void place_comments(const Run& run, const geometry::SmoothCurve& fair,
                    std::span<const double> starts, OutputPlan& plan);

// What the plans of arcs and of curves have in common.

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
