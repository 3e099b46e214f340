// One window of a program, smoothed and proved for itself: the whole of a short program, or a part
// of a long one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/part_crossings.h"
#include "postproc/stream/prescan.h"
#include "postproc/stream/run_report.h"

namespace batten::postproc {

// What the windows of a program have in common.
struct WindowSetting {
  const gcode::SourceText& source;
  const SmoothOptions& options;
  gcode::ReadOptions read_options;
  LongRunLimits long_runs = {};
  bool was_smoothed = false;  // the program: all runs are kept
  LongRunFacts facts = {};
};

// What a window takes over from the new text before it.
struct NewTextBefore {
  TextBefore known;
  bool says_smoothed = false;  // that it was smoothed stands there already
};

enum class WindowOutcome {
  kDone,
  kStopped,
  kNeedsWhole,  // something differs that none of its runs is to blame for
};

struct WindowDone {
  WindowOutcome outcome = WindowOutcome::kDone;
  NewTextBefore before;  // that it was made for
  NewTextBefore behind;
  bool read_again = false;  // `behind.known` is set: the new text was read for the proof
  bool unchanged = false;   // the text is the bytes of the window
  bool proved = false;
  std::string text;
  std::size_t blocks = 0;  // of the text
  std::size_t added_lines = 0;
  double corner_mm = 0;
  double deviation_mm = 0;
  std::uint32_t deviation_line = 0;
  std::vector<RunReport> runs;
  std::vector<gcode::Diagnostics> notes;
  std::optional<gcode::Diagnostic> untold;  // postproc/stream/provenance.h
  gcode::Diagnostics form_notes;            // postproc/stream/form_notes.h
  TextBefore old_behind;
  std::shared_ptr<const std::vector<SelfProximity>> near;  // of its long runs; or none
  std::vector<NearEdges> near_edges;
  std::uint32_t last_line = 0;
};

// What the new text before a window may have told the control, by what the old text told it there.
using Guess = std::function<NewTextBefore(const TextBefore& old_before)>;

// Smooths the runs of a part and proves its text; `additions.comment` is said before the first run
// that is rewritten. `tell` is told the share of the work that is done. Neither `before` nor
// `behind` is set.
[[nodiscard]] WindowDone smooth_part(const WindowSetting& setting, const ProgramPart& part,
                                     PartRuns runs, const Additions& additions,
                                     const ProgressCallback& tell);

// A part of a long program, read from its place and smoothed. One that is not proved needs the
// whole.
[[nodiscard]] WindowDone smooth_window(const WindowSetting& setting, const WindowPlace& place,
                                       const Guess& before, const ProgressCallback& tell);

// Whether what is made for one of them is what is made for the other.
[[nodiscard]] bool same_before(const NewTextBefore& a, const NewTextBefore& b);

}  // namespace batten::postproc
