#include <filesystem>
#include <string>
#include <system_error>

#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/exit_code.h"
#include "postproc/interrupt.h"
#include "postproc/output_file.h"
#include "postproc/report/html_report.h"
#include "postproc/report/json_report.h"
#include "postproc/report/summary_text.h"
#include "postproc/smooth_verdict.h"

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

// The progress line is gone when this returns.
SmoothResult smooth_with_progress(const gcode::SourceText& source, const SmoothCommand& command) {
  const Progress progress = show_progress(command.progress, source.text().size());
  SmoothResult result = smooth_program(source, command.options, progress);
  (void)progress(1);
  return result;
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
  const WatchedFile watched(command.input);
  const auto source = read_program(command.input);
  if (interrupted()) return end_interrupted();
  if (!source) return static_cast<int>(ExitCode::kFileError);

  const SmoothResult result = smooth_with_progress(*source, command);
  if (interrupted()) return end_interrupted();
  if (changed_while_read(watched)) return static_cast<int>(ExitCode::kFileError);
  print(result.diagnostics, *source, command.log_level);

  const ExitCode verdict = judge(result, source->text(), command.strict);
  const bool writes = verdict == ExitCode::kDone && !command.dry_run;
  const SmoothReport report = {
      .source = *source,
      .options = command.options,
      .result = result,
      .output_file = writes ? output : "",
      .strict = command.strict,
  };
  // All that takes memory before anything is written: what ends here has written nothing.
  const bool tells = result.understood && command.log_level >= LogLevel::kInfo;
  const std::string summary = tells ? summary_text(report) : "";
  const std::string json = command.json_file.empty() ? "" : json_report(report);
  const std::string page =
      command.report_file.empty() ? "" : html_report(report, {.command = command.command_line});

  int code = static_cast<int>(verdict);
  if (writes && command.in_place) code = write_in_place_of(watched, result.text);
  if (writes && !command.in_place) code = write_result(output, result.text, replaces_program);
  say_lines(summary);
  if (verdict != ExitCode::kDone) say(complaint(verdict, command.strict));
  if (!command.json_file.empty()) {
    const int json_code = write_result(command.json_file, json, command.force);
    if (code == 0) code = json_code;
  }
  if (!command.report_file.empty()) {
    const int report_code = write_result(command.report_file, page, command.force);
    if (code == 0) code = report_code;
  }
  return code;
}

}  // namespace batten::postproc
