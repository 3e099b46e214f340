// A program in the words of its target, smoothed window by window: cut, smooth, prove, hand on.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/stream/prescan.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/stream/window.h"

namespace batten::postproc {

// Takes the next part of the new program; false stops the work. Called by one thread at a time.
using TextSink = std::function<bool(std::string_view)>;

// Where the new program goes while it is made.
struct ProgramSink {
  TextSink take;
  std::function<bool()> restart;  // what it was given is void; false stops the work
};

struct StreamLimits {
  // From this size on a program is read twice and cut into windows where that can be, which takes
  // some 30 MB, however long it is; as one window it takes 1 KB and more for each block.
  std::size_t bytes_for_windows = std::size_t{1} << 18;
  WindowLimits windows = {};
  // A window with which the text so far is larger or farther off for too little is made again.
  // False: the program is smoothed as a whole then, which keeps less of it back.
  bool mend_windows = true;
};

// The result without its text, which went to the sink: the same bytes, report and diagnostics
// whether the program is one window or many, but for two things that a window does not know: what
// runs that are alike show in others (postproc/smooth/like_runs.h), and what later ones save
// (StreamLimits::mend_windows). It is one window where it is short, for a lathe, with words of a
// profile, or where prescan finds no cut.
//
// Everything is done anew, and the sink is told to restart, where the new paths of two parts of a
// long run cross, with the sections about the crossing copied; and where a window cannot be proved
// for itself, as one window. Where the result is not understood, what the sink was given is void.
//
// With a survey nothing is rewritten; at a restart what it has seen is void, too.
[[nodiscard]] SmoothResult smooth_windows(const gcode::SourceText& source,
                                          const SmoothOptions& options, const ProgramSink& sink,
                                          const Progress& progress, const StreamLimits& limits,
                                          const PartSurvey& survey);

}  // namespace batten::postproc
