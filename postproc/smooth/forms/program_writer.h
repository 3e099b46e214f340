// Planned moves to text, in the words of the target.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/program.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {

struct RunText {
  std::string text;        // whole lines, with line ends
  std::size_t blocks = 0;  // those of comments among them
  std::size_t arcs = 0;
  std::vector<TimedPiece> moves;  // as the printed numbers say, but curves, which are as planned
};

// The run's blocks. `before` is the state after the last block before the run (the position is the
// run's first point), `after` the state in which the copied block after it must find the control:
// where plane, motion word or feed differ at the end of the run, one block restores them; what
// `after` does not know is left unchanged.
//
// The run's first and last point are met exactly: the last move is printed with as many decimals as
// the run was. Comments are copied: one of a block behind the line or arc that ends there, others,
// and those inside a curve after it, each on a line of its own.
//
// Nothing when a curve is planned that the target cannot say, when arcs are planned and it is not
// known how their centres are to be given, when a line would be too long, or when the last point
// has more decimals than can be printed. An arc that the control refuses once it is printed is
// written as chords.
[[nodiscard]] std::optional<RunText> write_run(const OutputPlan& plan, const Run& run,
                                               const gcode::Program& program,
                                               const gcode::Control& target,
                                               gcode::ModalState before,
                                               const gcode::ModalState& after,
                                               std::string_view line_end);

}  // namespace batten::postproc
