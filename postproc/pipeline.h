// The whole of `batten smooth` but files and messages: text in, proved text out.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/diagnostic.h"
#include "gcode/source_text.h"
#include "postproc/method_times.h"
#include "postproc/options.h"
#include "postproc/output_plan.h"
#include "postproc/verification.h"

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
  double noise_mm = 0;
  double max_curvature_before = 0;  // 1/mm, circle through three neighbouring vertices
  double max_curvature_after = 0;
  double time_before_s = 0;
  double time_after_s = 0;
};

struct SmoothResult {
  std::string text;  // the new program; the input's bytes where nothing was rewritten
  std::vector<RunReport> runs;
  gcode::Diagnostics diagnostics;
  bool understood = false;  // false: nothing may be rewritten (no units ..): exit code 2
  gcode::Units units = gcode::Units::kUnknown;
  std::size_t blocks_in = 0;
  std::size_t blocks_out = 0;
  std::size_t added_lines = 0;  // words of the profile
  double deviation_mm = 0;
  std::uint32_t deviation_line = 0;
  double corner_mm = 0;      // band reading: greatest distance of a corner that was cut
  double time_before_s = 0;  // cutting runs only
  double time_after_s = 0;
  bool proved = false;  // of the whole text
};

// Called now and then with the part that is done, 0..1. Returning false stops the work: the
// result then is not understood and carries no text.
using Progress = std::function<bool(double)>;

[[nodiscard]] SmoothResult smooth_program(const gcode::SourceText& source,
                                          const SmoothOptions& options,
                                          const Progress& progress = {});

}  // namespace batten::postproc
