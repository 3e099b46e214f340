// Do two programs write their numbers alike, with a decimal point or without one? Some controls of
// the FANUC kind take X5. for 5 mm and X5 for 0.005 mm (gcode/text/language.h). Where nobody says
// which control the programs are for, the one is not the other.
#pragma once

#include <optional>

#include "gcode/text/source_text.h"
#include "postproc/proof/verification.h"

namespace batten::postproc {

// Two programs of the RS-274 family. The first length of the new one that
//   - has no point, where the old one ends whole numbers with a bare point (X5.), and either all
//     lengths of it have a point or this one always has a bare one;
//   - ends with a bare point, where no length of the old one has a point.
// The same for feeds, F100. and F100: the second is 1 in/min on controls of the FANUC kind.
// Zero is zero. Programs that do not end numbers with a bare point, X5 or X5.000, are for other
// controls. Linear time; holds the numbers of the old program that end with a bare point.
[[nodiscard]] std::optional<Violation> other_point_spelling(const gcode::SourceText& before,
                                                            const gcode::SourceText& after);

}  // namespace batten::postproc
