// Chains of G01 with unchanged state become runs; everything else is copied, with a reason.
#pragma once

#include <string_view>
#include <vector>

#include "gcode/motion.h"
#include "gcode/program.h"
#include "postproc/section.h"

namespace batten::postproc {

struct GroupingOptions {
  std::size_t min_motions = 3;            // shorter chains are copied: too-short
  std::vector<std::string_view> allowed;  // reason ids lifted by --allow
};

// Sections in the order of the program; together they cover every block once. A Verbatim
// section holds neighbouring blocks that are kept for one reason; blocks without motion and
// without words (empty lines, comments) go with the section before them.
//
// Requires: `interpretation` belongs to `program`.
[[nodiscard]] std::vector<Section> group_runs(const gcode::Program& program,
                                              const gcode::Interpretation& interpretation,
                                              const GroupingOptions& options);

// Why no motion may be rewritten in this state; empty where it may. The rows of the table
// of unsafe states.
[[nodiscard]] std::string_view unsafe_state(const gcode::ModalState& state,
                                            const GroupingOptions& options);

}  // namespace batten::postproc
