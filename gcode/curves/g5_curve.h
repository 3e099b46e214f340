// G5: one cubic Bezier piece per block, in the XY plane. I J is the way from the start to the
// second control point, P Q that from the end to the third. Every block is written whole, as some
// controls take left out words for zero and others continue the piece before.
//
// LinuxCNC runs a piece as 32 arcs, grblHAL and Marlin as chords. Facts: docs/controllers/.
#pragma once

#include <vector>

#include "gcode/curves/curve_format.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// How grblHAL and Marlin run a G5: as chords, which they find by halving and doubling the step of
// the parameter until the middle of each chord is near its curve. Facts and sources:
// docs/controllers/grbl_family.md.

// The parameters at which their chords end, increasing, the last one 1.
[[nodiscard]] std::vector<double> chopped_at(const geometry::CubicBezier& piece);

// What is written: refused where a piece leaves the plane of the start, or where a printed offset
// is zero: the piece has no direction there then. What is read: a block with G5, X, Y, I, J, P, Q,
// perhaps F and N, and nothing else but comments.

// LinuxCNC 2.9: only under --output curves. Pieces that bend one way, in G17, not under G41, G42.
//
// It reads more than it writes: G5 with X or Y alone; G5 without I and J behind one, which goes on
// in its direction, as one curve of several blocks; G5.1 (a quadratic piece); G5.2 .. G5.3 (a
// B-spline with even knots and weights of 1).
[[nodiscard]] const CurveFormat& linuxcnc_g5();

// grblHAL and Marlin: only under --output curves, since arcs are run with far finer chords. Pieces
// in G17, none of them straight.
[[nodiscard]] const CurveFormat& chopped_g5();

}  // namespace batten::gcode
