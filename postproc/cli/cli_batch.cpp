#include <fmt/format.h>

#include <array>
#include <fstream>
#include <iterator>

#include "postproc/batch/program_tree.h"
#include "postproc/cli/cli_arguments.h"
#include "postproc/cli/cli_commands.h"
#include "postproc/cli/cli_smooth_options.h"
#include "postproc/machine/files/machine_file.h"

namespace batten::postproc {

namespace {

// All that the bytes of a result depend on: the version, the options, the machine, and what the
// profile holds.
std::string settings_text(const Given& given, const Machine* machine) {
  std::string text = "batten " BATTEN_VERSION "\n";
  for (const OptionRow& row : batch_rows()) {
    if (!row.in_config) continue;
    text += fmt::format("{} = {}", row.name, given.has(row.name) ? "" : row.default_value);
    for (const std::string& value : given.values(row.name)) text += value + " ";
    text += '\n';
  }
  for (const char* option : {"target", "profile"}) {
    std::ifstream file(given.value(option).value_or(""), std::ios::binary);
    text.append(std::istreambuf_iterator<char>(file), {});
  }
  if (machine != nullptr) text += machine_file_text(*machine);
  return text;
}

void read_shard_into(Shard& shard, const std::string& text, Problems& problems) {
  const std::size_t slash = text.find('/');
  Problems ignored;
  const auto index = read_integer("shard", text.substr(0, slash), ignored);
  const auto count =
      slash == std::string::npos ? index : read_integer("shard", text.substr(slash + 1), ignored);
  if (slash == std::string::npos || !index || !count || *index < 1 || *index > *count) {
    problems.push_back(
        fmt::format("--shard: '{}', expected I/N with I from 1 to N, such as 2/8", text));
    return;
  }
  shard = {*index, *count};
}

void check_trees(const std::vector<std::string>& files, Problems& problems) {
  constexpr std::array<std::string_view, 2> kTrees = {"IN_TREE", "OUT_TREE"};
  for (std::size_t i = files.size(); i < kTrees.size(); ++i) {
    problems.push_back(fmt::format("{}: no folder given", kTrees[i]));
  }
  for (std::size_t i = kTrees.size(); i < files.size(); ++i) {
    problems.push_back(fmt::format("'{}': one folder too many", files[i]));
  }
  if (files.size() != kTrees.size()) return;
  for (std::string& problem : problems_of_trees(files[0], files[1])) {
    problems.push_back(std::move(problem));
  }
}

}  // namespace

BatchCommand batch_command(const Given& given, const std::vector<std::string>& files,
                           Problems& problems) {
  SmoothCommand one;
  read_smooth_options(given, one, problems);
  check_options(one.options, given, problems);
  BatchCommand command;
  command.options = one.options;
  command.own_machine = one.own_machine;
  command.profile = one.profile;
  command.settings = settings_text(given, one.own_machine.get());
  command.strict = given.flag("strict");
  command.force = given.flag("force");
  command.fail_fast = given.flag("fail-fast");
  command.suffixes = given.values("suffix");
  if (command.suffixes.empty()) {
    const auto usual = default_program_suffixes();
    command.suffixes.assign(usual.begin(), usual.end());
  }
  if (const auto text = given.value("jobs")) {
    read_into(command.jobs, read_integer("jobs", *text, problems));
    if (command.jobs < 0) {
      problems.push_back(fmt::format("--jobs: '{}', expected 0 or more", *text));
    }
  }
  if (const auto text = given.value("shard")) read_shard_into(command.shard, *text, problems);
  if (const auto text = given.value("progress")) {
    // All but the lines for LinuxCNC, which stand last.
    const auto styles = progress_styles();
    read_into(command.progress,
              read_choice("progress", *text, styles.first(styles.size() - 1), problems));
  }
  command.input_tree = file_at(files, 0);
  command.output_tree = file_at(files, 1);
  check_trees(files, problems);
  return command;
}

}  // namespace batten::postproc
