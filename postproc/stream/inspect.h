// What a program is made of, before anything is rewritten: its runs with the statistics of their
// segments, and why the rest would be kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "postproc/runs/section.h"
#include "postproc/runs/segment_tally.h"

namespace batten::postproc {

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

// The same of a program that is read part by part. Holds the sections, and the lengths of the
// segments of the run that goes on.
class Inspection {
 public:
  // The sections of the next blocks. `goes_on`: the last run so far goes on in the first of them,
  // which is a run from its first block on; their lines are those of one chain.
  void add(const gcode::Program& part, const gcode::Interpretation& meaning,
           const std::vector<Section>& sections, bool goes_on);

  // As many as were added, each as it would be if the program ended here.
  [[nodiscard]] std::size_t size() const { return sections_.size(); }
  // Takes the sections behind the first `size` away again. None of those that stay goes on.
  void go_back_to(std::size_t size);

  // All sections.
  [[nodiscard]] std::vector<InspectedSection> take();

 private:
  void add_run(const gcode::Program& part, const gcode::Interpretation& meaning,
               const Section& section);
  void begin_run(const Run& run);
  void end_run();

  std::vector<InspectedSection> sections_;
  // Of the last section, where it is a run that may go on.
  bool in_run_ = false;
  SegmentTally tally_;
  geometry::Point3 start_ = geometry::Point3::Zero();
  std::uint32_t turn_line_ = 0;
};

}  // namespace batten::postproc
