// What the target would not run of the written text: its rules for arcs and lines, asked of the
// text when it is read again. Blocks of the old program are its own affair: they are copied.
#pragma once

#include <vector>

#include "gcode/control/control.h"
#include "postproc/proof/event_violations.h"
#include "postproc/proof/program_events.h"
#include "postproc/proof/section_comparison.h"

namespace batten::postproc {

// A violation for each arc of a stretch that was compared which the target refuses
// (gcode/controls/arc_rules.h), and for each line that is longer than the target reads.
[[nodiscard]] std::vector<Violation> refused_by_target(const ReadProgram& before,
                                                       const ReadProgram& after,
                                                       const std::vector<Stretch>& stretches,
                                                       const gcode::Control& target);

}  // namespace batten::postproc
