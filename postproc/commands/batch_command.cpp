#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <set>
#include <system_error>

#include "postproc/batch/batch_index.h"
#include "postproc/batch/batch_run.h"
#include "postproc/batch/batch_summary.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/stream/unit_evidence.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/system/parallel_for.h"
#include "postproc/text/json_values.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace fs = std::filesystem;

namespace {

bool names_no_unit(const ProgramRecord& record) {
  return record.status == ProgramStatus::kNotUnderstood &&
         record.message.find(": units-missing: ") != std::string::npos;
}

// Once for all programs that name no unit.
void tell_missing_units(const std::vector<ProgramRecord>& records, std::string_view command_line) {
  std::size_t millimetres = 0;
  std::size_t inches = 0;
  std::vector<std::string_view> programs;
  for (const ProgramRecord& record : records) {
    if (!names_no_unit(record)) continue;
    programs.push_back(record.program);
    if (record.message.find(kSpeaksForMillimetres) != std::string::npos) ++millimetres;
    if (record.message.find(kSpeaksForInches) != std::string::npos) ++inches;
  }
  if (programs.empty()) return;
  constexpr std::size_t kMostNames = 3;
  const std::size_t all = programs.size();
  const std::string more = all > kMostNames ? ", .." : "";
  programs.resize(std::min(all, kMostNames));
  std::vector<std::string> speak;
  for (const auto& [count, unit] : {std::pair(millimetres, "mm"), std::pair(inches, "inch"),
                                    std::pair(all - millimetres - inches, "neither")}) {
    if (count > 0) speak.push_back(fmt::format("of {} for {}", count, unit));
  }
  say(fmt::format(
      "{} without G20 or G21 ({}{}): the numbers speak {}; the reports say why. --units "
      "is for all of them{}:",
      plural(all, "program"), fmt::join(programs, ", "), more, fmt::join(speak, ", "),
      millimetres > 0 && inches > 0 ? ", so put those of each unit in a folder" : ""));
  const gcode::Units likely = millimetres > 0 && inches == 0   ? gcode::Units::kMillimetre
                              : inches > 0 && millimetres == 0 ? gcode::Units::kInch
                                                               : gcode::Units::kUnknown;
  say_lines(commands_with_units(command_line, likely));
}

// The progress line, and a message for each program that was not written.
class BatchDisplay {
 public:
  explicit BatchDisplay(ProgressStyle style)
      : shows_line_(style == ProgressStyle::kOn ||
                    (style == ProgressStyle::kAuto && ::isatty(STDERR_FILENO) == 1)) {}
  BatchDisplay(const BatchDisplay&) = delete;
  BatchDisplay& operator=(const BatchDisplay&) = delete;
  ~BatchDisplay() { clear(); }

  void show(const BatchCount& count, const ProgramRecord* ended) {
    if (ended != nullptr && ended->exit_code != 0 && !names_no_unit(*ended)) {
      clear();
      const bool names_it = ended->message.find(ended->program) != std::string::npos;
      say(names_it ? ended->message : ended->program + ": " + ended->message);
    }
    if (!shows_line_) return;
    const std::string line = progress_line(count);
    if (line == line_) return;
    clear();
    line_ = line;
    say_lines(line_);
    std::fflush(stderr);
  }

 private:
  void clear() {
    if (line_.empty()) return;
    say_lines("\r" + std::string(line_.size(), ' ') + "\r");
    line_.clear();
  }

