// How a smoothed run is said in the target's words: lines, arcs or curves along its curve, cut
// where the feed changes, with the run's comments.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "gcode/control/control.h"
#include "geometry/arcs/arc_count.h"
#include "geometry/arcs/arc_spline.h"
#include "geometry/fitting/fair/fair.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/path.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/methods/run_curve.h"

namespace batten::postproc {

struct PlannedMove {
  geometry::PathPiece piece;                 // a CubicBezier only as part of a PlannedCurve
  double feed = 0;                           // mm/min
  std::vector<std::size_t> comments_before;  // indices into Run::comments
  double start = 0;                          // parameter of the curve, not decreasing
};

// Moves that are written together as one curve of the target: the curve's Bezier pieces.
struct PlannedCurve {
  std::size_t first = 0;         // index into OutputPlan::moves
  std::size_t count = 0;         // as many as the curve has pieces
  geometry::BsplineCurve curve;  // a clamped cubic
};

// The moves chain to within kSamePlace, from the run's first point to its last.
struct OutputPlan {
  Form form = Form::kLines;
  std::vector<PlannedMove> moves;
  std::vector<PlannedCurve> curves;         // in order
  std::vector<std::size_t> comments_after;  // of the run's last blocks
  bool chords_for_steps = false;            // see plan_lines
  bool arcs_as_chords = false;  // of ours, since the target's own would leave some arcs too far
  // Of the places of lines, where the target's are more.
  int most_decimals = std::numeric_limits<int>::max();
};

// Where the run stands in place of lines and arcs (slow_parts.h).
enum class RunInPlace : std::uint8_t { kNowhere, kAtEnds, kWhereNeeded, kEverywhere };

// What a form follows: the curve; the band around the vertices (plan_arc_spline); or the vertices
// themselves: lines and arcs that they are on (line_arcs.h), lines between them (plan_vertices).
enum class Along : std::uint8_t { kCurve, kBand, kVertices };

struct PlanOptions {
  const gcode::Control* target = nullptr;
  const Machine* machine = nullptr;
  gcode::Units units = gcode::Units::kMillimetre;
  gcode::Plane active_plane = gcode::Plane::kXY;
  double max_deviation = 0.005;  // mm, moves to curve: the share of the form
  // Of it, where the curve is farther from the centre than an arc: the target's own chords of the
  // arc lie on the other side.
  double outside = std::numeric_limits<double>::infinity();
  double keep_corner_angle = 3.2;  // radians: see geometry::FairOptions
  Linearize linearize = Linearize::kChord;
  geometry::ArcEffort arc_effort = geometry::ArcEffort::kQuick;
  // Of chords by Linearize::kChord: how high they may be where there is room for as long ones (mm),
  // and how many of them there may be; 0: any number.
  double chord_height = 0.005;
  std::size_t most_moves = 0;
  // minlink: about as many lines, made quickly for their number.
  bool counted = false;
  RunInPlace run_in_place = RunInPlace::kNowhere;
  int most_decimals = std::numeric_limits<int>::max();  // OutputPlan
  // More arcs than this are not looked for.
  std::size_t most_arcs = std::numeric_limits<std::size_t>::max();
  // mm, moves to run. Of lines, where max_deviation is not to be the same everywhere; of arcs, with
  // the chords that the target itself makes of them.
  double tolerance = 0;

