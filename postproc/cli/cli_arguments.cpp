#include "postproc/cli/cli_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "gcode/controls/built_in.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/options/options.h"
#include "postproc/system/output_file.h"

namespace batten::postproc {

void check_files(const std::vector<std::string>& files,
                 const std::vector<std::string_view>& expected, Problems& problems) {
  for (std::size_t i = files.size(); i < expected.size(); ++i) {
    problems.push_back(fmt::format("{}: no file given (- is standard input)", expected[i]));
  }
  for (std::size_t i = expected.size(); i < files.size(); ++i) {
    problems.push_back(fmt::format("'{}': one file too many", files[i]));
  }
  if (std::ranges::count(files, "-") > 1) {
    problems.emplace_back("-: standard input can be read only once");
  }
}

std::string file_at(const std::vector<std::string>& files, std::size_t index) {
  return index < files.size() ? files[index] : std::string();
}

void check_report(const std::string& file, const std::vector<std::string>& programs,
                  Problems& problems, std::string_view option) {
  if (file.empty() || file == "-") return;
  for (const std::string& program : programs) {
    if (!program.empty() && program != "-" && same_file(file, program)) {
      problems.push_back(fmt::format("--{}: {} is the program {} itself", option, file, program));
    }
  }
}

void read_units_into(gcode::Units& units, const Given& given, Problems& problems) {
  if (const auto text = given.value("units")) read_into(units, read_units(*text, problems));
}

void read_source_into(gcode::SourceKind& source, const Given& given, Problems& problems) {
  if (const auto text = given.value("source")) {
    read_into(source, read_choice("source", *text, sources(), problems));
  }
}

void read_decimals_into(std::optional<gcode::Decimals>& decimals, const Given& given,
                        Problems& problems) {
  if (const auto text = given.value("decimals")) decimals = read_decimals(*text, problems);
}

LogLevel read_log_level(const Given& given, Problems& problems) {
  const auto text = given.value("log-level");
  if (given.flag("quiet")) {
    if (text && *text != "error") {
      problems.push_back(fmt::format("--quiet: --log-level {} says something else", *text));
    }
    return LogLevel::kError;
  }
  LogLevel level = LogLevel::kInfo;
  if (text) read_into(level, read_choice("log-level", *text, log_levels(), problems));
  return level;
}

std::vector<std::string_view> target_names() {
  std::vector<std::string_view> names;
  for (const gcode::Control& control : gcode::controls()) names.push_back(control.name);
  return names;
}

const gcode::Control* built_in_target(std::string_view option, const std::string& name,
                                      Problems& problems) {
  const gcode::Control* target = gcode::find_control(name);
  if (target == nullptr) problems.push_back(unknown_name(option, name, target_names()));
  return target;
}

std::shared_ptr<const Machine> machine_given(const Given& given, std::string_view otherwise,
                                             Problems& problems) {
  const auto choice = given.value("machine");
  const auto settings = given.value("grbl-settings");
  std::shared_ptr<const Machine> machine;
  if (choice || !otherwise.empty()) {
    machine = choose_machine(choice.value_or(std::string(otherwise)), "--machine", problems);
    if (machine == nullptr) return nullptr;
  }
  if (!settings) return machine;
  // The settings say that the control is grbl; only who says otherwise contradicts them.
  const bool contradicts = machine != nullptr && machine->model != ControllerModel::kGrbl;
  const Machine* base = contradicts && !choice ? nullptr : machine.get();
  return machine_with_grbl_settings(base, *settings, problems);
}

namespace {

bool is_profile_file(const std::optional<std::string>& name) {
  return name && name->ends_with(".toml");
}

GivenTarget wrong_target() {
  GivenTarget target;
  target.is_wrong = true;
  return target;
}

}  // namespace

GivenTarget target_given(const Given& given, Problems& problems) {
  const auto name = given.value("target");
  const auto file = is_profile_file(name) ? name : given.value("profile");
  if (is_profile_file(name) && given.has("profile")) {
    problems.push_back("--profile: --target names a profile already");
    return wrong_target();
  }
  GivenTarget target;
  if (name && !is_profile_file(name)) {
    target.built_in = built_in_target("target", *name, problems);
    if (target.built_in == nullptr) return wrong_target();
  }
  if (!file) return target;
  const std::size_t problems_before = problems.size();
  target.profile = read_target_profile(*file, target.built_in, problems);
  if (target.profile != nullptr) return target;
  // What was said about the file says enough; the options are not to say it again.
  for (std::size_t i = problems_before; i < problems.size(); ++i) {
    problems[i] = "--target: " + problems[i];
  }
  return wrong_target();
}

}  // namespace batten::postproc
