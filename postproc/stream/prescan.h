// A light pass over a long program, part by part: what only the whole of it can say, and where it
// may be cut into windows that are smoothed for themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gcode/state/modal_state.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/runs/long_run_cuts.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/part_reader.h"

namespace batten::postproc {

enum class PrescanOutcome {
  kWindows,  // the program may be smoothed in windows
  kWhole,    // only as a whole: see below
  kStopped,
};

struct WindowPlace {
  // Some blocks before the window: reading goes on from there, and gives what is known at `begin`.
  ReadingPlace from;
  std::uint32_t begin = 0;  // bytes
  std::uint32_t end = 0;
  bool begins_in_run = false;  // at a cut of a long run (postproc/runs/long_run_cuts.h)
  bool ends_in_run = false;
};

struct PrescanReport {
  PrescanOutcome outcome = PrescanOutcome::kWhole;
  std::vector<WindowPlace> windows;  // all of the program, in order; two or more
  gcode::Diagnostics found;          // as reading the whole tells
  std::vector<SelfProximity> near;   // of its long runs
  std::size_t blocks = 0;
  gcode::Units units = gcode::Units::kUnknown;  // the first that are known
  bool was_smoothed = false;
};

struct WindowLimits {
  // A window ends behind rapids once it has so many blocks.
  //
  // As many runs as keep all threads busy, and a small part of the memory that a program may take:
  // about 1 KB a block.
  std::size_t least_blocks = 16384;
  LongRunLimits long_runs = {};
};

// A window ends behind the last of some plain rapids and what says nothing behind it, where it has
// `least_blocks` or more: no run, no stretch between two events and no section of copied blocks
// goes on from one window to the next. And it ends where a long run is cut, but where no method is
// asked for: such runs are not cut.
//
// Only as a whole: programs for lathes, programs that are not understood or that the target takes
// otherwise than the reader, with jumps, loops or subprograms, with words outside the % marks, with
// words of another family, with curves that the target's reader follows, with lines of more than 1
// MiB or without line feeds, and without any place for a cut.
//
// Holds a bounded number of blocks. Reads text, meaning and cuts side by side where options.threads
// lets it. `tell` is told the share of the bytes that was seen, by one thread after the other.
[[nodiscard]] PrescanReport prescan(const gcode::SourceText& source, const SmoothOptions& options,
                                    const WindowLimits& limits, const ProgressCallback& tell);

}  // namespace batten::postproc