  bool operator==(const PlanOptions&) const = default;
};

// Parts are of max_deviation unless said otherwise.
struct PlanTuning {
  // Lines.
  double coarser = 4;            // the next fineness that is tried: chords twice as long
  double balanced = 1.45;        // so much higher balanced chords may be: two thirds of it are left
  double least_room = 0.3;       // where the curve comes near to the limit: the proof decides
  double height_step = 0.8;      // from one height to the next lower one
  int cut_again = 3;             // so often, at most, are chords cut that leave a vertex too far,
  double cut_beside_ends = 0.1;  // by no less than this part of them
  double coarser_again = 1.05;   // at least, where chords are still too many
  int counted_gates = 8;         // along a link, where links are but counted
  double periods = 1.1;          // block periods, with which the control just holds the feed
  // Arcs. There are few that the target refuses: too tight, too short.
  double arc_chords = 0.1;      // kept for chords in their place
  double spline_chords = 0.03;  // the same where they are refused after rounding only
  int newton_steps = 3;         // to the parameter of an end, from about the right one
  double reversal = 170 * geometry::kPi / 180;  // greater turns stay: see geometry::find_features
  double no_corner = 1e-3;  // radians between the two ends of a closed run that make no corner
  // Curves.
  double long_line = 5;       // mm: a shorter straight part is not worth an end and a new start
  double curve_chords = 0.1;  // kept for chords in place of pieces that the target does not take
  double for_control = 0.5;   // for the control's own chords: with less the pieces get short
  double no_kink = 0.1 * geometry::kPi / 180;  // a smaller turn: SPL blocks may turn so in joints
  int halvings = 4;  // of a piece that is not taken: all but a sixteenth can still be curves
};
inline constexpr PlanTuning kPlans;

// All plans cut the curve where the feed changes, and put each comment before the move that starts
// at or first after the comment's vertex. All throw std::invalid_argument when `fair` does not have
// one parameter per point of the run. `pieces` is all of fair.curve.

// Lines along the curve, as `linearize` says; chords where the equal steps of ilca would be too
// many (geometry/chords/ilca.h), which the plan says. minlink, ilca and blca take all of
// max_deviation; the vertices of minlink alone leave the curve. Chords are balanced
// (geometry/chords/linearize.h) and chord_height high, but coarser where the control would slow
// down for so short ones, or where they would be more than most_moves, and finer where the curve
// leaves too little of the tolerance: no further from the curve than max_deviation, or where
// `tolerance` is given, than the curve leaves of it there.
[[nodiscard]] OutputPlan plan_lines(const Run& run, const geometry::SmoothCurve& fair,
                                    const geometry::MarkedPieces& pieces,
                                    const PlanOptions& options);

// The run's own vertices, moved, none by more than max_deviation: to where lines between them are
// nearest to the curve (geometry::nearest_chords). As many lines as the run has, each no farther
// than that from its own. For runs of lines.
[[nodiscard]] OutputPlan plan_vertices(const Run& run, const geometry::SmoothCurve& fair,
                                       const PlanOptions& options);

// Arcs in a plane that the target takes arcs in and that the run lies in, the active plane first. A
// run in space: helices and lines in the plane that needs the fewest, where they are fewer than the
// run's motions, and none is a helix where the target takes none. Nothing when no plane serves.
// Arcs that the target would refuse are chords already, and so are those that with the target's own
// chords would be farther from the run than `tolerance`, or that these leave more than those of the
// arcs that the run has there and than the target itself aims at. Comments are placed by the length
// along the moves, which may be one short move off. `bends`: of the curve.
[[nodiscard]] std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::SmoothCurve& fair,
                                                  const geometry::MarkedPieces& pieces,
                                                  const CurvatureProfile& bends,
                                                  const PlanOptions& options);

// About how many moves plan_arcs makes of the curve at least, in the plane that takes fewest.
[[nodiscard]] double arcs_expected(const Run& run, const geometry::ArcCount& count,
                                   const PlanOptions& options);

// About how many blocks plan_curves comes in, known before it is made.
[[nodiscard]] double curves_expected(const geometry::MarkedPieces& pieces,
                                     const PlanOptions& options);

// Few arcs in the band around the run's vertices themselves, where max_deviation is measured from;
// of the fair curve only the direction is taken where the path is cut. Every joint is tangent but
// for corners in which no arc of the target's least radius fits. The run lies in a plane that the
// target takes arcs in; nothing otherwise, or when no chain was found.
[[nodiscard]] std::optional<OutputPlan> plan_arc_spline(const Run& run,
                                                        const geometry::SmoothCurve& fair,
                                                        const PlanOptions& options);

// Curves of the target, on few control points: the curve is fitted anew within max_deviation where
// that takes fewer. Long straight parts are lines, and so is what the target does not take as a
// curve. Curves end at corners. Nothing when the target has no curves or none serves here.
[[nodiscard]] std::optional<OutputPlan> plan_curves(const Run& run,
                                                    const geometry::SmoothCurve& fair,
                                                    const PlanOptions& options);

// A part of the curve that is run at one feed.
struct FeedSection {
  double from = 0;  // parameters of the curve
  double to = 0;
  double feed = 0;  // mm/min
};

// In order, each starting where the one before it ends, from the curve's first parameter to its
// last. None is empty; neighbours have different feeds. Throws std::invalid_argument also when the
// run has no feed.
[[nodiscard]] std::vector<FeedSection> feed_sections(const Run& run,
                                                     const geometry::SmoothCurve& fair);

// Puts the run's comments into the plan.
void place_comments(const Run& run, const geometry::SmoothCurve& fair, OutputPlan& plan);

// Whether all points of the run are at one height along the axis.
[[nodiscard]] bool lies_across(const Run& run, int axis);

// Chords for an arc, each within `deviation` (mm) of it.
[[nodiscard]] geometry::Path chords_for(const geometry::Arc& arc, double deviation);

}  // namespace batten::postproc
