// What of a program is smoothed and proved at once: the whole, or a window of a long one.
#pragma once

#include <optional>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/part_reading.h"
#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {

// What a window takes over from the windows before it in one of the two texts.
struct TextBefore {
  gcode::ControlCarry control{gcode::Units::kUnknown};
  EventsBefore events = {};
};

struct WindowStart {
  EventsBefore old_events;
  TextBefore new_text;
  bool words_seen = false;  // gcode::TextCarry
  gcode::DecimalPoints decimals;
  bool same_as_old = false;  // all that is known of the new text is what is known of the old one
  // Where it begins, or ends, within a long run that is cut there: what is cut before and behind it
  // (postproc/runs/boundary_timing.h). Empty elsewhere.
  std::vector<TimedPiece> moves_before = {};
  std::vector<TimedPiece> moves_behind = {};
};

struct ProgramPart {
  gcode::Program program;
  gcode::Interpretation meaning;
  std::optional<WindowStart> window = {};  // nothing: the whole

  // The bytes of its blocks.
  [[nodiscard]] gcode::SourceSpan extent() const {
    if (program.blocks.empty()) return {};
    return {program.blocks.front().span.begin, program.blocks.back().end};
  }
};

}  // namespace batten::postproc
