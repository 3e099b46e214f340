// A fair path that stays on one side of the run, for walls that must not be overcut.
// Method: docs/algorithms/one_side.md.
#pragma once

#include <optional>
#include <span>

#include "geometry/basic/point.h"
#include "geometry/basic/tolerance_kind.h"
#include "geometry/fitting/fair/fair.h"

namespace batten::geometry {

struct OneSidedTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  double curve_part = 0.5;  // of the tolerance, for the curve about the moved vertices
  double ramp = 16;         // tolerances along the path, over which a move comes and goes
  // Rounds of moving on where the last curve still came over. Each moves a little further than that
  // curve needed, since the next one is another curve.
  int rounds = 6;  // [<]
  double further = 1.1;
  // A curve that comes over by this part of the tolerance is let through: the proof allows twice
  // that.
  double let_through = 0.05;
  // The room that a curve has at the ends of a run, where nothing is moved yet: less than what is
  // let through, in parts of the tolerance.
  double least_room = 0.8 * let_through;
  // Where the path turns to the other side, the path beside it turns round the vertex on an arc.
  // Its corner is held back by this many moves, for beyond 75 degrees the corner of the moved edges
  // would leave too little room.
  double furthest_corner = 1.25;  // [<]
  int samples = 8;  // beside each edge, at which the curve is looked at [>]
};
inline constexpr OneSidedTuning kOneSidedTuning;

struct OneSidedOptions {
  FairOptions fair;  // its tolerance is all that the curve may use, on the one side
  Side side = Side::kLeft;
  // mm that the curve stays away from the run where it bends, for what is written along it (chords,
  // arcs) may be off to both sides by as much.
  double margin = 0;
};

// The vertices are moved to that side by no more than the curve needs for not coming over to the
// other one, and faired there. The ends are met exactly; the way from them to the moved path is
// gentle. By samples: the proof is the verifier's.
//
// Returns nothing when there is no such curve within the tolerance, or the run has no side (it goes
// straight up or down). Throws as fair_path does.
[[nodiscard]] std::optional<SmoothCurve> one_sided_fair_path(std::span<const Point3> points,
                                                             const OneSidedOptions& options);

}  // namespace batten::geometry
