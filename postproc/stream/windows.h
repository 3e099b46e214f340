// Long programs, smoothed and proved window by window, some windows side by side: the memory is
// that of as many windows as there are threads, the reports of the runs, and no more. The bytes,
// the report and the diagnostics are those of smooth_program, for any number of threads.
//
// Why a program is proved when its windows are: postproc/stream/part_proof.h.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/runs/proximity_index.h"
#include "postproc/stream/prescan.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

// Takes the next part of the new program; false stops the work. Called by one thread at a time.
using TextSink = std::function<bool(std::string_view)>;

// Nothing where the program needs to be smoothed as a whole (postproc/stream/prescan.h, words of a
// profile, and where something differs that no run of a window is to blame for): what the sink was
// given is worth nothing then. Otherwise the result without its text; where the work was stopped,
// it is not understood.
//
// `copied`: stretches of long runs that are left as they are. Where the new paths of two parts
// cross nothing is returned and it has grown: the windows are to be made anew with it. Without it
// the program needs the whole then.
[[nodiscard]] std::optional<SmoothResult> smooth_in_windows(
    const gcode::SourceText& source, const SmoothOptions& options, const TextSink& sink,
    const Progress& progress = {}, const WindowLimits& limits = {},
    std::vector<LineRange>* copied = nullptr);

}  // namespace batten::postproc
