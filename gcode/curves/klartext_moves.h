// Lines and arcs as Heidenhain Klartext blocks: L, CC, C. Facts:
// docs/controllers/heidenhain_curves.md.
#pragma once

#include <span>
#include <string_view>

#include "gcode/curves/curve_alarm.h"
#include "gcode/curves/curve_text.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// The control refuses an arc whose ends are not on one circle about CC, by more than this (mm; a
// machine parameter, from memory).
inline constexpr double kKlartextRadiusMismatch = 0.016;

// A chain of lines and of arcs in the XY plane, from where the tool stands: a block for each line,
// two for each arc (the centre, absolute, then the end and the sense of turn). Axes that stay are
// left out, but an arc names both. The centre is chosen from the printed ends, so that both
// radii agree to within its rounding. Numbers from `first_number` on, none where there is none.
//
// Refuses other pieces, arcs out of the plane or helical, arcs that rounding would make a full turn
// or none, axes that move and are not named, and an empty chain.
[[nodiscard]] CurveWriting write_klartext_moves(std::span<const geometry::PathPiece> pieces,
                                                const CurveSetting& setting,
                                                std::optional<int> first_number);

// Reads L, CC and C blocks from line `first` on, up to the first line that is something else or
// that has an F of its own (after the first). R0 and a bare M mean nothing; RL, RR, FMAX,
// incremental words and M functions end the chain. A C without a CC before it in the chain, or off
// its circle, is refused.
[[nodiscard]] CurveResult read_klartext_moves(const Program& program, std::uint32_t first,
                                              const CurveStart& start);

// What the control would say about the arcs of a program whose lengths are in these units:
//   arc-radius     the ends are not on one circle about CC
//   arc-no-centre  a C without a CC before it
//   arc-no-sense   a C without DR
//   place-range    beyond +-99999.9999
[[nodiscard]] CurveAlarms klartext_arc_alarms(const Program& program, Units units);

}  // namespace batten::gcode
