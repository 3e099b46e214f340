// A light pass over a long program, part by part: what only the whole of it can say, and where it
// may be cut into windows that are smoothed one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gcode/diagnostic.h"
#include "gcode/modal_state.h"
#include "gcode/source_text.h"
#include "postproc/options.h"
#include "postproc/runs/part_runs.h"

namespace batten::postproc {

enum class Scouting {
  kWindows,  // the program may be smoothed in windows
  kWhole,    // only as a whole: see below
  kStopped,
};

struct ScoutReport {
  Scouting outcome = Scouting::kWhole;
  // Bytes behind the windows, the last one behind the program.
  std::vector<std::uint32_t> ends;
  gcode::Diagnostics found;  // as reading the whole tells
  std::size_t blocks = 0;
  gcode::Units units = gcode::Units::kUnknown;  // the first that are known
  bool was_smoothed = false;
};

// A window ends behind the last of some plain rapids and what says nothing behind it, where it has
// `least_blocks` or more: no run, no stretch between two events and no section of copied blocks
// goes on from one window to the next.
//
// Only as a whole: programs that are not understood or that the target takes otherwise than the
// reader, with jumps, loops or subprograms, with words outside the % marks, with words of another
// family, with curves that the target's reader follows, with lines of more than 1 MiB or without
// line feeds, and without any place for a cut.
//
// Holds a bounded number of blocks. `tell` is told the share of the bytes that was seen.
[[nodiscard]] ScoutReport scout(const gcode::SourceText& source, const SmoothOptions& options,
                                std::size_t least_blocks, const Tell& tell);

}  // namespace batten::postproc
