#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "postproc/cli/cli_arguments.h"
#include "postproc/cli/cli_commands.h"
#include "postproc/cli/cli_machine.h"
#include "postproc/options/decimals_option.h"
#include "postproc/system/output_file.h"

namespace batten::postproc {

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
  command.machine = machine_given(
      given, command.target == nullptr ? "" : command.target->default_machine(), problems);
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
