#include <fmt/format.h>

#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/report/explore_report.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"

namespace batten::postproc {

int run(const ExploreCommand& explore) {
  const SmoothCommand& command = explore.smooth;
  if (!may_be_written(command.json_file, command.force)) {
    return static_cast<int>(ExitCode::kFileError);
  }
  const WatchedFile watched(command.input);
  std::size_t dropped = 0;
  const auto source = read_program(command.input, command.drop, dropped);
  if (interrupted()) return end_interrupted();
  if (!source) return static_cast<int>(ExitCode::kFileError);

  const Progress progress = show_progress(command.progress, source->text().size());
  std::vector<SmoothOptions> settings = explore.settings;
  CalledFiles called;
  if (!settings.empty()) called = read_called_files(*source, command.input, settings.front());
  for (SmoothOptions& each : settings) each.subprograms = called.programs;
  Exploration found = explore_program(*source, settings, progress);
  (void)progress(1);  // the progress line is gone
  if (interrupted()) return end_interrupted();
  if (changed_while_read(watched) || changed_while_read(called))
    return static_cast<int>(ExitCode::kFileError);
  print(found.read.diagnostics, *source, command.log_level, command.command_line);
  const ExploreReport report{*source, found, command.input, explore.options_of_smooth};
  if (found.read.understood && command.json_file != "-") {
    if (const int code = write_result("-", explore_text(report), false); code != 0) return code;
  }
  write_report(command.json_file, command.force, [&] { return explore_json(report); });
  if (found.read.understood) return static_cast<int>(ExitCode::kDone);
  say(complaint(ExitCode::kNotUnderstood, false));
  return static_cast<int>(ExitCode::kNotUnderstood);
}

}  // namespace batten::postproc
