// What of a program is smoothed and proved at once: the whole, or a window of a long one.
#pragma once

#include <optional>

#include "gcode/motion.h"
#include "gcode/part_reading.h"
#include "gcode/program.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {

// What a window takes over from the windows before it in one of the two texts.
struct TextBefore {
  gcode::ControlCarry control;
  EventsBefore events = {};
};

struct WindowStart {
  EventsBefore old_events;
  TextBefore new_text;
  bool words_seen = false;  // gcode::TextCarry
  gcode::DecimalPoints decimals;
  bool same_as_old = false;  // all that is known of the new text is what is known of the old one
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
