// Blocks that were not split into words: why they are kept, and what they may have changed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "gcode/state/block_words.h"
#include "gcode/state/control_state.h"
#include "gcode/state/diagnostic_limiter.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"

namespace batten::gcode {

[[nodiscard]] std::string_view opacity_reason(ParseStatus opacity);

// Forgets what a block with this text could have changed: nothing for program marks, jumps and
// plain variables, the place for parameters that are windows into the control, otherwise
// everything. Not for blocks that list all their words.
void apply_opaque(ParseStatus opacity, std::string_view text, ControlState& state);

// What is told of blocks that cannot be followed: at most one diagnostic per block, and not the
// same one a thousand times.

class BlockComplaints {
 public:
  // All must outlive it. `told`: of the whole program, `found`: where the diagnostics go.
  BlockComplaints(const Program& program, DiagnosticLimiter& told, Diagnostics& found)
      : program_(program), told_(told), found_(found) {}

  // What follows is about this block.
  void begin_block(std::uint32_t block);

  // Its words cannot be taken together. Of expressions nothing is told.
  void tell_words(const BlockWords& words);

  // A code that no control is known to have: once per code.
  void tell_unknown_code(Code code);

  // The whole block is at fault. `id`: of a warning (gcode/reading/explained_diagnostics.h).
  void tell(std::string_view id, std::string message);

 private:
  void tell(std::string_view id, SourceSpan where, std::string message);

  const Program& program_;
  DiagnosticLimiter& told_;
  Diagnostics& found_;
  std::uint32_t block_ = 0;
  bool block_told_ = false;  // it has its diagnostic
};

}  // namespace batten::gcode
