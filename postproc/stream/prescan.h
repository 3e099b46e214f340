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
#include "postproc/runs/run_cutting.h"
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
  ReadingPlace from;  // some blocks before it: reading from there gives what is known at `begin`
  std::uint32_t begin = 0;  // bytes
  std::uint32_t end = 0;
  bool begins_in_run = false;  // at a cut of a long run (postproc/runs/run_cutting.h)
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
  bool has_m6 = false;  // of a tool change
};

struct WindowLimits {
  // A window ends after rapids once it has so many blocks: as many runs as keep all threads busy,
  // and a small part of the memory that a program may take, about 1 KB a block.
  std::size_t least_blocks = 16384;
  LongRunLimits long_runs = {};
};

// A window ends after the last of some plain rapids and what says nothing after it, where it has
// `least_blocks` or more: no run, no section between two events and no section of copied blocks
// goes on from one window to the next. And it ends where a long run is cut, unless no method is
// asked for.
//
// Only as a whole: programs for lathes, programs that are not understood or that the target takes
// otherwise than the reader, with jumps, loops or subprograms, with words outside the % marks, with
// variables that are assigned and used, with words of another family, with curves that the target's
// reader follows, with lines of more than 1 MiB or without line feeds, and without any possible
// cut.
//
// Holds a bounded number of blocks. Reads text, meaning and cuts in parallel where options.threads
// allows it. `tell` gets the share of the bytes that was seen, from one thread after the other.
[[nodiscard]] PrescanReport prescan(const gcode::SourceText& source, const SmoothOptions& options,
                                    const WindowLimits& limits, const ProgressCallback& tell);

}  // namespace batten::postproc
