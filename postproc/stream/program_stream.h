// One of two long programs that are compared part by part: what of it is held, and where a part may
// end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gcode/reading/part_reading.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "geometry/basic/point.h"
#include "postproc/proof/program_events.h"
#include "postproc/stream/chunk_reader.h"

namespace batten::postproc {

// A part that is compared, with what it takes over.
struct FollowedPart {
  gcode::ReadPart part;
  EventsBefore before;
  std::uint32_t line_before = 0;

  [[nodiscard]] ReadProgram read() const {
    return {&part.program, &part.meaning, before, {}, line_before};
  }
};

class ProgramStream {
 public:
  ProgramStream(const gcode::SourceText& source, const PartReading& reading,
                const PartLimits& limits)
      : reader_(source, reading, limits) {}

  // False: it needs the whole.
  [[nodiscard]] bool read_on();
  [[nodiscard]] bool at_end() const { return at_end_; }

  [[nodiscard]] const gcode::ReadPart& held() const { return reader_.held(); }
  [[nodiscard]] std::size_t blocks_held() const { return reader_.blocks_held(); }
  // Blocks behind plain rapids, of those that are held.
  [[nodiscard]] const std::vector<std::uint32_t>& ends() const { return ends_; }
  // mm, of the motions behind the last of these, or since the begin of what is held.
  [[nodiscard]] double way() const { return way_; }

  // The first blocks that are held.
  [[nodiscard]] FollowedPart take(std::uint32_t count);
  [[nodiscard]] std::optional<gcode::Diagnostics> finish() { return reader_.finish(); }

 private:
  void look_at_new_blocks();

  PartReader reader_;
  EventsBefore before_;
  std::uint32_t line_before_ = 0;
  std::vector<std::uint32_t> ends_;
  std::uint32_t looked_at_ = 0;  // blocks that are held
  double way_ = 0;
  bool at_end_ = false;
};

// mm
[[nodiscard]] double way_of(const gcode::Motion& motion);

// Where two long runs that go beside each other may be cut: the last place at which a motion of
// each ends, the same to the last digit, as far along both to within a tenth. Blocks behind these
// motions.
struct CommonPlace {
  std::uint32_t old_end = 0;
  std::uint32_t new_end = 0;
};
[[nodiscard]] std::optional<CommonPlace> last_common_place(const gcode::Interpretation& before,
                                                           const gcode::Interpretation& after);

}  // namespace batten::postproc
