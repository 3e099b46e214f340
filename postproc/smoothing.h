// One run, smoothed: what could be written instead of it, and what each candidate costs.
#pragma once

#include <string_view>
#include <vector>

#include "gcode/modal_state.h"
#include "gcode/program.h"
#include "postproc/options.h"
#include "postproc/output_plan.h"
#include "postproc/program_writer.h"
#include "postproc/section.h"

namespace batten::postproc {

// Where a run stands.
struct RunContext {
  const gcode::Program& program;
  const gcode::ModalState& before;  // state after the block before the run
  const gcode::ModalState& after;   // state in which the block after the run must find the control
  std::string_view line_end;
  std::size_t blocks = 0;  // of the run, as they were
  std::size_t bytes = 0;
};

struct Candidate {
  std::string_view method;  // "fair"
  OutputForm form = OutputForm::kLines;
  RunText text;
  double error = 0;   // mm, the written form from the fair curve
  double time_s = 0;  // by the machine's model
};

// What is known of a run, whether it is rewritten or not.
struct RunFacts {
  double time_s = 0;
  double max_curvature = 0;   // 1/mm, circle through three neighbouring vertices
  double noise = 0;           // mm, rms distance of the vertices from the fair curve
  double error = 0;           // mm, how far the old path is from the one that was meant
  double fair_curvature = 0;  // 1/mm, greatest of the fair curve
};

struct SmoothedRun {
  RunFacts facts;
  std::vector<Candidate> candidates;  // none where `reason` says why
  std::string_view reason;
};

[[nodiscard]] SmoothedRun smooth_run(const Run& run, const RunContext& context,
                                     const SmoothOptions& options);

}  // namespace batten::postproc
