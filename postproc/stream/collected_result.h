// The result of a program, collected window by window.
#pragma once

#include <optional>

#include "gcode/text/diagnostic.h"
#include "postproc/runs/band_notes.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/stream/window.h"

namespace batten::postproc {

class CollectedResult {
 public:
  // What is known before the first window: of the text, and what reading it tells.
  SmoothResult result;

  // The figures, runs and notes of the next window; its text is the caller's.
  void take(WindowDone window);

  // Behind the last window.
  void finish();

 private:
  BandNoteTally notes_;
  std::optional<gcode::Diagnostic> untold_;
  gcode::Diagnostics form_notes_;
};

}  // namespace batten::postproc
