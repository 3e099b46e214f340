// The whole of `batten smooth` but files and messages: text in, proved text out.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/stream/prescan.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/stream/window.h"

namespace batten::postproc {

// Takes the next part of the new program; false stops the work. Called by one thread at a time.
using TextSink = std::function<bool(std::string_view)>;

// Nothing where the program needs to be smoothed as a whole (postproc/stream/prescan.h, words of a
// profile, and where something differs that no run of a window caused): what the sink was given is
// void then. Otherwise the result without its text; where the work was stopped, not understood.
//
// `copied`: sections of long runs that are kept. Where the new paths of two parts cross nothing is
// returned and it has grown: the windows are to be made anew with it.
[[nodiscard]] std::optional<SmoothResult> smooth_in_windows(
    const gcode::SourceText& source, const SmoothOptions& options, const TextSink& sink,
    const Progress& progress = {}, const WindowLimits& limits = {},
    std::vector<LineRange>* copied = nullptr, const PartSurvey& survey = {});

// The whole program as one window, its text in memory. `long_runs`: where long runs are cut.
//
// A program that is to be translated (postproc/convert/conversion.h) is translated first, then
// smoothed in that language, and the written text proved against the source. Lines, runs and
// diagnostics of the result are those of the source. Where a block cannot be said, or the
// translation is not proved (diagnostic `cannot-convert`), the result is not understood and has no
// text. Where only the smoothed text is not proved, the text is the translation alone.
[[nodiscard]] SmoothResult smooth_program(const gcode::SourceText& source,
                                          const SmoothOptions& options,
                                          const Progress& progress = {},
                                          const LongRunLimits& long_runs = {},
                                          const PartSurvey& survey = {});

// Where the new program goes while it is made.
struct ProgramSink {
  TextSink take;
  std::function<bool()> restart;  // what it was given is void; false stops the work
};

struct StreamLimits {
  // From this size on a program is read twice and smoothed window by window where that can be, in
  // some 30 MB; as one window it takes about 60 MB, and one of ten times the size ten times that.
  std::size_t bytes_for_windows = std::size_t{1} << 21;
  WindowLimits windows = {};
};

// The same with the text handed on as it comes: window by window where the program is long, as one
// window where it is short or needs the whole. The same bytes, report and diagnostics either way.
// Where the result is not understood, what the sink was given is void. With a survey nothing is
// rewritten; when the sink is told to restart, what the survey has seen is void, too.
[[nodiscard]] SmoothResult smooth_program(const gcode::SourceText& source,
                                          const SmoothOptions& options, const ProgramSink& sink,
                                          const Progress& progress, const StreamLimits& limits = {},
                                          const PartSurvey& survey = {});

}  // namespace batten::postproc
