// Arcs of a program that the target may take for nothing, or for a full turn.
#pragma once

#include "gcode/control/control.h"
#include "gcode/reading/part_reading.h"
#include "gcode/text/diagnostic.h"

namespace batten::postproc {

// A note "arc-misread" for the first of them, which names the lines of some others; nothing where
// there is none. None of them is one of Batten's own: those are kept far from that
// (gcode::arc_refusal). Linear cost.
[[nodiscard]] gcode::Diagnostics note_misread_arcs(const gcode::Program& program,
                                                   const gcode::Interpretation& meaning,
                                                   const gcode::Control& target);

}  // namespace batten::postproc
