// What a program is made of, before anything is rewritten: its runs with the statistics of their
// segments, and why the rest would be kept.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "gcode/motion.h"
#include "gcode/program.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

struct SegmentStatistics {
  std::size_t count = 0;
  double shortest = 0;           // mm
  double median = 0;             // mm
  double longest = 0;            // mm
  double length = 0;             // mm, of the whole run
  double greatest_turn_deg = 0;  // at the vertices between the segments
  std::size_t turn_motion = 0;   // of the run, from 1, that ends at that vertex; 0: no turn
  std::uint32_t turn_line = 0;   // line of its block; 0: no turn, or not asked for
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

[[nodiscard]] std::vector<InspectedSection> inspect(const gcode::Program& program,
                                                    const gcode::Interpretation& interpretation,
                                                    const std::vector<Section>& sections);

// Of the run's motions. Their lines are not known here: `turn_line` is 0.
[[nodiscard]] SegmentStatistics segment_statistics(const Run& run);

}  // namespace batten::postproc
