// Whether a text begins as programs of plain words do, and as no Klartext program can.
#pragma once

#include <optional>

#include "gcode/text/source_text.h"

namespace batten::gcode {

// The first block that says anything, behind comments, % lines and an O number, where it begins
// with a G word: `N10 G21 G90`. No statement of Klartext begins so. Reads no further than that.
[[nodiscard]] std::optional<SourceSpan> plain_beginning(const SourceText& source);

}  // namespace batten::gcode
