// What a program is made of, before anything is rewritten: its runs with the statistics of their
// segments, and why the rest would be kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/reading/part_reading.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/runs/kept_causes.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/stream/part_reader.h"

namespace batten::postproc {

struct SegmentStatistics {
  std::size_t count = 0;
  double shortest = 0;           // mm
  double median = 0;             // mm
  double longest = 0;            // mm
  double length = 0;             // mm, of the whole run
  double greatest_turn_deg = 0;  // at the vertices between the segments
  std::uint32_t turn_line = 0;   // line of the block that ends at that vertex; 0: no turn
};

// One section of the program; a run when `reason` is empty.
struct InspectedSection {
  std::uint32_t first_line = 0;
  std::uint32_t last_line = 0;
  std::size_t blocks = 0;
  std::size_t cutting_moves = 0;  // G1, G2, G3 in it
  std::string_view reason;        // why it would be kept
  bool closed = false;
  int decimals = 0;
  double least_feed = 0;     // mm/min
  double greatest_feed = 0;  // mm/min
  SegmentStatistics segments;
};

// Of a program that is held anyway.
[[nodiscard]] std::vector<InspectedSection> inspect(const gcode::ReadPart& program,
                                                    const GroupingOptions& grouping);

struct InspectedProgram {
  std::vector<InspectedSection> sections;
  KeptCauses kept;
  gcode::Diagnostics found;
  std::size_t blocks = 0;
  bool unit_word_seen = false;
  bool as_whole = false;  // the parts were not enough
};

struct InspectLimits {
  PartLimits parts = {};
  std::size_t longest = 4096;  // blocks without a rapid that are held before a chain is cut
};

// Reads a long program part by part and holds its sections, some parts, and the lengths of the
// segments of the run that goes on.
//
// Parts end after plain rapids (postproc/proof/program_events.h), where something other than a
// rapid follows: there no chain and no section goes on. A long chain of lines is cut between two
// motions, with some more on both sides that go neither straight along Z nor nowhere: both parts
// end there as runs, and count as one. A chain with arcs is held as one: which of them are intended
// is known at its end. `target`: the note of note_misread_arcs is among what was found.
// A program that is short or needs the whole (PartReader) is one part.
[[nodiscard]] InspectedProgram inspect(const gcode::SourceText& source, const PartReading& reading,
                                       const GroupingOptions& grouping,
                                       const InspectLimits& limits = {},
                                       const gcode::Control* target = nullptr);

}  // namespace batten::postproc
