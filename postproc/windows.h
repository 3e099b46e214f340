// Long programs, smoothed and proved window by window: the memory is that of one window (its least
// number of blocks and what is left of the last run in it), the reports of the runs, and no more.
// The bytes, the report and the diagnostics are those of smooth_program.
//
// Why a program is proved when its windows are: postproc/proof/part_proof.h.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>

#include "gcode/source_text.h"
#include "postproc/options.h"
#include "postproc/pipeline.h"

namespace batten::postproc {

// Takes the next part of the new program; false stops the work.
using TextSink = std::function<bool(std::string_view)>;

// As many runs as keep all threads busy, and a small part of the memory that a program may take:
// about 1.5 KB a block.
inline constexpr std::size_t kWindowBlocks = 32768;

// Nothing where the program needs to be smoothed as a whole (postproc/program_scout.h, words of a
// profile, and where something differs that no run of a window is to blame for): what the sink was
// given is worth nothing then. Otherwise the result without its text; where the work was stopped,
// it is not understood.
[[nodiscard]] std::optional<SmoothResult> smooth_in_windows(
    const gcode::SourceText& source, const SmoothOptions& options, const TextSink& sink,
    const Progress& progress = {}, std::size_t least_blocks = kWindowBlocks);

}  // namespace batten::postproc
