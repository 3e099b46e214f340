// Siemens BSPLINE blocks: the control points of a B-spline. What the control makes of them is not
// verified, so no text of this file may be written unless the user says that he has checked it.
#pragma once

#include <string_view>

#include "gcode/curves/curve_format.h"
#include "geometry/path/bspline_curve.h"

namespace batten::gcode {

// What has to be told to the user before BSPLINE is written.
inline constexpr std::string_view kBsplineUnverified =
    "BSPLINE is not verified: how PL maps to the knots, what the first and the last blocks mean "
    "and "
    "where the curve starts were found in no manual; run the program on the control or on "
    "SinuTrain "
    "and compare it with POLY before cutting";

// Why the flag is there: a caller says in words of code that the user accepted the text above.
enum class BsplineUse { kNotAccepted, kAcceptedUnverified };

// The place where the tool stands is the first control point P0, and one block for each further
// one: P1 .. Pm. The assumed meaning of PL: block i ends the knot interval
// [t(i+2), t(i+3)] of the clamped knots t of a cubic curve, so the first blocks have the lengths of
// the spans in their order and the last two have PL=0. Knots are scaled as for G06.2.
// Refused without the flag.
[[nodiscard]] CurveWriting write_bspline(const geometry::BsplineCurve& curve,
                                         const CurveSetting& setting, BsplineUse use);

// Reads such blocks under the same assumption, up to the first block that has no PL. Refused
// without the flag.
[[nodiscard]] CurveResult read_bspline(const Program& program, std::uint32_t first,
                                       const CurveStart& start, BsplineUse use);

// BSPLINE as the curves of Siemens controls; see gcode/curves/siemens_bspline.h.

// Only under --output curves, and for who names the target that has them: what the control makes of
// the blocks is not verified, and caution() says so.
[[nodiscard]] const CurveFormat& siemens_bspline();

}  // namespace batten::gcode
