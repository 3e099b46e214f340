// A result as `batten smooth` could have made it, for the tests of the reports.
#pragma once

#include "gcode/controls/built_in.h"
#include "gcode/state/reason.h"
#include "postproc/report/smooth_report.h"

namespace batten::postproc {

// Two runs rewritten in lines and arcs, three kept: two too short (2 + 3 blocks), one in exact
// stop (10 blocks).
inline SmoothResult five_runs() {
  SmoothResult result;
  result.text = "G21\nG1 X1\n";
  result.bytes_out = result.text.size();
  result.understood = true;
  result.proved = true;
  result.units = gcode::Units::kMillimetre;
  result.blocks_in = 200;
  result.blocks_out = 50;
  result.deviation_mm = 0.0098;
  result.deviation_line = 120;
  result.runs_before_s = result.runs_after_s = 3.0;
  result.program_before = {4.0, 3.0, 1.5};
  result.program_after = {2.0, 1.0, 0.125};
  RunReport lines;
  lines.first_line = 10;
  lines.last_line = 109;
  lines.points = 101;
  lines.status = RunStatus::kRewritten;
  lines.method = "fair";
  lines.blocks_in = 100;
  lines.blocks_out = 20;
  lines.deviation_mm = 0.0098;
  lines.proved = true;
  RunReport arcs = lines;
  arcs.first_line = 120;
  arcs.last_line = 180;
  arcs.form = Form::kArcs;
  RunReport short_run;
  short_run.first_line = 182;
  short_run.last_line = 183;
  short_run.blocks_in = 2;
  short_run.reason = gcode::reason::kTooShort;
  RunReport other_short_run = short_run;
  other_short_run.blocks_in = 3;
  RunReport stop = short_run;
  stop.blocks_in = 10;
  stop.reason = gcode::reason::kExactStop;
  result.runs = {lines, short_run, arcs, other_short_run, stop};
  result.kept.any_run = true;
  result.kept.all = {.moves = 175, .length_mm = 100};
  result.kept.causes.resize(2);
  result.kept.causes[0] = {.reason = gcode::reason::kExactStop,
                           .line = 181,
                           .first_line = 182,
                           .text = "G61",
                           .times = 2,
                           .cut = {.moves = 10, .length_mm = 20}};
  result.kept.causes[1] = {.reason = gcode::reason::kTooShort,
                           .first_line = 182,
                           .text = "G1 X5",
                           .times = 1,
                           .cut = {.moves = 5, .length_mm = 1.5}};
  return result;
}

inline SmoothOptions linuxcnc_options() {
  SmoothOptions options;
  options.target = gcode::find_control("linuxcnc");
  options.machine = find_machine("linuxcnc");
  return options;
}

}  // namespace batten::postproc
