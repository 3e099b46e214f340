// What the report says of each run of a program, and what a user has to be told of the curves in
// it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/run_state.h"
#include "postproc/smooth/selection/method_times.h"

namespace batten::postproc {

enum class RunStatus { kRewritten, kKept };

// One run of the report. Also verbatim chains of cutting moves appear, kept, with their reason.
struct RunReport {
  std::uint32_t first_line = 0;
  std::uint32_t last_line = 0;
  std::size_t points = 0;
  RunStatus status = RunStatus::kKept;
  std::string_view reason;          // why it was kept; empty when rewritten
  std::string_view method;          // that made what stands there now; empty where it was kept
  std::vector<MethodTime> methods;  // all that were tried, whether it was rewritten or not
  OutputForm form = OutputForm::kLines;
  std::size_t blocks_in = 0;
  std::size_t blocks_out = 0;
  double deviation_mm = 0;  // proved bound
  bool proved = false;
  bool chords_for_steps = false;  // see plan_lines
  double noise_mm = 0;
  double max_curvature_before = 0;  // 1/mm, circle through three neighbouring vertices
  double max_curvature_after = 0;
  double time_before_s = 0;
  double time_after_s = 0;
};

// What became of the sections of a program; `works` in their order, `stretches` of the proof.
struct RunsDone {
  const gcode::Program& program;
  const gcode::Interpretation& meaning;
  std::span<const Section> sections;
  std::span<const RunState> works;
  std::span<const CutRun> cut_runs;
  std::span<const Stretch> stretches;
  bool proved = false;
};

// In the order of the program. Linear in sections and stretches.
[[nodiscard]] std::vector<RunReport> report_runs(const RunsDone& done);

}  // namespace batten::postproc
