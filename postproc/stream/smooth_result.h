// What smoothing a program gives, and how it tells what is done so far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gcode/state/modal_state.h"
#include "gcode/text/diagnostic.h"
#include "postproc/stream/run_report.h"

namespace batten::postproc {

struct SmoothResult {
  std::string text;  // the new program; the input's bytes where nothing was rewritten
  std::vector<RunReport> runs;
  gcode::Diagnostics diagnostics;
  bool understood = false;  // false: nothing may be rewritten (no units ..): exit code 2
  gcode::Units units = gcode::Units::kUnknown;
  std::size_t blocks_in = 0;
  std::size_t blocks_out = 0;
  std::size_t added_lines = 0;  // words of the profile
  double deviation_mm = 0;
  std::uint32_t deviation_line = 0;
  double corner_mm = 0;      // band reading: greatest distance of a corner that was cut
  double time_before_s = 0;  // cutting runs only
  double time_after_s = 0;
  bool proved = false;  // of the whole text
  // Of a text that was handed on window by window (postproc/stream/windows.h), in place of `text`.
  std::size_t bytes_handed_on = 0;
  [[nodiscard]] std::size_t bytes_out() const { return text.size() + bytes_handed_on; }
};

// Called now and then with the part that is done, 0..1. Returning false stops the work: the
// result then is not understood and carries no text.
using Progress = std::function<bool(double)>;

}  // namespace batten::postproc
