// A fair path that stays on one side of the run, for walls that must not be overcut.
// Method: docs/algorithms/one_side.md.
#pragma once

#include <optional>
#include <span>

#include "geometry/basic/point.h"
#include "geometry/basic/tolerance_kind.h"
#include "geometry/fitting/fair/fair.h"

namespace batten::geometry {

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
