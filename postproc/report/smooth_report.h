// The reports of `batten smooth`, for people and for programs: the result, what was asked for, and
// the files.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/stream/called_files.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

// What smoothing would have given had the user lifted a rule that keeps much.
struct LiftedRule {
  std::string_view id;
  SmoothResult result;
};

// The rule, of those that the user may lift and has not, that keeps the greatest share of the
// cutting moves, where that is much. Empty: none does.
[[nodiscard]] std::string_view rule_worth_lifting(const SmoothResult& result);

struct SmoothReport {
  const gcode::SourceText& source;  // its name stands for the input file
  const SmoothOptions& options;
  const SmoothResult& result;
  std::string output_file;  // as the user knows it; empty: nothing is written
  bool strict = false;
  // Options that the command line did not give, and where they come from: a file, or what the
  // program says.
  std::vector<std::pair<std::string, std::string>> origins = {};
  // Names of words that the user dropped, and how many there were: `source` is without them.
  std::vector<std::string> drop = {};
  std::size_t dropped = 0;
  std::vector<CalledFile> called = {};  // programs that it calls
  const LiftedRule* lifted = nullptr;   // for the summary
};

// The report for programs: one JSON object, its fields always in the same order, the same bytes for
// the same input and options (threads do not show).
//
//   batten, options, input, output, stated_tolerances[], runs[], reasons[], kept
//   (report/kept_report.h), deviation_mm, deviation_line, time_before_s, time_after_s (as `batten
//   time` predicts them), cutting_before_s, cutting_after_s, slow_share_before, slow_share_after
//   (of the cutting time: below half of the programmed feed), path_before, path_after {length_mm,
//   distance_mm, roughness}, proved, understood, diagnostics[], options_from {option: file} of what
//   the command line did not give; profile, dropped {names[], words} and called[] {call, file,
//   why_not} where there are any
//
// Bytes of names and messages that are not UTF-8 become U+FFFD; numbers that are not finite
// become null.
[[nodiscard]] Json smooth_json(const SmoothReport& report);
[[nodiscard]] std::string json_report(const SmoothReport& report);

// The report for people: some lines that a machinist understands.
//
//   part.nc -> part.smooth.nc, for linuxcnc
//     blocks        1785 -> 158    (-91 %)
//     bytes         41620 -> 4105  (-90 %)
//     distance      0.0031 -> 0.0004 mm  (rms, from the path that was meant, -87 %)
//     roughness     0.248 -> 0.001  (turns at joints, rad/sqrt(mm), -100 %)
//     runs          1 rewritten, 2 kept
//                   kept: 2 runs, 9 blocks: too-short: ...
//     time          3.96 s -> 2.49 s  (machine linuxcnc, -37.1 %)
//     slow          81.2 -> 3.4 % of the cutting time is below half of the programmed feed
//     deviation     at most 0.0098 mm, near line 120; allowed 0.0100 mm
//     proof         the written text was read again: every rewritten run keeps the tolerance
[[nodiscard]] std::string summary_text(const SmoothReport& report);

// "machine, target: from FILE", one for each origin, of options and where they come from.
[[nodiscard]] std::vector<std::string> texts_of_origins(
    std::span<const std::pair<std::string, std::string>> origins);

// ": 3 % less time, 84 % fewer blocks, 20 % farther from the path, 50 % smoother": what changes by
// half a percent or more of time, blocks, distance, roughness (or the first of these), in order.
[[nodiscard]] std::string changes_text(std::span<const double> before,
                                       std::span<const double> after);

}  // namespace batten::postproc
