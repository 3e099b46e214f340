// G5: one cubic Bezier piece per block, in the XY plane. I J is the way from the start to the
// second control point, P Q that from the end to the third. Every block is written whole, as some
// controls take left out words for zero and others continue the piece before.
//
// LinuxCNC runs a piece as 32 arcs, grblHAL and Marlin as chords. Facts: docs/controllers/.
#pragma once

#include <cstdint>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// A refusal where a piece leaves the plane of the start, where the place is not what rounding
// leaves of it, or where a printed offset is zero: the piece has no direction there then.
[[nodiscard]] CurveWriting write_g5(const std::vector<geometry::CubicBezier>& pieces,
                                    const CurveSetting& setting);

// One block with G5, X, Y, I, J, P, Q, perhaps F and N, and nothing else but comments.
[[nodiscard]] CurveResult read_g5(const Program& program, std::uint32_t first,
                                  const CurveStart& start);

// Whether the piece lies in a plane of XY and LinuxCNC's arcs follow it: they are two for each
// sixteenth of it, found by tangents, and a sixteenth whose tangents are parallel gives no arcs or
// wild ones. So each must turn, all to one side, by `kLeastTurn` (radians) at least, and together
// by less than half a turn.
[[nodiscard]] bool bends_one_way(const geometry::CubicBezier& piece);

// How grblHAL and Marlin run a G5: as chords, which they find by halving and doubling the step of
// the parameter until the middle of each chord is near its curve. Facts and sources:
// docs/controllers/grbl_family.md.

// The parameters at which their chords end, increasing, the last one 1.
[[nodiscard]] std::vector<double> chopped_at(const geometry::CubicBezier& piece);

// mm: no place of the piece is further from its chord. An upper bound, by the hull of the control
// points of each part; right to some percent where all chords bend one way.
[[nodiscard]] double chopping_error(const geometry::CubicBezier& piece);

// G5 as the curves of a control; see gcode/curves/g5_curve.h.

// LinuxCNC 2.9: only under --output curves. Pieces that bend one way, in G17, not under G41, G42.
[[nodiscard]] const CurveFormat& linuxcnc_g5();

// grblHAL and Marlin: only under --output curves, since arcs are run with far finer chords. Pieces
// in G17, none of them straight.
[[nodiscard]] const CurveFormat& chopped_g5();

}  // namespace batten::gcode
