#include "postproc/cli/cli_commands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>

#include "gcode/controls/built_in.h"
#include "gcode/state/modal_state.h"
#include "postproc/batch/program_tree.h"
#include "postproc/cli/cli_table.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/options/options.h"
#include "postproc/system/output_file.h"
#include "postproc/text/nearest_name.h"

namespace batten::postproc {

namespace {

// --- values of options: text to numbers and names ------------------------------------------------

std::string_view without_blanks_around(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

bool take_suffix(std::string_view& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.remove_suffix(suffix.size());
  text = without_blanks_around(text);
  return true;
}

// A plain decimal: no exponent, no unit, no blanks.
std::optional<double> decimal(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);  // from_chars takes none
  if (text.starts_with('+') || text.empty()) return std::nullopt;
  double value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  // from_chars reads "inf" and "nan" too.
  const char last = text.back();
  if (last != '.' && (last < '0' || last > '9')) return std::nullopt;
  return value;
}

std::optional<int> whole_number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

struct Tolerance {
  double mm = 0;
  std::optional<double> inch;  // as given, where it was given in inches
};

// "0.01" and "0.01mm" are millimetres, "0.0005in" (or inch) inches. A blank may stand before the
// unit. Whether the size makes sense is not asked here.
std::optional<Tolerance> tolerance_given(Arguments& in) {
  const auto text = in.given.value("tolerance");
  if (!text) return std::nullopt;
  std::string_view number = without_blanks_around(*text);
  const bool inches = take_suffix(number, "inch") || take_suffix(number, "in");
  if (!inches) take_suffix(number, "mm");
  const auto value = decimal(number);
  if (!value) {
    const bool comma = number.find(',') != std::string_view::npos;
    in.problems.push_back(
        fmt::format("--tolerance: '{}', expected a length such as 0.01, 0.01mm or 0.0005in{}",
                    *text, comma ? " (with a point, not a comma)" : ""));
    return std::nullopt;
  }
  if (!inches) return Tolerance{.mm = *value, .inch = std::nullopt};
  return Tolerance{.mm = *value * gcode::millimetres_per(gcode::Units::kInch), .inch = value};
}

std::optional<double> read_decimal(std::string_view option, std::string_view text,
                                   Problems& problems) {
  const auto value = decimal(text);
  if (!value) problems.push_back(fmt::format("--{}: '{}', expected a number", option, text));
  return value;
}

// The place stays as it is where the option was not given or is wrong.
void read_integer_into(int& place, std::string_view option, Arguments& in) {
  const auto text = in.given.value(option);
  if (!text) return;
  const auto value = whole_number(*text);
  if (value) {
    place = *value;
  } else {
    in.problems.push_back(fmt::format("--{}: '{}', expected a whole number", option, *text));
  }
}

template <typename Place, typename Value>
void choose(Place& place, std::string_view option, std::span<const Choice<Value>> choices,
            Arguments& in) {
  const auto text = in.given.value(option);
  if (!text) return;
  std::vector<std::string_view> names;
  for (const auto& choice : choices) {
    if (choice.name == *text) {
      place = choice.value;
      return;
    }
    names.push_back(choice.name);
  }
  in.problems.push_back(unknown_name(option, *text, names));
}

void add_problems(std::vector<std::string> found, Arguments& in) {
  std::ranges::move(found, std::back_inserter(in.problems));
}

// --- what commands have in common ----------------------------------------------------------------

// Exactly as many as are expected; "-" at most once.
void check_files(const std::vector<std::string_view>& expected, Arguments& in) {
  for (std::size_t i = in.files.size(); i < expected.size(); ++i) {
    in.problems.push_back(fmt::format("{}: no file given (- is standard input)", expected[i]));
  }
  refuse_words_after(expected.size(), "file", in);
  if (std::ranges::count(in.files, "-") > 1) {
    in.problems.emplace_back("-: standard input can be read only once");
  }
}

// Nothing where there are fewer.
std::string file_at(const Arguments& in, std::size_t index) {
  return index < in.files.size() ? in.files[index] : std::string();
}

// A report must not land on a program.
void check_report(const std::string& file, const std::vector<std::string>& programs, Arguments& in,
                  std::string_view option = "json") {
  if (file.empty() || file == "-") return;
  for (const std::string& program : programs) {
    if (!program.empty() && program != "-" && same_file(file, program)) {
      in.problems.push_back(
          fmt::format("--{}: {} is the program {} itself", option, file, program));
    }
  }
}

// --quiet, --log-level
LogLevel log_level(Arguments& in) {
  LogLevel level = LogLevel::kInfo;
  if (in.given.flag("quiet")) {
    const auto text = in.given.value("log-level");
    if (text && *text != "error") {
      in.problems.push_back(fmt::format("--quiet: --log-level {} says something else", *text));
    }
    return LogLevel::kError;
  }
  choose(level, "log-level", log_levels(), in);
  return level;
}

// In which words a program is read: of options or a command.
template <typename Reading>
void read_language_into(Reading& reading, Arguments& in) {
  static constexpr std::array kUnits = {
      Choice<gcode::Units>{gcode::Units::kMillimetre, "mm", ""},
      Choice<gcode::Units>{gcode::Units::kInch, "inch", ""},
  };
  choose(reading.units, "units", std::span<const Choice<gcode::Units>>(kUnits), in);
  choose(reading.source, "source", sources(), in);
  if (const auto text = in.given.value("decimals")) {
    reading.decimals = read_decimals(*text, in.problems);
  }
}

// Of the commands that read programs and write none.
template <typename ReadingCommand>
void read_common_into(ReadingCommand& command, Arguments& in) {
  command.json_file = in.given.text("json");
  command.force = in.given.flag("force");
  command.log_level = log_level(in);
  read_language_into(command, in);
}

// --- the control and the machine that a command line names ---------------------------------------

std::vector<std::string_view> target_names() {
  std::vector<std::string_view> names;
  for (const gcode::Control& dialect : gcode::controls()) names.push_back(dialect.name);
  return names;
}

// Null where the option was not given, and with a problem where there is none of that name.
const gcode::Control* built_in_target(std::string_view option, Arguments& in) {
  const auto name = in.given.value(option);
  if (!name) return nullptr;
  const gcode::Control* target = gcode::find_control(*name);
  if (target == nullptr) in.problems.push_back(unknown_name(option, *name, target_names()));
  return target;
}

// --machine, or the built-in machine `otherwise` (may be empty) when that is not given, with what
// --grbl-settings says. Null when there is none, and when something was wrong, which `problems`
// tell then.
std::shared_ptr<const Machine> machine_given(std::string_view otherwise, Arguments& in,
                                             std::string_view option = "machine") {
  const auto choice = in.given.value(option);
  const auto settings = in.given.value("grbl-settings");
  std::shared_ptr<const Machine> machine;
  if (choice || !otherwise.empty()) {
    machine = choose_machine(choice.value_or(std::string(otherwise)), "--machine", in.problems);
    if (machine == nullptr) return nullptr;
  }
  if (!settings) return machine;
  // The settings say that the control is grbl; only who says otherwise contradicts them.
  const bool contradicts = machine != nullptr && machine->model != ControllerModel::kGrbl;
  const Machine* base = contradicts && !choice ? nullptr : machine.get();
  return machine_with_grbl_settings(base, *settings, in.problems);
}

std::string_view default_machine(const gcode::Control* target) {
  if (target == nullptr) return {};
  return target->machine;
}

// By --target NAME, --target FILE.toml, --profile FILE.toml, or --target NAME with --profile
// FILE.toml.
struct GivenTarget {
  const gcode::Control* built_in = nullptr;      // of --target NAME
  std::shared_ptr<const TargetProfile> profile;  // of the file
  bool is_wrong = false;                         // and that has been said

