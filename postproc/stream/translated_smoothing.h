// A program for another control: said in the target's words, smoothed there, and proved against the
// source.
#pragma once

#include <functional>

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

// How a translation is smoothed as a program of the target.
using Smoother = std::function<SmoothResult(const gcode::SourceText&, const SmoothOptions&)>;

// Requires is_to_be_translated (postproc/convert/conversion.h). A translation that cannot be proved
// is refused, with the diagnostic `cannot-convert`.
[[nodiscard]] SmoothResult smooth_translated(const gcode::SourceText& source,
                                             const SmoothOptions& options,
                                             const Smoother& smoother);

}  // namespace batten::postproc
