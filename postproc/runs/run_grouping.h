// Chains of G01, and of G02 and G03 that are pieces of a curve, with unchanged state become runs;
// everything else is copied, with a reason.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

struct GroupingOptions {
  std::size_t min_motions = 3;            // chains of fewer motions with a length: too-short
  double tolerance_mm = 0.01;             // the user's: tells pieces of a curve from arcs that were
                                          // meant, and how finely runs follow their arcs
  std::vector<std::string_view> allowed;  // reason ids lifted by --allow
};

// Sections in the order of the program; together they cover every block once. A Verbatim
// section holds neighbouring blocks that are kept for one reason; blocks that say nothing
// (empty lines, comments) go with the Verbatim section before them, behind a run with the one
// after them. A run is not longer than its motions: what stands around it is copied. Which arcs are
// kept: postproc/runs/intended_arcs.h.
//
// `cuts`: blocks that begin a section of their own, increasing: what stands before them is grouped
// as if the program ended there, and what follows as if it began.
//
// Requires: `interpretation` belongs to `program`.
[[nodiscard]] std::vector<Section> group_runs(const gcode::Program& program,
                                              const gcode::Interpretation& interpretation,
                                              const GroupingOptions& options,
                                              std::span<const std::uint32_t> cuts = {});

// Why no motion may be rewritten in this state; empty where it may: one row per unsafe state.
// G61 (exact path) is lifted by --allow exact-stop; G61.1 and G60 are not, their user asked for
// the stops. --allow control-smoothing lifts that state. Ask with the state after the motion's
// block, which is the one it moves in.
[[nodiscard]] std::string_view unsafe_state(const gcode::ModalState& state,
                                            const GroupingOptions& options);

}  // namespace batten::postproc
