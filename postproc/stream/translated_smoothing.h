// `batten smooth --convert` from plain words to another language: translated first
// (postproc/convert/translation.h), then smoothed in that language, and the written text proved
// against the program as it was.
#pragma once

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/stream/pipeline.h"

namespace batten::postproc {

// Requires is_to_be_translated (postproc/convert/conversion.h). Lines, runs and diagnostics of
// the result are those of the source. Where a block cannot be said, or the translation is not
// proved, the result is not understood and carries no text. Where only the smoothed text is not
// proved, the text is the translation alone.
//
// Rounding places to the target's digits is a part of the tolerance: smoothing has the rest.
[[nodiscard]] SmoothResult smooth_translated(const gcode::SourceText& source,
                                             const SmoothOptions& options,
                                             const Progress& progress);

}  // namespace batten::postproc
