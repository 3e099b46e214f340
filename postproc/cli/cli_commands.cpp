#include "postproc/cli/cli_commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "postproc/cli/cli_arguments.h"
#include "postproc/cli/cli_machine.h"
#include "postproc/cli/cli_smooth_options.h"
#include "postproc/cli/cli_target.h"
#include "postproc/options/decimals_option.h"
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
  const gcode::Dialect* adapted =
      command.profile != nullptr ? command.profile->adapted.get() : nullptr;
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

}  // namespace batten::postproc
