#include "postproc/stream/collected_result.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace batten::postproc {

void CollectedResult::take(WindowDone window) {
  notes_.add(window.notes, result.diagnostics);
  result.blocks_out += window.blocks;
  result.added_lines += window.added_lines;
  result.corner_mm = std::max(result.corner_mm, window.corner_mm);
  if (window.deviation_mm > result.deviation_mm) {
    result.deviation_mm = window.deviation_mm;
    result.deviation_line = window.deviation_line;
  }
  if (!untold_) untold_ = std::move(window.untold);
  for (gcode::Diagnostic& note : window.form_notes) {  // one of each is enough
    if (std::ranges::find(form_notes_, note.id, &gcode::Diagnostic::id) == form_notes_.end()) {
      form_notes_.push_back(std::move(note));
    }
  }
  for (RunReport& run : window.runs) {
    result.time_before_s += run.time_before_s;
    result.time_after_s += run.time_after_s;
    result.runs.push_back(std::move(run));
  }
}

void CollectedResult::finish() {
  notes_.tell_rest(result.diagnostics);
  if (untold_) result.diagnostics.push_back(std::move(*untold_));
  std::ranges::move(form_notes_, std::back_inserter(result.diagnostics));
  result.understood = true;
}

}  // namespace batten::postproc
