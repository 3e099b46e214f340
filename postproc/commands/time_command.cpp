#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/machine/program_time/program_time.h"
#include "postproc/machine/program_time/program_time_blocks.h"
#include "postproc/machine/program_time/program_time_profile.h"
#include "postproc/report/html_report.h"
#include "postproc/report/time_report.h"
#include "postproc/stream/time_bounds.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"

namespace batten::postproc {
namespace {

constexpr double kProfilePeriod = 0.001;  // s

// Bytes that are collected before they are written: enough for a disk to be quick.
constexpr std::size_t kPartSize = std::size_t{1} << 16;

constexpr std::string_view kProfileHead =
    "t_s,line,x_mm,y_mm,z_mm,feed_mm_per_min,ax_mm_per_s2,ay_mm_per_s2,az_mm_per_s2,"
    "jx_mm_per_s3,jy_mm_per_s3,jz_mm_per_s3\n";

void append_row(const ProfileSample& s, std::string& text) {
  fmt::format_to(
      std::back_inserter(text),
      "{:.3f},{},{:.6f},{:.6f},{:.6f},{:.3f},{:.3f},{:.3f},{:.3f},{:.1f},{:.1f},{:.1f}\n", s.time,
      s.line, s.place.x(), s.place.y(), s.place.z(), s.feed, s.acceleration.x(), s.acceleration.y(),
      s.acceleration.z(), s.jerk.x(), s.jerk.y(), s.jerk.z());
}

int write_profile(const TimeCommand& command, const ProgramSteps& steps) {
  const auto parts = [&](const PartWriter& write) {
    std::string text(kProfileHead);
    const auto take = [&](const ProfileSample& sample) {
      append_row(sample, text);
      if (text.size() < kPartSize) return true;
      const bool written = write(text);
      text.clear();
      return written;
    };
    if (sample_program(steps, *command.machine, kProfilePeriod, take, command.planner)) {
      (void)write(text);
    }
  };
  return write({.target = command.profile_file, .replace_existing = command.force, .parts = parts});
}

int write_time_page(const TimeCommand& command, const TimeReport& report,
                    const gcode::Interpretation& meaning, const Json& json) {
  if (!command.page.is_wanted()) return 0;
  std::vector<PageLines> rows;
  for (const SlowPlace& slow : report.time.slowest)
    rows.push_back({slow.first_line, slow.last_line});
  std::ranges::sort(rows, {}, &PageLines::first_line);
  const PageOf page{"time", json, report.program.source.name(), command.command_line, rows};
  return write_page(command.page, command.force, command.input,
                    html_report(page, {&report.program, &meaning}, command.machine.get()));
}

}  // namespace

int run(const TimeCommand& command) {
  if (!may_write_reports(command) || !may_be_written(command.profile_file, command.force)) {
    return static_cast<int>(ExitCode::kFileError);
  }
  const WatchedFile watched(command.input);
  const auto source = read_program(command.input);
  if (interrupted()) return end_interrupted();
  if (!source) return static_cast<int>(ExitCode::kFileError);

  const auto of_target = command.target != nullptr ? std::optional(command.target->language)
                                                   : std::optional<gcode::Language>();
  PartReading reading = reading_of(*source, command, command.source, of_target);
  gcode::Diagnostics found = reading.of_language;
  if (gcode::has_error(found)) {
    print(found, *source, command.log_level);
    return static_cast<int>(ExitCode::kNotUnderstood);
  }
  const CalledFiles called = read_called_files(*source, command.input, reading.text);
  reading.options.subprograms = called.programs;
  const auto [program, meaning] = read_whole(*source, reading, found);
  if (changed_while_read(watched) || changed_while_read(called))
    return static_cast<int>(ExitCode::kFileError);
  print(found, *source, command.log_level, command.command_line);
  if (gcode::has_error(found)) return static_cast<int>(ExitCode::kNotUnderstood);

  const StepOptions options = {.dwell_unit = dwell_unit_of(command.target, *command.machine),
                               .start = command.start,
                               .feed_override = command.feed_override};
  const ProgramTime time =
      time_program(program, meaning, *command.machine, options, command.planner);
  std::optional<TimeBounds> bounds;
  if (command.bound) bounds = time_bounds(program, meaning, *command.machine, command.tolerance_mm);
  const TimeReport report{program, *command.machine,  time,
                          found,   command.own_words, called.files,
                          bounds,  command.planner,   command.feed_override};
  const bool standard_output_taken =
      command.json_file == "-" || command.profile_file == "-" || command.page.file == "-";
  if (!standard_output_taken) {
    if (const int code = write_result("-", time_text(report), false); code != 0) return code;
  }
  int code = 0;
  if (!command.json_file.empty() || command.page.is_wanted()) {
    const Json json = time_json(report);
    write_report(command.json_file, command.force, [&] { return json_text(json); });
    code = write_time_page(command, report, meaning, json);
  }
  if (code != 0) return code;
  if (!command.profile_file.empty())
    return write_profile(command, read_steps(program, meaning, options));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace batten::postproc
