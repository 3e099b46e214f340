// What is asked of the fairing of a path (fair.h), and how that is stated as a fit: where knots may
// start, what the curve has to keep near and how closely. Method: docs/algorithms/fair.md, sections
// Band and Corners.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/bspline_fit_system.h"
#include "geometry/fitting/fair/path_features.h"

namespace batten::geometry {

struct FairOptions {
  double tolerance = 0.01;         // mm, curve to polyline and back, in order; > 0
  double rounding = 0.0005;        // mm, greatest error of one printed coordinate of the input
  double keep_corner_angle = 3.2;  // radians: vertices that turn more stay as they are (> pi: none)
  double keep_found_corner = 3.2;  // radians: the same of corners alone, not of noise
  double feed = 1000;              // mm/min that the machine should hold (the greatest of the run)
  double acceleration = 1000;      // mm/s^2 across the path that the machine can give
  double jerk = std::numeric_limits<double>::infinity();  // mm/s^3, the same
  double scatter = 0;     // mm that vertices may scatter about the curve, beyond their noise:
                          // a simpler curve, further from the path that was meant
  bool accurate = false;  // spend the tolerance on noise only, never on feed
  // Pass vertices as near as their decimals tell their places, which takes more control points;
  // else as near as their rounding lets them scatter.
  bool near = true;
  // Per edge, from each point to the next: the part of the tolerance that the curve may use there,
  // above 0 and 1 at most. Empty: all of it everywhere. Has to outlive the call.
  std::span<const double> rooms;
};

struct FairTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  // --- the band, in parts of the tolerance
  // The fit aims inside the band by this share, since between its samples the curve leaves the band
  // by a percent or two. What it aims at is the limit below.
  double aim = 0.96;
  double rounding = 0.25;  // more than this of the tolerance does not count as rounding
  // Where the curve left an edge between its samples, the next fit gives out that much less of the
  // limit there, but not less than this part of what it had.
  double aim_again = 0.98;
  double least_share = 0.85;
  // Violations of an edge after which it stays a line between kept corners, and with it, at every
  // further violation, twice as many edges around it. Among vertices that noise moved out of the
  // band, a curve that leaves an edge has come from the next one: its samples bring it back,
  // however far it was.
  int watched = 1;
  int watched_among_noise = 2;  // [<]
  // Elsewhere, where it left an edge by more than this, no closer watch is tried: there is a
  // corner, and a curve that is forced round it inside the band would be sharper than the corner is
  // worth.
  double slightly = 1.2;
  int attempts = 9;   // fits until nothing is tried any more but the polyline itself [<]
  double met = 0.01;  // vertices that are met are met to this

  // --- room for the feed
  int rounds = 3;             // of widening
  double widen = 4;           // what one of them widens the scatter by
  double most_scatter = 0.5;  // of the tolerance; beyond it only the limit counts
  double worth_it = 0.002;  // least part of a section's time that a round must win to be kept there
  std::size_t beside_tight = 3;  // vertices on either side of a tight one that are widened too
  // A section reaches so many vertices beyond those that were widened: the curve moves there too.
  std::size_t beside_widened = 16;

  // --- closed runs
  // Vertices that are added before the start and after the end: the influence of a vertex on the
  // curve dies out over some ten vertices.
  std::size_t wrap = 200;
  // A knot that is nearer to a cut than this part of the spans beside it is put on the cut. Left
  // where it is, it would make a span of next to no length, and what is done to the control points
  // at the seam would bend the curve there as hard as that span is short.
  double on_cut = 0.1;  // [at 1]

  // --- corners, in limits
  // They are rounded within this along their legs: enough for the curve to leave the line gently,
  // little enough to keep its deviation local.
  double reach = 40;
  double reach_between = 0.45;   // of the way to the next rounded corner, at most
  double reach_to_kept = 0.9;    // of the way to the next kept one
  double first_knot = 0.5;       // knots around a corner start there and double outwards
  double closest_knots = 0.125;  // nearer to a pin or to a line they add nothing but trouble
  double line_ends = 0.6;        // a line whose ends take more of it has no exactly straight middle

  // --- knots and samples
  // The first fit has a knot per so many vertices; spans that cannot follow are split.
  std::size_t vertices_per_span = 64;
  // A vertex whose chords leave the path by so many times what it may scatter has a knot at once.
  // Knots that come one by one, where a span fails, are elsewhere in the next row of a surface, and
  // the curve is off elsewhere.
  double coarse = 4;
  // Smooth edges whose chord may leave the curve by this part of the limit are watched between
  // their vertices; so are those whose vertices leave the curve as much room.
  double watched_sagitta = 0.25;
  // Samples of an edge that the curve left, for each time and at the most.
  int samples_per_violation = 4;
  int most_violation_samples = 8;  // [<]

  // --- scatter
  // Taken this much greater than the estimated noise: a curve that follows a part of the noise is
  // worse than one that is a little too smooth.
  double noise_margin = 1.2;
  // Where the curve through the vertices would leave the chords by more than this part of the
  // limit, the vertices no longer bind: the curve runs between vertices and chords. Otherwise it
  // would have to swing out to each vertex.
  double too_high = 0.88;
  // Printed coordinates scatter by their rounding, 0.58 of its greatest error (rms), and the curve
  // leaves this part of that error: with less it would follow the rounding itself. So near a curve
  // is worth its knots only where chords leave the path by more than the rounding does: it may
  // leave so many greatest errors squared, over that height, and one of them at the most.
  double left_of_rounding = 0.4;
  double worth_knots = 1.6;
  // Noise that is more than so many of the greatest rounding errors is no rounding: no more of it
  // is taken away, for a curve that leaves less follows the noise.
  double rounding_noise = 2;
  // A noisy vertex is drawn towards its denoised position, by so much of the limit at the most;
  // what is left is room for the curve. With more of it the curve is nearer to what was meant, and
  // bends harder: with nine tenths it takes 4 % longer, with half it is 3 % further away.
  double towards_denoised = 0.7;
  // So much of the limit is the curve expected to pass the drawn vertices at: with less of it edges
  // are kept, with more the curve is no smoother.
  double denoised_scatter = 0.3;
  // Nor, where noise is less than that, at more than this part of it: the estimate is off by about
  // as much.
  double denoised_part = 0.35;
};
inline constexpr FairTuning kFairTuning;

// mm that the fit keeps to, and the greatest error of a printed coordinate that it counts with.
[[nodiscard]] inline double aimed_limit(const FairOptions& options) {
  return kFairTuning.aim * options.tolerance;
}
[[nodiscard]] inline double counted_rounding(const FairOptions& options) {
  return std::min(options.rounding, kFairTuning.rounding * options.tolerance);
}

// How closely an edge is watched that an earlier curve has left.
struct EdgeRefinement {
  double share = 1;    // of the limit that is given out beside it
  int violations = 0;  // so often the curve left it: it gets more samples
};

// What an earlier curve showed, and noise.
struct FairCare {
  // Per vertex: >= 1 widens the scatter that is expected there (the machine needs more room);
  // infinite: only the limit counts.
  std::vector<double> loosen;
  std::vector<EdgeRefinement> edges;
  // Per vertex: its denoised position where noise takes much of the band, its own elsewhere; empty:
  // the latter everywhere.
  std::vector<Point3> denoised;
};

[[nodiscard]] FitProblem state_fair_problem(std::span<const Point3> points,
                                            const PathFeatures& features, const FairCare& care,
                                            const FairOptions& options);

}  // namespace batten::geometry
