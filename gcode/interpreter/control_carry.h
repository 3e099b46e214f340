// What the control knows between two parts of a program that is read part by part
// (gcode/reading/part_reading.h).
#pragma once

#include "gcode/state/control_state.h"
#include "gcode/state/diagnostic_limiter.h"
#include "gcode/state/lathe_marks.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// What the control knows where the next part begins.
struct ControlCarry {
  explicit ControlCarry(Units units) : unit_word_seen(units != Units::kUnknown) {
    state.modal.units = units;
  }
  ControlState state;
  bool unit_word_seen;
  bool is_klartext = false;  // such programs are read as a whole
  bool any_motion = false;
  SourceSpan first_motion;   // its block
  bool reaches_out = false;  // a part was not for itself (gcode/reading/part_reading.h)
  LatheWatch lathe;          // of all parts so far
  DiagnosticLimiter told;
};

}  // namespace batten::gcode
