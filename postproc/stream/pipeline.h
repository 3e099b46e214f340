// The whole of `batten smooth` but files and messages: text in, proved text out.
#pragma once

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/runs/long_run_cuts.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

// `long_runs`: where runs are cut that are too long to be held as one.
//
// A program that is to be translated (postproc/convert/conversion.h) is translated first, then
// smoothed in that language, and the written text proved against the program as it was. Lines, runs
// and diagnostics of the result are those of the source. Where a block cannot be said, or the
// translation is not proved, the result is not understood and carries no text. Where only the
// smoothed text is not proved, the text is the translation alone.
[[nodiscard]] SmoothResult smooth_program(const gcode::SourceText& source,
                                          const SmoothOptions& options,
                                          const Progress& progress = {},
                                          const LongRunLimits& long_runs = {});

}  // namespace batten::postproc
