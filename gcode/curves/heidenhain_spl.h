// Heidenhain SPL blocks (TNC 426, TNC 430, iTNC 530): one cubic polynomial per axis and block, in t
// from 1 to 0. Facts and sources: docs/controllers/heidenhain_curves.md.
#pragma once

#include <optional>
#include <string>

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

// The control refuses an arc whose ends are not on one circle about CC, by more than this (mm; a
// machine parameter, from memory).
inline constexpr double kKlartextRadiusMismatch = 0.016;

// The control stops where the start that K1, K2, K3 and the end imply is further from the tool's
// position, on any axis (mm).
inline constexpr double kSplClosure = 1e-3;

// K as it is printed: `+5.6`, `-1.2E+001`. Nothing beyond the range of the control.
struct PrintedCoefficient {
  std::string digits;
  double value = 0;  // as read
};
[[nodiscard]] std::optional<PrintedCoefficient> print_spl_coefficient(double value, int decimals);

// SPL as a format: for the controls that read it as an option.
//
// What is written: a block per piece, and per block a line with the end and a line for each axis,
// all but the last with ~. K1 is chosen so that the printed numbers of a block add up to its start:
// the error of rounding is in the tangent, and far below the angle at which the control stops. K
// has the decimals of `setting.other`, more where a joint would have a kink. Refused are a curve
// that starts further than one step of the printed places from the tool, fewer than two named axes,
// numbers beyond the control's ranges, blocks that would not close to within 1 um, and kinks of 0.1
// degrees or more that the given pieces do not have.
//
// What is read: the SPL blocks from line `first` on, up to the first line that is none, or that has
// an F of its own. Lines are joined by ~, and where a line starts with a K word. Refused are
// splines of other axes, other words, K words that are missing or in another order, an axis whose
// position is not known, and a start that is further from the tool than 1 um.
[[nodiscard]] const CurveFormat& heidenhain_spl();

}  // namespace batten::gcode