  [[nodiscard]] const gcode::Control* control() const {
    return profile == nullptr ? built_in : &profile->adapted;
  }
};

GivenTarget target_given(Arguments& in) {
  GivenTarget wrong = {.built_in = nullptr, .profile = nullptr, .is_wrong = true};
  const auto name = in.given.value("target");
  const bool names_file = name && name->ends_with(".toml");
  if (names_file && in.given.has("profile")) {
    in.problems.emplace_back("--profile: --target names a profile already");
    return wrong;
  }
  GivenTarget target;
  if (name && !names_file) {
    target.built_in = built_in_target("target", in);
    if (target.built_in == nullptr) return wrong;
  }
  const auto file = names_file ? name : in.given.value("profile");
  if (!file) return target;
  const std::size_t problems_before = in.problems.size();
  target.profile = read_target_profile(*file, target.built_in, in.problems);
  if (target.profile != nullptr) return target;
  // What was said about the file says enough; the options are not to say it again.
  for (std::size_t i = problems_before; i < in.problems.size(); ++i) {
    in.problems[i] = "--target: " + in.problems[i];
  }
  return wrong;
}

// --- smooth, and what batch has of it ------------------------------------------------------------

void read_target(SmoothCommand& command, Arguments& in) {
  GivenTarget target = target_given(in);
  if (target.is_wrong) return;
  command.options.target = target.control();
  if (target.profile != nullptr) {
    command.options.words = target.profile->words;
    command.options.profile = target.profile->file;
    command.profile = std::move(target.profile);
  }
  if (command.options.target != nullptr) return;
  in.problems.push_back(
      fmt::format("--target: no target given; possible: {}, or a profile NAME.toml",
                  fmt::join(target_names(), ", ")));
}

// What was missing or unreadable has been said; the check of the options would say it again.
void check_options(const SmoothOptions& options, Arguments& in) {
  for (std::string& problem : problems_of(options)) {
    const std::string option = problem.substr(0, problem.find(':'));
    const bool said = std::ranges::any_of(
        in.problems, [&](const std::string& other) { return other.starts_with(option + ":"); });
    const bool follows =
        option == "--machine" &&
        (options.target == nullptr || in.given.has("machine") || in.given.has("grbl-settings"));
    if (!said && !follows) in.problems.push_back(std::move(problem));
  }
}

// The command's options, its machine and its profile.
void read_smooth_options(SmoothCommand& command, Arguments& in) {
  SmoothOptions& options = command.options;
  if (const auto file = in.given.value("config")) {
    in.given.complete_from(read_config(*file, in.problems));
  }
  read_target(command, in);
  command.own_machine = machine_given(default_machine(options.target), in);
  options.machine = command.own_machine.get();
  if (const auto tolerance = tolerance_given(in)) {
    options.tolerance_mm = tolerance->mm;
    options.tolerance_inch = tolerance->inch;
  }
  choose(options.tolerance_kind, "tolerance-kind", tolerance_kinds(), in);
  choose(options.side, "side", sides(), in);
  read_language_into(options, in);
  choose(options.method, "method", methods(), in);
  choose(options.output, "output", forms(), in);
  choose(options.prefer, "prefer", preferences(), in);
  choose(options.linearize, "linearize", linearizations(), in);
  if (const auto text = in.given.value("keep-corners")) {
    options.keep_corners_deg = read_decimal("keep-corners", *text, in.problems);
  }
  read_integer_into(options.threads, "threads", in);
  options.allowed = in.given.values("allow");
  options.convert = in.given.flag("convert");
}

void check_outputs(const SmoothCommand& command, Arguments& in) {
  Problems& problems = in.problems;
  const bool to_standard_output =
      command.output == "-" || (command.output.empty() && command.input == "-");
  if (command.in_place && !command.output.empty()) {
    problems.emplace_back("--in-place: the input is replaced, so --out cannot be given");
  }
  if (command.in_place && command.input == "-") {
    problems.emplace_back("--in-place: standard input cannot be replaced");
  }
  for (const auto& [option, file] :
       {std::pair("json", &command.json_file), std::pair("report", &command.report_file)}) {
    if (to_standard_output && *file == "-" && !command.dry_run) {
      problems.push_back(fmt::format("--{}: standard output already takes the program", option));
    }
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
  check_report(command.json_file, {command.input, output}, in);
  check_report(command.report_file, {command.input, output}, in, "report");
}

Command smooth_or_config(Arguments& in) {
  SmoothCommand command = smooth_command(in);
  if (in.given.flag("print-config")) return PrintText{config_text(in.given)};
  return command;
}

// --- verify, inspect -----------------------------------------------------------------------------

void read_allowed_into(std::vector<std::string>& allowed, Arguments& in) {
  allowed = in.given.values("allow");
  add_problems(problems_of_allowed(allowed), in);
}

VerifyCommand verify_command(Arguments& in) {
  VerifyCommand command;
  command.old_program = file_at(in, 0);
  command.new_program = file_at(in, 1);
  read_common_into(command, in);
  GivenTarget target = target_given(in);
  command.target = target.built_in;
  choose(command.tolerance_kind, "tolerance-kind", tolerance_kinds(), in);
  const gcode::Control* control = target.built_in != nullptr ? target.built_in : target.control();
  add_problems(problems_of_decimals(command.decimals, command.source, control), in);
  command.profile = std::move(target.profile);
  read_allowed_into(command.allowed, in);
  choose(command.side, "side", sides(), in);
  add_problems(problems_of_side(command.side, command.tolerance_kind), in);
  if (const auto tolerance = tolerance_given(in)) {
    command.tolerance_mm = tolerance->mm;
    if (!(command.tolerance_mm > 0)) {
      in.problems.push_back(
          fmt::format("--tolerance: '{}', expected a length above 0, such as 0.01",
                      in.given.text("tolerance")));
    }
  }
  check_files({"OLD", "NEW"}, in);
  check_report(command.json_file, in.files, in);
  return command;
}

InspectCommand inspect_command(Arguments& in) {
  InspectCommand command;
  command.input = file_at(in, 0);
  read_common_into(command, in);
  add_problems(problems_of_decimals(command.decimals, command.source, nullptr), in);
  read_allowed_into(command.allowed, in);
  check_files({"IN"}, in);
  check_report(command.json_file, in.files, in);
  return command;
}

// --- freecad, targets, methods, machines ---------------------------------------------------------

FreecadCommand freecad_command(Arguments& in) {
  if (in.files.size() != 1 || in.files.front() != "install") {
    in.problems.emplace_back("freecad: expected one word, install");
  }
  return {.freecad = in.given.text("freecad"),
          .folder = in.given.text("folder"),
          .force = in.given.flag("force")};
}

ListCommand list_command(BuiltIn what, Arguments& in) {
  check_files({}, in);
  return {.what = what,
          .show = built_in_target("show", in),
          .json_file = in.given.text("json"),
          .force = in.given.flag("force")};
}

MachinesCommand machines_command(Arguments& in) {
  check_files({}, in);
  MachinesCommand command = {
      .shown = nullptr, .json_file = in.given.text("json"), .force = in.given.flag("force")};
  if (in.given.has("show") || in.given.has("grbl-settings")) {
    command.shown = machine_given("", in, "show");
  }
  return command;
}

// --- batch ---------------------------------------------------------------------------------------

// All that the bytes of a result depend on: the version, the options, the machine, and what the
// profile holds.
std::string settings_text(const Given& given, const Machine* machine) {
  std::string text = "batten " BATTEN_VERSION "\n";
  for (const OptionRow& row : option_rows("batch")) {
    if (!row.in_config) continue;
    text += fmt::format("{} = {}", row.name, given.has(row.name) ? "" : row.default_value);
    for (const std::string& value : given.values(row.name)) text += value + " ";
    text += '\n';
  }
  for (const char* option : {"target", "profile"}) {
    std::ifstream file(given.text(option), std::ios::binary);
    text.append(std::istreambuf_iterator<char>(file), {});
  }
  if (machine != nullptr) text += machine_file_text(*machine);
  return text;
}

void read_shard_into(Shard& shard, Arguments& in) {
  const auto text = in.given.value("shard");
  if (!text) return;
  const std::size_t slash = text->find('/');
  const auto index = whole_number(std::string_view(*text).substr(0, slash));
  const auto count = slash == std::string::npos
                         ? std::nullopt
                         : whole_number(std::string_view(*text).substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count) {
    in.problems.push_back(
        fmt::format("--shard: '{}', expected I/N with I from 1 to N, such as 2/8", *text));
    return;
  }
  shard = {*index, *count};
}

void check_trees(Arguments& in) {
  constexpr std::array<std::string_view, 2> kTrees = {"IN_TREE", "OUT_TREE"};
  for (std::size_t i = in.files.size(); i < kTrees.size(); ++i) {
    in.problems.push_back(fmt::format("{}: no folder given", kTrees[i]));
  }
  refuse_words_after(kTrees.size(), "folder", in);
  if (in.files.size() != kTrees.size()) return;
  add_problems(problems_of_trees(in.files[0], in.files[1]), in);
}

BatchCommand batch_command(Arguments& in) {
  SmoothCommand one;
  read_smooth_options(one, in);
  check_options(one.options, in);
  BatchCommand command;
  command.options = one.options;
  command.own_machine = one.own_machine;
  command.profile = one.profile;
  command.settings = settings_text(in.given, one.own_machine.get());
  command.strict = in.given.flag("strict");
  command.force = in.given.flag("force");
  command.fail_fast = in.given.flag("fail-fast");
  command.suffixes = in.given.values("suffix");
  if (command.suffixes.empty()) {
    const auto usual = default_program_suffixes();
    command.suffixes.assign(usual.begin(), usual.end());
  }
  read_integer_into(command.jobs, "jobs", in);
  if (command.jobs < 0) {
    in.problems.push_back(fmt::format("--jobs: '{}', expected 0 or more", in.given.text("jobs")));
  }
  read_shard_into(command.shard, in);
  // All but the lines for LinuxCNC, which stand last.
  const auto styles = progress_styles();
  choose(command.progress, "progress", styles.first(styles.size() - 1), in);
  command.input_tree = file_at(in, 0);
  command.output_tree = file_at(in, 1);
  check_trees(in);
  return command;
}

// --- time ----------------------------------------------------------------------------------------

std::optional<geometry::Point3> start_given(Arguments& in) {
  const auto text = in.given.value("from");
  if (!text) return std::nullopt;
  geometry::Point3 place = geometry::Point3::Zero();
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t comma = axis < 2 ? text->find(',', begin) : text->size();
    if (comma == std::string::npos) {
      in.problems.push_back(
          fmt::format("--from: '{}', expected X,Y,Z in mm, such as 0,0,50", *text));
      return std::nullopt;
    }
    const auto value = read_decimal("from", text->substr(begin, comma - begin), in.problems);
    if (!value) return std::nullopt;
    place[axis] = *value;
    begin = comma + 1;
  }
  return place;
}

void check_time_outputs(const TimeCommand& command, Arguments& in) {
  check_report(command.json_file, {command.input}, in);
  if (command.profile_file == "-" && command.json_file == "-") {
    in.problems.emplace_back("--profile: standard output already takes the JSON report");
  }
  if (command.profile_file.empty() || command.profile_file == "-") return;
  for (const std::string& other : {command.input, command.json_file}) {
    if (!other.empty() && other != "-" && same_file(command.profile_file, other)) {
      in.problems.push_back(fmt::format("--profile: {} is another file of this command: {}",
                                        command.profile_file, other));
    }
  }
}

TimeCommand time_command(Arguments& in) {
  TimeCommand command;
  command.input = file_at(in, 0);
  command.profile_file = in.given.text("profile");
  read_common_into(command, in);
  command.target = built_in_target("target", in);
  add_problems(problems_of_decimals(command.decimals, command.source, command.target), in);
  const std::size_t problems_before = in.problems.size();
  command.machine = machine_given(default_machine(command.target), in);
  if (command.machine == nullptr && in.problems.size() == problems_before) {
    in.problems.emplace_back(
        "--machine: no machine given; `batten machines` lists them, a file NAME.toml is your own");
  }
  command.start = start_given(in);
  check_files({"FILE"}, in);
  check_time_outputs(command, in);
  return command;
}

}  // namespace

SmoothCommand smooth_command(Arguments& in) {
  SmoothCommand command;
  read_smooth_options(command, in);
  choose(command.progress, "progress", progress_styles(), in);
  command.log_level = log_level(in);
  // A bar is said too, but lines for LinuxCNC are not for people.
  const bool bar = command.progress == ProgressStyle::kAuto && !in.given.has("progress");
  if (bar && command.log_level < LogLevel::kInfo) command.progress = ProgressStyle::kOff;
  command.in_place = in.given.flag("in-place");
  command.force = in.given.flag("force");
  command.strict = in.given.flag("strict");
  command.dry_run = in.given.flag("dry-run");
  command.json_file = in.given.text("json");
  command.report_file = in.given.text("report");
  command.output = in.given.text("out");
  command.input = file_at(in, 0);
  check_options(command.options, in);
  if (!in.given.flag("print-config")) {
    check_files({"IN"}, in);
    check_outputs(command, in);
  }
  return command;
}

Command command_of(std::string_view name, Arguments& in) {
  if (name == "smooth") return smooth_or_config(in);
  if (name == "verify") return verify_command(in);
  if (name == "inspect") return inspect_command(in);
  if (name == "time") return time_command(in);
  if (name == "batch") return batch_command(in);
  if (name == "freecad") return freecad_command(in);
  if (name == "machines") return machines_command(in);
  return list_command(name == "targets" ? BuiltIn::kTargets : BuiltIn::kMethods, in);
}

std::string unknown_name(std::string_view option, std::string_view text,
                         std::span<const std::string_view> names) {
  return fmt::format("--{}: there is no '{}'{}; possible: {}", option, text,
                     suggestion(text, names), fmt::join(names, ", "));
}

void refuse_words_after(std::size_t expected, std::string_view what, Arguments& in) {
  for (std::size_t i = expected; i < in.files.size(); ++i) {
    in.problems.push_back(fmt::format("'{}': one {} too many", in.files[i], what));
  }
}

}  // namespace batten::postproc
