// Text to blocks and words, as CAM systems and shops write them. What is not fully understood
// becomes an opaque block, never an error of the reader.
#pragma once

#include "gcode/state/modal_state.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/language.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// How a text is read.
struct Reading {
  Language language = Language::kRs274;
  Decimals decimals = {};                  // of the RS-274 family
  Units units = Units::kUnknown;           // of a program that names none
  DwellForm dwells = DwellForm::kUnknown;  // of the RS-274 family
  bool keeps_expressions = false;  // gcode/reading/constants.h: none becomes a number
  bool short_ways = true;  // for simple lines (gcode/rs274/plain_words.h); they change nothing
};

// Adds to `found` what is worth telling (each id in docs/diagnostics.md): at most one
// diagnostic per block. Linear time; one pass.
[[nodiscard]] Program parse(const SourceText& source, const Reading& reading, Diagnostics& found);

// In this language, a number without a point being what it says.
[[nodiscard]] Program parse(const SourceText& source, Language language, Diagnostics& found);

// A program of the RS-274 family.
[[nodiscard]] Program parse(const SourceText& source, Diagnostics& found);

}  // namespace batten::gcode
