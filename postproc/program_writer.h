// Planned moves to text, in the words of the target.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "gcode/dialect.h"
#include "gcode/modal_state.h"
#include "gcode/program.h"
#include "postproc/output_plan.h"
#include "postproc/section.h"

namespace batten::postproc {

struct RunText {
  std::string text;  // whole lines, with line ends
  std::size_t blocks = 0;
  std::size_t arcs = 0;
};

// The run's blocks. `before` is the state and place after the last block before the run,
// `after` the state in which the copied block after it must find the control.
// Nothing when the dialect refuses an arc that cannot be said as lines either, or when a line
// would be too long.
[[nodiscard]] std::optional<RunText> write_run(const OutputPlan& plan, const Run& run,
                                               const gcode::Program& program,
                                               const gcode::Dialect& target,
                                               const gcode::ModalState& before,
                                               const gcode::ModalState& after,
                                               std::string_view line_end);

}  // namespace batten::postproc
