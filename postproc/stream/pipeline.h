// The whole of `batten smooth` but files and messages: text in, proved text out.
#pragma once

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/stream/smoothing.h"
#include "postproc/stream/window.h"

namespace batten::postproc {

// The new program's text is in the result.
//
// A program that is to be translated (postproc/convert/conversion.h) is translated first, then
// smoothed in that language, and the written text proved against the source. Lines, runs and
// diagnostics of the result are those of the source. Where a block cannot be said, or the
// translation is not proved (diagnostic `cannot-convert`), the result is not understood and has no
// text. Where only the smoothed text is not proved, the text is the translation alone.
[[nodiscard]] SmoothResult smooth_program(const gcode::SourceText& source,
                                          const SmoothOptions& options,
                                          const Progress& progress = {},
                                          const StreamLimits& limits = {});

// The same with the text handed on as it comes (postproc/stream/smoothing.h).
[[nodiscard]] SmoothResult smooth_program(const gcode::SourceText& source,
                                          const SmoothOptions& options, const ProgramSink& sink,
                                          const Progress& progress, const StreamLimits& limits = {},
                                          const PartSurvey& survey = {});

}  // namespace batten::postproc
