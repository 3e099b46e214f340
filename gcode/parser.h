// Text to blocks and words: the grammars of the RS-274 family and of other languages as CAM systems
// and shops write them. What is not fully understood becomes an opaque block, never an error of
// the reader.
#pragma once

#include "gcode/diagnostic.h"
#include "gcode/language.h"
#include "gcode/program.h"
#include "gcode/source_text.h"

namespace batten::gcode {

// Adds to `found` what is worth telling (each id in docs/diagnostics.md): at most one
// diagnostic per block. Linear time; one pass.
[[nodiscard]] Program parse(const SourceText& source, Language language, Diagnostics& found);

// A program of the RS-274 family.
[[nodiscard]] Program parse(const SourceText& source, Diagnostics& found);

}  // namespace batten::gcode
