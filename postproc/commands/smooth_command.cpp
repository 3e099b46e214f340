#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "gcode/reason.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/exit_code.h"
#include "postproc/interrupt.h"
#include "postproc/output_file.h"
#include "postproc/report/html_report.h"
#include "postproc/report/json_report.h"
#include "postproc/report/summary_text.h"

namespace batten::postproc {

namespace {

std::string output_of(const SmoothCommand& command) {
  if (command.in_place) return command.input;
  if (!command.output.empty()) return command.output;
  if (command.input == "-") return "-";
  return default_output_path(command.input).string();
}

// A long computation should not end with "exists already".
bool would_be_refused(const std::string& file, bool replace_existing) {
  std::error_code error;
  if (file.empty() || file == "-" || replace_existing) return false;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  say(file + ": exists already and was left as it is; --force replaces it");
  return true;
}

bool has_unproved_run(const SmoothResult& result) {
  return std::ranges::any_of(result.runs, [](const RunReport& run) {
    return run.status == RunStatus::kKept && run.reason == gcode::reason::kNotProved;
  });
}

// The progress line is gone when this returns.
SmoothResult smooth_with_progress(const gcode::SourceText& source, const SmoothCommand& command) {
  const Progress progress = show_progress(command.progress);
  SmoothResult result = smooth_program(source, command.options, progress);
  (void)progress(1);
  return result;
}

// What the result means before anything is written.
ExitCode judge(const SmoothCommand& command, const gcode::SourceText& source,
               const SmoothResult& result) {
  if (!result.understood) return ExitCode::kNotUnderstood;
  // The same bytes need no proof: programs with words that cannot be followed come out as they
  // were.
  const bool proved = result.proved || result.text == source.text();
  if (!proved || (command.strict && has_unproved_run(result))) return ExitCode::kNotProved;
  return ExitCode::kDone;
}

std::string complaint(const SmoothCommand& command, ExitCode verdict) {
  if (verdict == ExitCode::kNotUnderstood) {
    return "the program is not understood well enough to be rewritten; nothing was written";
  }
  return command.strict ? "--strict: not every run could be proved; nothing was written"
                        : "the new program could not be proved; nothing was written";
}

}  // namespace

int run(const SmoothCommand& command) {
  const std::string output = output_of(command);
  const bool replaces_program = command.force || command.in_place;
  if ((!command.dry_run && would_be_refused(output, replaces_program)) ||
      would_be_refused(command.json_file, command.force) ||
      would_be_refused(command.report_file, command.force)) {
    return static_cast<int>(ExitCode::kFileError);
  }
  const auto source = read_program(command.input);
  if (interrupted()) return interrupt_exit_code();
  if (!source) return static_cast<int>(ExitCode::kFileError);

  const SmoothResult result = smooth_with_progress(*source, command);
  if (interrupted()) {
    say("interrupted; nothing was written");
    return interrupt_exit_code();
  }
  print(result.diagnostics, *source);

  const ExitCode verdict = judge(command, *source, result);
  const bool writes = verdict == ExitCode::kDone && !command.dry_run;
  const SmoothReport report = {
      .source = *source,
      .options = command.options,
      .result = result,
      .output_file = writes ? output : "",
      .strict = command.strict,
  };
  int code = static_cast<int>(verdict);
  if (writes) code = write_result(output, result.text, replaces_program);
  if (result.understood) std::fputs(summary_text(report).c_str(), stderr);
  if (verdict != ExitCode::kDone) say(complaint(command, verdict));
  if (!command.json_file.empty() && !interrupted()) {
    const int json_code = write_result(command.json_file, json_report(report), command.force);
    if (code == 0) code = json_code;
  }
  if (!command.report_file.empty() && !interrupted()) {
    const std::string page = html_report(report, {.command = command.command_line});
    const int report_code = write_result(command.report_file, page, command.force);
    if (code == 0) code = report_code;
  }
  return code;
}

}  // namespace batten::postproc