  bool shows_line_;
  std::string line_;
};

// "summary" for the whole tree, "summary-2-of-8" for a shard.
fs::path summary_path(const fs::path& batch, const Shard& shard, std::string_view suffix) {
  return batch / (shard.count == 1
                      ? fmt::format("summary.{}", suffix)
                      : fmt::format("summary-{}-of-{}.{}", shard.index, shard.count, suffix));
}

// "index.html", "index-2-of-8.html"
fs::path index_path(const fs::path& batch, const Shard& shard) {
  return batch / (shard.count == 1 ? std::string("index.html")
                                   : fmt::format("index-{}-of-{}.html", shard.index, shard.count));
}

std::set<fs::path> all_targets(const BatchRequest& request, const fs::path& batch,
                               const Shard& shard) {
  std::set<fs::path> targets;
  for (const TreeProgram& program : request.programs) {
    const ProgramPlaces places = places_of(request.plan.output_tree, program.name);
    targets.insert({places.output, places.report, places.page, places.record});
  }
  for (const char* suffix : {"txt", "csv", "json"}) {
    targets.insert(summary_path(batch, shard, suffix));
  }
  targets.insert(index_path(batch, shard));
  return targets;
}

// 0, or why a file could not be written.
int write_summary(const std::vector<ProgramRecord>& records, const BatchCommand& command,
                  const fs::path& batch) {
  const Shard& shard = command.shard;
  const std::string table = summary_table(records);
  int code = write_result(summary_path(batch, shard, "txt"), table, true);
  if (code == 0) code = write_result(summary_path(batch, shard, "csv"), summary_csv(records), true);
  if (code == 0) {
    const std::string report =
        ended_report(summary_json(records), totals_of(records).exit_code, {});
    code = write_result(summary_path(batch, shard, "json"), report, true);
  }
  if (code == 0) {
    std::error_code error;
    const fs::path tree = fs::weakly_canonical(command.input_tree, error);
    code = write_page({.file = index_path(batch, shard), .open = command.open}, true,
                      command.input_tree,
                      batch_index(records, tree.filename().string(), command.options));
  }
  write_report(command.json_file, command.force, [&] { return summary_json(records); });
  if (command.json_file == "-") return code;
  const int table_code = write_result("-", table, false);
  return code != 0 ? code : table_code;
}

BatchRequest request_of(const BatchCommand& command, const ProgramTree& tree) {
  return {.plan = {.input_tree = fs::path(command.input_tree).lexically_normal(),
                   .output_tree = fs::path(command.output_tree).lexically_normal(),
                   .options = command.options,
                   .settings_sha256 = sha256(command.settings),
                   .drop = command.drop,
                   .strict = command.strict,
                   .force = command.force,
                   .pages = command.pages},
          .programs = programs_of(command.shard, tree.programs),
          .jobs = static_cast<std::size_t>(command.jobs > 0 ? command.jobs : threads_at_once(0)),
          .fail_fast = command.fail_fast};
}

void tell_what_was_left_out(const ProgramTree& tree) {
  for (const std::string& problem : tree.problems) say(problem);
  if (tree.programs.empty()) {
    say("no programs in it: no name ends as those of programs do; --suffix says how yours end");
  }
  if (tree.other_files > 0) {
    say(fmt::format("other files left alone: {} (--suffix says what is a program)",
                    tree.other_files));
  }
  if (tree.folder_links > 0) {
    say(fmt::format("links to folders not followed: {}", tree.folder_links));
  }
}

int work_through(const BatchCommand& command, const BatchRequest& request, const fs::path& batch) {
  if (const auto removed =
          remove_half_written(request.plan.output_tree, all_targets(request, batch, command.shard));
      removed > 0) {
    say(fmt::format("half-written files of an earlier run removed: {}", removed));
  }
  BatchResult result;
  when_late(LateWork::kMayEndLater);  // the processes of the programs end in time
  {
    BatchDisplay display(command.progress);
    result = run_batch(request, [&](const BatchCount& count, const ProgramRecord* ended) {
      display.show(count, ended);
    });
  }
  if (result.were_done > 0) {
    say(fmt::format("done already: {} of {} programs", result.were_done, result.records.size()));
  }
  tell_missing_units(result.records, command.command_line);
  if (interrupted()) {
    say("interrupted; the same command goes on where it stopped");
    return interrupt_exit_code();
  }
  const int written = write_summary(result.records, command, batch);
  return std::max(written, totals_of(result.records).exit_code);
}

}  // namespace

int run(const BatchCommand& command) {
  if (!can_show({.file = {}, .open = command.open})) {
    return static_cast<int>(ExitCode::kFileError);
  }
  std::error_code error;
  if (!fs::is_directory(command.input_tree, error)) {
    say(command.input_tree + ": is no folder that can be read");
    return static_cast<int>(ExitCode::kFileError);
  }
  const ProgramTree tree = list_programs(fs::path(command.input_tree), command.suffixes);
  tell_what_was_left_out(tree);
  const BatchRequest request = request_of(command, tree);
  const fs::path batch = request.plan.output_tree / kBatchFolder;
  fs::create_directories(batch, error);
  if (error) {
    say(batch.string() + ": cannot be made: " + error.message());
    return static_cast<int>(ExitCode::kFileError);
  }
  const BatchLock lock(batch, command.shard);
  if (!lock.problem().empty()) {
    say(lock.problem());
    return static_cast<int>(ExitCode::kFileError);
  }
  const int code = work_through(command, request, batch);
  const bool tree_was_read = tree.problems.empty();
  return tree_was_read ? code : std::max(code, static_cast<int>(ExitCode::kFileError));
}

}  // namespace batten::postproc
