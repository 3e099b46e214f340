#include "postproc/cli_commands.h"

#include <fmt/format.h>

#include <algorithm>

#include "postproc/machine_file.h"
#include "postproc/output_file.h"
#include "postproc/target_profile.h"

namespace batten::postproc {

namespace {

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

// A report must not land on a program.
void check_report(const std::string& file, const std::vector<std::string>& programs,
                  Problems& problems, std::string_view option = "json") {
  if (file.empty() || file == "-") return;
  for (const std::string& program : programs) {
    if (!program.empty() && program != "-" && same_file(file, program)) {
      problems.push_back(fmt::format("--{}: {} is the program {} itself", option, file, program));
    }
  }
}

template <typename Value>
void read_into(Value& place, std::optional<Value> value) {
  if (value) place = *value;
}

void read_units_into(gcode::Units& units, const Given& given, Problems& problems) {
  if (const auto text = given.value("units")) read_into(units, read_units(*text, problems));
}

std::vector<std::string_view> target_names() {
  std::vector<std::string_view> names;
  for (const gcode::Dialect* dialect : gcode::dialects()) names.push_back(dialect->name());
  return names;
}

// Adds a problem where there is none of that name.
const gcode::Dialect* built_in_target(std::string_view option, const std::string& name,
                                      Problems& problems) {
  const gcode::Dialect* target = gcode::find_dialect(name);
  if (target == nullptr) problems.push_back(unknown_name(option, name, target_names()));
  return target;
}

bool is_profile_file(const std::optional<std::string>& name) {
  return name && name->ends_with(".toml");
}

// --target NAME, --target FILE.toml, --profile FILE.toml, or --target NAME with --profile
// FILE.toml.
void read_target(const Given& given, SmoothCommand& command, Problems& problems) {
  const auto name = given.value("target");
  const auto file = is_profile_file(name) ? name : given.value("profile");
  if (is_profile_file(name) && given.has("profile")) {
    problems.push_back("--profile: --target names a profile already");
    return;
  }
  if (!name && !file) {
    std::string possible;
    for (const auto each : target_names()) {
      possible += (possible.empty() ? "" : ", ") + std::string(each);
    }
    problems.push_back("--target: no target given; possible: " + possible +
                       ", or a profile NAME.toml");
    return;
  }
  const gcode::Dialect* target = nullptr;
  if (name && !is_profile_file(name)) {
    target = built_in_target("target", *name, problems);
    if (target == nullptr) return;
  }
  command.options.target = target;
  if (!file) return;
  const std::size_t problems_before = problems.size();
  command.profile = read_target_profile(*file, target, problems);
  if (command.profile == nullptr) {
    // What was said about the file says enough; the options are not to say it again.
    for (std::size_t i = problems_before; i < problems.size(); ++i) {
      problems[i] = "--target: " + problems[i];
    }
    command.options.target = nullptr;
    return;
  }
  command.options.target = command.profile->adapted.get();
  command.options.words = command.profile->words;
  command.options.profile = *file;
}

// A name without a suffix is built in; anything else is a file.
void read_machine(const Given& given, SmoothCommand& command, Problems& problems) {
  const gcode::Dialect* target = command.options.target;
  const auto text = given.value("machine");
  if (!text) {
    if (target != nullptr) command.options.machine = find_machine(target->default_machine());
    return;
  }
  if (text->ends_with(".toml")) {
    command.own_machine = read_machine_file(*text, problems);
    command.options.machine = command.own_machine.get();
    return;
  }
  command.options.machine = find_machine(*text);
  if (command.options.machine != nullptr) return;
  std::vector<std::string_view> names;
  for (const Machine& machine : built_in_machines()) names.emplace_back(machine.name);
  problems.push_back(unknown_name("machine", *text, names) + ", or a file NAME.toml");
}

void read_tolerance_into(const Given& given, SmoothOptions& options, Problems& problems) {
  const auto text = given.value("tolerance");
  if (!text) return;
  const auto tolerance = read_tolerance(*text, problems);
  if (!tolerance) return;
  options.tolerance_mm = tolerance->mm;
  options.tolerance_inch = tolerance->inch;
}

void read_tolerance_kind_into(geometry::ToleranceKind& kind, const Given& given,
                              Problems& problems) {
  if (const auto text = given.value("tolerance-kind")) {
    read_into(kind, read_choice("tolerance-kind", *text, tolerance_kinds(), problems));
  }
}

void read_smooth_options(const Given& given, SmoothCommand& command, Problems& problems) {
  SmoothOptions& options = command.options;
  read_target(given, command, problems);
  read_machine(given, command, problems);
  read_tolerance_into(given, options, problems);
  read_tolerance_kind_into(options.tolerance_kind, given, problems);
  read_units_into(options.units, given, problems);
  if (const auto text = given.value("method")) {
    read_into(options.method, read_choice("method", *text, methods(), problems));
  }
  if (const auto text = given.value("output")) {
    read_into(options.output, read_choice("output", *text, forms(), problems));
  }
  if (const auto text = given.value("prefer")) {
    read_into(options.prefer, read_choice("prefer", *text, preferences(), problems));
  }
  if (const auto text = given.value("linearize")) {
    options.linearize = read_choice("linearize", *text, linearizations(), problems);
  }
  if (const auto text = given.value("keep-corners")) {
    options.keep_corners_deg = read_decimal("keep-corners", *text, problems);
  }
  if (const auto text = given.value("threads")) {
    read_into(options.threads, read_integer("threads", *text, problems));
  }
  options.allowed = given.values("allow");
  options.convert = given.flag("convert");
}

// What was missing or unreadable has been said; the check of the options would say it again.
void check_options(const SmoothOptions& options, Problems& problems) {
  for (std::string& problem : problems_of(options)) {
    const std::string option = problem.substr(0, problem.find(':'));
    const bool said = std::ranges::any_of(
        problems, [&](const std::string& other) { return other.starts_with(option + ":"); });
    const bool follows = option == "--machine" && options.target == nullptr;
    if (!said && !follows) problems.push_back(std::move(problem));
  }
}

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

}  // namespace

SmoothCommand smooth_command(const Given& given, const std::vector<std::string>& files,
                             Problems& problems) {
  SmoothCommand command;
  read_smooth_options(given, command, problems);
  if (const auto text = given.value("progress")) {
    read_into(command.progress, read_choice("progress", *text, progress_styles(), problems));
  }
  command.in_place = given.flag("in-place");
  command.force = given.flag("force");
  command.strict = given.flag("strict");
  command.dry_run = given.flag("dry-run");
  command.json_file = given.value("json").value_or("");
  command.report_file = given.value("report").value_or("");
  command.output = given.value("out").value_or("");
  command.input = file_at(files, 0);
  check_options(command.options, problems);
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
  read_units_into(command.units, given, problems);
  if (const auto text = given.value("target")) {
    command.target = gcode::find_dialect(*text);
    if (command.target == nullptr) {
      problems.push_back(unknown_name("target", *text, target_names()));
    }
  }
  read_tolerance_kind_into(command.tolerance_kind, given, problems);
  if (const auto file = given.value("profile")) {
    command.profile = read_target_profile(*file, nullptr, problems);
  }
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
  read_units_into(command.units, given, problems);
  command.allowed = given.values("allow");
  for (std::string& problem : problems_of_allowed(command.allowed)) {
    problems.push_back(std::move(problem));
  }
  check_files(files, {"IN"}, problems);
  check_report(command.json_file, files, problems);
  return command;
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

}  // namespace batten::postproc
