// What a long program is made of, found part by part: the sections and messages of the whole
// (postproc/stream/inspect.h), in the memory of some parts.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/stream/chunk_reader.h"
#include "postproc/stream/inspect.h"

namespace batten::postproc {

struct InspectedProgram {
  std::vector<InspectedSection> sections;
  gcode::Diagnostics found;
  std::size_t blocks = 0;
  bool unit_word_seen = false;
};

struct InspectLimits {
  PartLimits parts = {};
  std::size_t longest = 4096;  // blocks without a rapid that are held before a chain is cut
};

// Sections end behind plain rapids (postproc/proof/program_events.h), where something other than a
// rapid follows: there no chain and no section goes on. A long chain of lines is cut between two
// motions, with some more on both sides that go neither straight along Z nor nowhere: both pieces
// end there as runs, and are counted as one. A chain with arcs is held as one: which of them were
// meant is known at its end.
//
// Nothing where the program needs the whole (PartReader).
[[nodiscard]] std::optional<InspectedProgram> inspect_in_parts(const gcode::SourceText& source,
                                                               const PartReading& reading,
                                                               const GroupingOptions& grouping,
                                                               const InspectLimits& limits = {});

}  // namespace batten::postproc
