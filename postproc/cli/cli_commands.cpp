#include "postproc/cli/cli_commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <optional>

#include "postproc/batch/program_tree.h"
#include "postproc/cli/cli_arguments.h"
#include "postproc/cli/cli_smooth_options.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/options/options.h"
#include "postproc/system/output_file.h"

namespace batten::postproc {

namespace {

void check_outputs(const SmoothCommand& command, Problems& problems) {
  const bool to_standard_output =
      command.output == "-" || (command.output.empty() && command.input == "-");
  if (command.in_place && !command.output.empty()) {
    problems.emplace_back("--in-place: the input is replaced, so --out has no place");
  }
  if (command.in_place && command.input == "-") {
    problems.emplace_back("--in-place: standard input cannot be replaced");
  }
  if (to_standard_output && command.json_file == "-" && !command.dry_run) {
    problems.emplace_back("--json: standard output already takes the program");
  }
  if (to_standard_output && command.report_file == "-" && !command.dry_run) {
    problems.emplace_back("--report: standard output already takes the program");
  }
  const bool same_report = command.report_file == "-"
                               ? command.json_file == "-"
                               : !command.report_file.empty() && !command.json_file.empty() &&
                                     same_file(command.report_file, command.json_file);
  if (same_report) {
    problems.push_back(
        fmt::format("--report: {} takes the JSON report already",
                    command.report_file == "-" ? "standard output" : command.report_file));
  }
  const std::string output = command.output.empty() && command.input != "-"
                                 ? default_output_path(command.input).string()
                                 : command.output;
  if (!command.output.empty() && command.output != "-" && command.input != "-" &&
      !command.input.empty() && same_file(command.output, command.input)) {
    problems.push_back(fmt::format("--out: {} is the input itself; --in-place replaces the input",
                                   command.output));
  }
  check_report(command.json_file, {command.input, output}, problems);
  check_report(command.report_file, {command.input, output}, problems, "report");
}

void read_allowed_into(std::vector<std::string>& allowed, const Given& given, Problems& problems) {
  allowed = given.values("allow");
  std::ranges::move(problems_of_allowed(allowed), std::back_inserter(problems));
}

}  // namespace

SmoothCommand smooth_command(const Given& given, const std::vector<std::string>& files,
                             Problems& problems) {
  SmoothCommand command;
  read_smooth_options(given, command, problems);
  if (const auto text = given.value("progress")) {
    read_into(command.progress, read_choice("progress", *text, progress_styles(), problems));
  }
  command.log_level = read_log_level(given, problems);
  // A bar is said too, but lines for LinuxCNC are not for people.
  const bool bar = command.progress == ProgressStyle::kAuto && !given.has("progress");
  if (bar && command.log_level < LogLevel::kInfo) command.progress = ProgressStyle::kOff;
  command.in_place = given.flag("in-place");
  command.force = given.flag("force");
  command.strict = given.flag("strict");
  command.dry_run = given.flag("dry-run");
  command.json_file = given.value("json").value_or("");
  command.report_file = given.value("report").value_or("");
  command.output = given.value("out").value_or("");
  command.input = file_at(files, 0);
  check_options(command.options, given, problems);
  if (!given.flag("print-config")) {
    check_files(files, {"IN"}, problems);
    check_outputs(command, problems);
  }
  return command;
}

VerifyCommand verify_command(const Given& given, const std::vector<std::string>& files,
                             Problems& problems) {
  VerifyCommand command;
  command.old_program = file_at(files, 0);
  command.new_program = file_at(files, 1);
  command.json_file = given.value("json").value_or("");
  command.force = given.flag("force");
  command.log_level = read_log_level(given, problems);
  read_units_into(command.units, given, problems);
  read_source_into(command.source, given, problems);
  read_decimals_into(command.decimals, given, problems);
  GivenTarget target = target_given(given, problems);
  command.target = target.built_in;
  command.profile = std::move(target.profile);
  read_tolerance_kind_into(command.tolerance_kind, given, problems);
  const gcode::Control* adapted = command.profile != nullptr ? &command.profile->adapted : nullptr;
  std::ranges::move(problems_of_decimals(command.decimals, command.source,
                                         command.target != nullptr ? command.target : adapted),
                    std::back_inserter(problems));
  read_allowed_into(command.allowed, given, problems);
  read_side_into(command.side, given, problems);
  std::ranges::move(problems_of_side(command.side, command.tolerance_kind),
                    std::back_inserter(problems));
  if (const auto text = given.value("tolerance")) {
    if (const auto tolerance = read_tolerance(*text, problems)) {
      command.tolerance_mm = tolerance->mm;
      if (!(command.tolerance_mm > 0)) {
        problems.push_back(
            fmt::format("--tolerance: '{}', expected a length above 0, such as 0.01", *text));
      }
    }
  }
  check_files(files, {"OLD", "NEW"}, problems);
  check_report(command.json_file, files, problems);
  return command;
}

InspectCommand inspect_command(const Given& given, const std::vector<std::string>& files,
                               Problems& problems) {
  InspectCommand command;
  command.input = file_at(files, 0);
  command.json_file = given.value("json").value_or("");
  command.force = given.flag("force");
  command.log_level = read_log_level(given, problems);
  read_units_into(command.units, given, problems);
  read_source_into(command.source, given, problems);
  read_decimals_into(command.decimals, given, problems);
  std::ranges::move(problems_of_decimals(command.decimals, command.source, nullptr),
                    std::back_inserter(problems));
  read_allowed_into(command.allowed, given, problems);
  check_files(files, {"IN"}, problems);
  check_report(command.json_file, files, problems);
  return command;
}

FreecadCommand freecad_command(const Given& given, const std::vector<std::string>& files,
                               Problems& problems) {
  if (files.size() != 1 || files.front() != "install") {
    problems.emplace_back("freecad: expected one word, install");
  }
  return {.freecad = given.value("freecad").value_or(""),
          .folder = given.value("folder").value_or(""),
          .force = given.flag("force")};
}

ListCommand list_command(BuiltIn what, const Given& given, const std::vector<std::string>& files,
                         Problems& problems) {
  check_files(files, {}, problems);
  ListCommand command = {
      .what = what, .json_file = given.value("json").value_or(""), .force = given.flag("force")};
  if (const auto name = given.value("show"))
    command.show = built_in_target("show", *name, problems);
  return command;
}

MachinesCommand machines_command(const Given& given, const std::vector<std::string>& files,
                                 Problems& problems) {
  check_files(files, {}, problems);
  MachinesCommand command;
  command.json_file = given.value("json").value_or("");
  command.force = given.flag("force");
  const auto shown = given.value("show");
  if (!shown && !given.has("grbl-settings")) return command;
  Given machine = given;
  if (shown) machine.add("machine", *shown);
  command.shown = machine_given(machine, "", problems);
  return command;
}

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

namespace {

std::optional<geometry::Point3> read_place(std::string_view option, const std::string& text,
                                           Problems& problems) {
  geometry::Point3 place = geometry::Point3::Zero();
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t comma = axis < 2 ? text.find(',', begin) : text.size();
    if (comma == std::string::npos) {
      problems.push_back(
          fmt::format("--{}: '{}', expected X,Y,Z in mm, such as 0,0,50", option, text));
      return std::nullopt;
    }
    const auto value = read_decimal(option, text.substr(begin, comma - begin), problems);
    if (!value) return std::nullopt;
    place[axis] = *value;
    begin = comma + 1;
  }
  return place;
}

void check_time_outputs(const TimeCommand& command, Problems& problems) {
  check_report(command.json_file, {command.input}, problems);
  if (command.profile_file.empty()) return;
  if (command.profile_file == "-") {
    if (command.json_file == "-") {
      problems.emplace_back("--profile: standard output already takes the JSON report");
    }
    return;
  }
  for (const std::string& other : {command.input, command.json_file}) {
    if (!other.empty() && other != "-" && same_file(command.profile_file, other)) {
      problems.push_back(fmt::format("--profile: {} is another file of this command: {}",
                                     command.profile_file, other));
    }
  }
}

}  // namespace

TimeCommand time_command(const Given& given, const std::vector<std::string>& files,
                         Problems& problems) {
  TimeCommand command;
  command.input = file_at(files, 0);
  command.json_file = given.value("json").value_or("");
  command.profile_file = given.value("profile").value_or("");
  command.force = given.flag("force");
  command.log_level = read_log_level(given, problems);
  read_units_into(command.units, given, problems);
  read_source_into(command.source, given, problems);
  read_decimals_into(command.decimals, given, problems);
  if (const auto text = given.value("target")) {
    command.target = built_in_target("target", *text, problems);
  }
  std::ranges::move(problems_of_decimals(command.decimals, command.source, command.target),
                    std::back_inserter(problems));
  const std::size_t problems_before = problems.size();
  command.machine =
      machine_given(given, command.target == nullptr ? "" : command.target->machine, problems);
  if (command.machine == nullptr && problems.size() == problems_before) {
    problems.emplace_back(
        "--machine: no machine given; `batten machines` lists them, a file NAME.toml is your own");
  }
  if (const auto text = given.value("from")) command.start = read_place("from", *text, problems);
  check_files(files, {"FILE"}, problems);
  check_time_outputs(command, problems);
  return command;
}

}  // namespace batten::postproc
