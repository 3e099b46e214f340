#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <set>
#include <span>

#include "gcode/controls/built_in.h"
#include "gcode/reading/dropped_words.h"
#include "gcode/reading/target_marks.h"
#include "gcode/state/modal_state.h"
#include "postproc/batch/program_tree.h"
#include "postproc/cli/cli.h"
#include "postproc/cli/cli_config.h"
#include "postproc/cli/cli_table.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/options/options.h"
#include "postproc/options/own_words.h"
#include "postproc/options/target_on_machine.h"
#include "postproc/system/output_file.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

// --- values of options: text to numbers and names ------------------------------------------------

bool take_suffix(std::string_view& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.remove_suffix(suffix.size());
  text = trimmed(text);
  return true;
}

// All of the text is one number.
template <typename Number, typename... Format>
std::optional<Number> whole_text(std::string_view text, Format... format) {
  Number value = 0;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value, format...);
  return error == std::errc{} && end == last ? std::optional(value) : std::nullopt;
}

// A plain decimal: no exponent, no unit, no blanks.
std::optional<double> decimal(std::string_view text) {
  // from_chars takes no +, but "inf" and "nan".
  if (text.find_first_not_of("+-.0123456789") != std::string_view::npos) return std::nullopt;
  if (text.starts_with('+')) text.remove_prefix(1);
  return whole_text<double>(text, std::chars_format::fixed);
}

// "0.01" and "0.01mm" are millimetres, "0.0005in" (or inch) inches, a blank before the unit or not.
// Returns millimetres; `inch` is set where inches are given. Whether the size makes sense is not
// asked here.
std::optional<double> tolerance_in(const std::optional<std::string>& text, Arguments& in,
                                   std::optional<double>& inch) {
  if (!text) return std::nullopt;
  std::string_view number = trimmed(*text);
  const bool inches = take_suffix(number, "inch") || take_suffix(number, "in");
  if (!inches) take_suffix(number, "mm");
  const auto value = decimal(number);
  if (!value) {
    const bool comma = number.find(',') != std::string_view::npos;
    in.complain("--tolerance: '{}', expected a length such as 0.01, 0.01mm or 0.0005in{}", *text,
                comma ? " (with a point, not a comma)" : "");
  }
  if (!value || !inches) return value;
  inch = value;
  return *value * gcode::millimetres_per(gcode::Units::kInch);
}

std::optional<double> read_decimal(std::string_view option, std::string_view text, Arguments& in) {
  const auto value = decimal(text);
  if (!value) in.complain("--{}: '{}', expected a number", option, text);
  return value;
}

// The field stays as it is where the option was not given or is wrong.
void read_integer_into(int& field, std::string_view option, Arguments& in) {
  const auto text = in.given.value(option);
  const auto value = text ? whole_text<int>(*text) : std::nullopt;
  if (value) field = *value;
  if (text && !value) {
    in.complain("--{}: '{}', expected a whole number", option, *text);
  }
}

// "--output: there is no 'arc'; did you mean arcs? Possible: auto, arcs, lines"
void complain_of_name(std::string_view option, std::string_view text,
                      const std::vector<std::string_view>& names, Arguments& in) {
  in.complain("--{}: there is no '{}'{}; possible: {}", option, text, suggestion(text, names),
              fmt::join(names, ", "));
}

template <typename Field, typename Value>
void choose(Field& field, std::string_view option, std::span<const Choice<Value>> choices,
            Arguments& in) {
  const auto text = in.given.value(option);
  if (!text) return;
  std::vector<std::string_view> names;
  for (const auto& choice : choices) {
    if (choice.name == *text) {
      field = choice.value;
      return;
    }
    names.push_back(choice.name);
  }
  complain_of_name(option, *text, names, in);
}

void add_problems(std::vector<std::string> found, Arguments& in) {
  std::ranges::move(found, std::back_inserter(in.problems));
}

// --- what commands have in common ----------------------------------------------------------------

// Exactly as many as are expected; "-" at most once.
void check_files(const std::vector<std::string_view>& expected, Arguments& in) {
  for (std::size_t i = in.files.size(); i < expected.size(); ++i) {
    in.complain("{}: no file given (- is standard input)", expected[i]);
  }
  refuse_words_after(expected.size(), "file", in);
  if (std::ranges::count(in.files, "-") > 1) {
    in.complain("-: standard input can be read only once");
  }
}

// Nothing where there are fewer.
std::string file_at(const Arguments& in, std::size_t index) {
  return index < in.files.size() ? in.files[index] : std::string();
}

// Two names that people gave for the same file, which is none of the standard streams.
bool is_one_file(const std::string& one, const std::string& other) {
  const auto names_file = [](const std::string& name) { return !name.empty() && name != "-"; };
  return names_file(one) && names_file(other) && same_file(one, other);
}

// A report must not land on a program.
void check_report(const std::string& file, const std::vector<std::string>& programs, Arguments& in,
                  std::string_view option = "json") {
  for (const std::string& program : programs) {
    if (!is_one_file(file, program)) continue;
    in.complain("--{}: {} is the program {} itself", option, file, program);
  }
}

// --report, --open
PageRequest page_given(Arguments& in) {
  return {.file = in.given.text("report"), .open = in.given.flag("open")};
}

// Of a command with both.
template <typename Command>
void check_reports(const Command& command, const std::vector<std::string>& programs,
                   Arguments& in) {
  const std::string& page = command.page.file;
  check_report(command.json_file, programs, in);
  check_report(page, programs, in, "report");
  const bool both_to_standard_output = page == "-" && command.json_file == "-";
  if (both_to_standard_output || is_one_file(page, command.json_file)) {
    in.complain("--report: {} takes the JSON report already",
                both_to_standard_output ? "standard output" : page);
  }
  const bool is_page =
      page.empty() || page == "-" || page.ends_with(".html") || page.ends_with(".htm");
  if (!is_page) in.complain("--report: {}: a page is written, so name it .html", page);
  if (page == "-" && command.page.open) {
    in.complain("--open: a page on standard output cannot be shown; name a file");
  }
}

// --quiet, --log-level
LogLevel log_level(Arguments& in) {
  LogLevel level = LogLevel::kInfo;
  if (!in.given.flag("quiet")) {
    choose(level, "log-level", log_levels(), in);
    return level;
  }
  const auto text = in.given.value("log-level");
  if (text && *text != "error") in.complain("--quiet: --log-level {} says something else", *text);
  return LogLevel::kError;
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

void read_common_into(ReadingCommand& command, Arguments& in) {
  command.json_file = in.given.text("json");
  command.page = page_given(in);
  command.force = in.given.flag("force");
  command.log_level = log_level(in);
  read_language_into(command, in);
}

// --- the control and the machine that a command line names ---------------------------------------

std::vector<std::string_view> target_names() {
  std::vector<std::string_view> names;
  for (const gcode::Control& target : gcode::controls()) names.push_back(target.name);
  return names;
}

// Null where the option was not given, and with a problem where there is none of that name.
const gcode::Control* built_in_target(std::string_view option, Arguments& in) {
  const auto name = in.given.value(option);
  if (!name) return nullptr;
  const gcode::Control* target = gcode::find_control(*name);
  if (target == nullptr) complain_of_name(option, *name, target_names(), in);
  return target;
}

// --machine, or that of the target (may be null) when that is not given, with what --grbl-settings
// says. Null when there is none, and when something was wrong, which is said then.
std::shared_ptr<const Machine> machine_given(const gcode::Control* target, Arguments& in,
                                             std::string_view option = "machine") {
  const auto choice = in.given.value(option);
  const auto settings = in.given.value("grbl-settings");
  std::shared_ptr<const Machine> machine;
  const std::string name = choice ? *choice : target != nullptr ? target->machine : "";
  if (choice || !name.empty()) {
    machine = choose_machine(name, "--machine", in.problems);
    if (machine == nullptr) return nullptr;
  }
  if (!settings) return machine;
  // The settings say that the control is grbl; only who says otherwise contradicts them.
  const bool contradicts = machine != nullptr && !is_grbl(machine->model);
  const Machine* base = contradicts && !choice ? nullptr : machine.get();
  return machine_with_grbl_settings(base, *settings, in.problems);
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

// `takes_profile`: the option --profile is that of a target; of `time` it is another thing.
GivenTarget target_given(Arguments& in, bool takes_profile = true) {
  GivenTarget wrong = {.built_in = nullptr, .profile = nullptr, .is_wrong = true};
  const auto name = in.given.value("target");
  const bool names_file = name && name->ends_with(".toml");
  const auto profile = takes_profile ? in.given.value("profile") : std::nullopt;
  if (names_file && profile) {
    in.complain("--profile: --target names a profile already");
    return wrong;
  }
  GivenTarget target;
  if (name && !names_file) {
    target.built_in = built_in_target("target", in);
    if (target.built_in == nullptr) return wrong;
  }
  const auto file = names_file ? name : profile;
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

// --word, and own-words of the profile (nullptr: there is none).
std::shared_ptr<const gcode::OwnWords> own_words_given(const TargetProfile* profile,
                                                       Arguments& in) {
  OwnWordList list = profile != nullptr ? profile->own_words : OwnWordList();
  std::vector<std::string> problems;
  for (const std::string& text : in.given.values("word")) list.add(text, problems);
  for (const std::string& problem : problems) in.complain("--word: {}", problem);
  return list.words();
}

// --drop
std::vector<std::string> dropped_given(Arguments& in) {
  std::vector<std::string> names;
  const auto possible = gcode::droppable_words();
  for (const std::string& name : in.given.values("drop")) {
    names.emplace_back(gcode::droppable_name(name));
    if (names.back().empty()) complain_of_name("drop", name, possible, in);
  }
  return names;
}

// --- smooth, and what batch has of it ------------------------------------------------------------

// The target that the program's own text names for certain; else says which are likely.
const gcode::Control* target_of_marks(SmoothingCommand& command, Arguments& in) {
  constexpr std::string_view kToDo =
      "batten targets lists all, batten setup keeps one for all programs";
  const std::string program = file_at(in, 0);
  std::string error;
  const auto source = program.empty() || program == "-"
                          ? std::nullopt
                          : gcode::SourceText::map_file(program, error);
  if (!source) {
    in.complain("--target: no target given; {}", kToDo);
    return nullptr;
  }
  const gcode::TargetMarks marks = gcode::target_marks(*source);
  if (marks.target.empty()) {
    in.complain("--target: for which control is {}? likely {}{}; {}", program,
                fmt::join(marks.likely, " or "),
                marks.evidence.empty() ? "" : fmt::format(" ({})", marks.evidence), kToDo);
    return nullptr;
  }
  command.origins.emplace_back("target", marks.evidence);
  return gcode::find_control(marks.target);
}

void read_target(SmoothingCommand& command, Arguments& in, bool by_marks) {
  command.origins = in.given.origins();
  GivenTarget target = target_given(in);
  if (target.is_wrong) return;
  command.options.target = target.control();
  if (target.profile != nullptr) {
    command.options.words = target.profile->words;
    command.options.profile = target.profile->file;
    command.profile = std::move(target.profile);
  }
  if (command.options.target != nullptr || in.given.flag("print-config")) return;
  if (by_marks) {
    command.options.target = target_of_marks(command, in);
  } else {
    in.complain(
        "--target: no target given; batten targets lists them, batten setup keeps one for all "
        "programs");
  }
}

// The target as the machine is set up, unless the profile says that itself. Either may be missing.
void set_up_target(const gcode::Control*& target, std::shared_ptr<const gcode::Control>& own_target,
                   const std::shared_ptr<const TargetProfile>& profile, const Machine* machine) {
  if (target == nullptr || machine == nullptr) return;
  if (profile != nullptr && profile->says_chords) return;
  own_target = target_on_machine(*target, *machine);
  target = own_target.get();
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
    const bool printed_only = option == "--target" && in.given.flag("print-config");
    if (!said && !follows && !printed_only) in.problems.push_back(std::move(problem));
  }
}

void read_lambda_into(double& lambda, Arguments& in) {
  const auto text = in.given.value("guo-lambda");
  if (!text) return;
  lambda = read_decimal("guo-lambda", *text, in).value_or(0);
  if (lambda < 0 || lambda >= 1) {
    in.complain("--guo-lambda: '{}', expected a number from 0 to below 1", *text);
  }
}

// What smooth and batch have in common, but for the progress.
void read_smooth_options(SmoothingCommand& command, Arguments& in, bool by_marks) {
  SmoothOptions& options = command.options;
  read_target(command, in, by_marks);
  command.own_machine = machine_given(options.target, in);
  options.machine = command.own_machine.get();
  set_up_target(options.target, command.own_target, command.profile, options.machine);
  const auto tolerance = tolerance_in(in.given.value("tolerance"), in, options.tolerance_inch);
  options.tolerance_mm = tolerance.value_or(options.tolerance_mm);
  options.one_tolerance = in.given.flag("one-tolerance");
  choose(options.tolerance_kind, "tolerance-kind", tolerance_kinds(), in);
  choose(options.side, "side", sides(), in);
  read_language_into(options, in);
  choose(options.method, "method", methods(), in);
  choose(options.output, "output", forms(), in);
  choose(options.prefer, "prefer", preferences(), in);
  choose(options.linearize, "linearize", linearizations(), in);
  if (const auto text = in.given.value("keep-corners")) {
    options.keep_corners_deg = read_decimal("keep-corners", *text, in);
  }
  choose(options.seam, "seam", seams(), in);
  read_lambda_into(options.guo_lambda, in);
  read_integer_into(options.threads, "threads", in);
  options.allowed = in.given.values("allow");
  options.own_words = own_words_given(command.profile.get(), in);
  options.keep_expressions = in.given.flag("keep-expressions");
  options.convert = in.given.flag("convert");
  command.drop = dropped_given(in);
  command.force = in.given.flag("force");
  command.strict = in.given.flag("strict");
}

// It would be in the way of another file, or there is none of this kind.
void check_certificate(const std::string& file, const std::vector<std::string>& others,
                       geometry::ToleranceKind kind, Arguments& in) {
  if (file.empty()) return;
  if (file == "-") in.complain("--certificate: a certificate is a file, - is none");
  if (in.given.has("drop")) {
    in.complain("--certificate: it is of the program as it was, and --drop changes that");
  }
  if (kind != geometry::ToleranceKind::kPath) {
    in.complain("--certificate: it is of --tolerance-kind path, not of band");
  }
  for (const std::string& other : others) {
    if (is_one_file(file, other)) {
      in.complain("--certificate: {} is a file of this command already", file);
    }
  }
}

void check_outputs(const SmoothCommand& command, Arguments& in) {
  const bool to_standard_output =
      command.output == "-" || (command.output.empty() && command.input == "-");
  if (command.in_place && !command.output.empty()) {
    in.complain("--in-place: the input is replaced, so --out cannot be given");
  }
  if (command.in_place && command.input == "-") {
    in.complain("--in-place: standard input cannot be replaced");
  }
  for (const auto& [option, file] :
       {std::pair("json", &command.json_file), std::pair("report", &command.page.file)}) {
    if (to_standard_output && *file == "-" && !command.dry_run) {
      in.complain("--{}: standard output already takes the program", option);
    }
  }
  const std::string output = command.output.empty() && command.input != "-"
                                 ? default_output_path(command.input).string()
                                 : command.output;
  if (is_one_file(command.output, command.input)) {
    in.complain("--out: {} is the input itself; --in-place replaces the input", command.output);
  }
  check_reports(command, {command.input, output}, in);
  check_certificate(command.certificate_file,
                    {command.input, output, command.json_file, command.page.file},
                    command.options.tolerance_kind, in);
  const bool no_file = to_standard_output || command.dry_run;
  if (no_file && !command.certificate_file.empty()) {
    in.complain("--certificate: it is of a file that is written, and none is");
  }
}

// --- verify, inspect -----------------------------------------------------------------------------

std::vector<std::string> allowed_given(Arguments& in) {
  std::vector<std::string> allowed = in.given.values("allow");
  add_problems(problems_of_allowed(allowed), in);
  return allowed;
}

VerifyCommand verify_command(Arguments& in) {
  VerifyCommand command;
  command.old_program = file_at(in, 0);
  command.new_program = file_at(in, 1);
  read_common_into(command, in);
  GivenTarget target = target_given(in);
  command.target = target.control();
  choose(command.tolerance_kind, "tolerance-kind", tolerance_kinds(), in);
  add_problems(problems_of_decimals(command.decimals, command.source, command.target), in);
  command.profile = std::move(target.profile);
  const auto machine = machine_given(command.target, in);
  set_up_target(command.target, command.own_target, command.profile, machine.get());
  command.own_words = own_words_given(command.profile.get(), in);
  command.allowed = allowed_given(in);
  command.drop = dropped_given(in);
  choose(command.side, "side", sides(), in);
  add_problems(problems_of_side(command.side, command.tolerance_kind), in);
  std::optional<double> inch;
  command.tolerance_mm =
      tolerance_in(in.given.value("tolerance"), in, inch).value_or(command.tolerance_mm);
  if (!(command.tolerance_mm > 0)) {
    in.complain("--tolerance: '{}', expected a length above 0, such as 0.01",
                in.given.text("tolerance"));
  }
  command.one_tolerance = in.given.flag("one-tolerance");
  check_files({"OLD", "NEW"}, in);
  check_reports(command, in.files, in);
  std::vector<std::string> others = in.files;
  others.push_back(command.json_file);
  command.certificate_file = in.given.text("certificate");
  check_certificate(command.certificate_file, others, command.tolerance_kind, in);
  command.twice = in.given.flag("second-check");
  return command;
}

InspectCommand inspect_command(Arguments& in) {
  InspectCommand command;
  command.input = file_at(in, 0);
  read_common_into(command, in);
  add_problems(problems_of_decimals(command.decimals, command.source, nullptr), in);
  GivenTarget target = target_given(in);
  command.runs_it = target.control();
  command.profile = std::move(target.profile);
  command.own_words = own_words_given(command.profile.get(), in);
  command.allowed = allowed_given(in);
  check_files({"IN"}, in);
  check_reports(command, in.files, in);
  return command;
}

// --- freecad, targets, methods, machines ---------------------------------------------------------

FreecadCommand freecad_command(Arguments& in) {
  const std::string action = in.files.size() == 1 ? in.files.front() : "";
  if (action != "install" && action != "uninstall") {
    in.complain("freecad: expected one word, install or uninstall");
  }
  return {.freecad = in.given.text("freecad"),
          .folder = in.given.text("folder"),
          .json_file = in.given.text("json"),
          .uninstall = action == "uninstall",
          .force = in.given.flag("force")};
}

ListCommand list_command(BuiltIn what, Arguments& in) {
  check_files({}, in);
  ListCommand command = {
      .what = what, .json_file = in.given.text("json"), .force = in.given.flag("force")};
  if (what == BuiltIn::kTargets) command.target = built_in_target("show", in);
  if (in.given.has("grbl-settings") || (what == BuiltIn::kMachines && in.given.has("show"))) {
    command.machine = machine_given(nullptr, in, "show");
  }
  return command;
}

MethodsCommand methods_command(Arguments& in) {
  check_files({}, in);
  MethodsCommand command;
  command.table_file = in.given.text("table");
  command.json_file = in.given.text("json");
  command.force = in.given.flag("force");
  std::optional<double> inches;
  command.tolerance_mm = tolerance_in(in.given.value("tolerance"), in, inches);
  read_lambda_into(command.guo_lambda, in);
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
  const auto index = whole_text<int>(std::string_view(*text).substr(0, slash));
  const auto count = slash == std::string::npos
                         ? std::nullopt
                         : whole_text<int>(std::string_view(*text).substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count) {
    in.complain("--shard: '{}', expected I/N with I from 1 to N, such as 2/8", *text);
    return;
  }
  shard = {*index, *count};
}

void check_trees(Arguments& in) {
  constexpr std::array<std::string_view, 2> kTrees = {"IN_TREE", "OUT_TREE"};
  for (std::size_t i = in.files.size(); i < kTrees.size(); ++i) {
    in.complain("{}: no folder given", kTrees[i]);
  }
  refuse_words_after(kTrees.size(), "folder", in);
  if (in.files.size() != kTrees.size()) return;
  add_problems(problems_of_trees(in.files[0], in.files[1]), in);
}

BatchCommand batch_command(Arguments& in) {
  BatchCommand command;
  read_smooth_options(command, in, false);
  check_options(command.options, in);
  command.settings = settings_text(in.given, command.own_machine.get());
  command.fail_fast = in.given.flag("fail-fast");
  command.pages = in.given.flag("pages");
  command.open = in.given.flag("open");
  command.json_file = in.given.text("json");
  command.suffixes = in.given.values("suffix");
  if (command.suffixes.empty()) {
    const auto usual = default_program_suffixes();
    command.suffixes.assign(usual.begin(), usual.end());
  }
  read_integer_into(command.jobs, "jobs", in);
  if (command.jobs < 0) {
    in.complain("--jobs: '{}', expected 0 or more", in.given.text("jobs"));
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
      in.complain("--from: '{}', expected X,Y,Z in mm, such as 0,0,50", *text);
      return std::nullopt;
    }
    const auto value = read_decimal("from", text->substr(begin, comma - begin), in);
    if (!value) return std::nullopt;
    place[axis] = *value;
    begin = comma + 1;
  }
  return place;
}

void check_time_outputs(const TimeCommand& command, Arguments& in) {
  check_reports(command, {command.input}, in);
  if (command.profile_file == "-" && (command.json_file == "-" || command.page.file == "-")) {
    in.complain("--profile: standard output already takes the report");
  }
  for (const std::string& other : {command.input, command.json_file, command.page.file}) {
    if (is_one_file(command.profile_file, other)) {
      in.complain("--profile: {} is another file of this command: {}", command.profile_file, other);
    }
  }
}

void read_override_into(TimeCommand& command, Arguments& in) {
  const auto text = in.given.value("feed-override");
  if (!text) return;
  const std::optional<double> percent = read_decimal("feed-override", *text, in);
  if (percent && !(*percent > 0)) {
    in.complain("--feed-override: '{}', expected percent above 0, such as 150", *text);
  }
  if (percent) command.feed_override = *percent / 100;
  for (const char* other : {"report", "open", "bound"}) {
    if (in.given.has(other)) {
      in.complain("--feed-override: not with --{}, which goes by the programmed feeds", other);
    }
  }
}

TimeCommand time_command(Arguments& in) {
  TimeCommand command;
  command.input = file_at(in, 0);
  command.profile_file = in.given.text("profile");
  read_common_into(command, in);
  const GivenTarget target = target_given(in, false);
  command.profile = target.profile;
  command.target = target.control();
  command.own_words = own_words_given(command.profile.get(), in);
  add_problems(problems_of_decimals(command.decimals, command.source, command.target), in);
  const std::size_t problems_before = in.problems.size();
  command.machine = machine_given(command.target, in);
  if (command.machine == nullptr && in.problems.size() == problems_before) {
    in.complain(
        "--machine: no machine given; `batten machines` lists them, a file NAME.toml is your own");
  }
  if (command.target == nullptr && command.machine != nullptr) {
    command.target = only_control_of(command.machine->model);
  }
  command.start = start_given(in);
  constexpr auto choice = [](FeedPlanner planner) {
    return Choice<FeedPlanner>{planner, name_of(planner), ""};
  };
  static constexpr std::array kPlanners = {
      choice(FeedPlanner::kControl), choice(FeedPlanner::kJerk), choice(FeedPlanner::kSCurve)};
  choose(command.planner, "planner", std::span<const Choice<FeedPlanner>>(kPlanners), in);
  read_override_into(command, in);
  command.bound = in.given.has("bound");
  std::optional<double> inch;
  command.tolerance_mm = tolerance_in(in.given.value("tolerance"), in, inch);
  if (command.tolerance_mm && !(*command.tolerance_mm > 0)) {
    in.complain("--tolerance: '{}', expected a length above 0, such as 0.01",
                in.given.text("tolerance"));
  }
  check_files({"FILE"}, in);
  check_time_outputs(command, in);
  return command;
}

}  // namespace

SmoothCommand smooth_command(Arguments& in) {
  SmoothCommand command;
  read_smooth_options(command, in, true);
  choose(command.progress, "progress", progress_styles(), in);
  command.log_level = log_level(in);
  // A bar is said too, but lines for LinuxCNC are not for people.
  const bool bar = command.progress == ProgressStyle::kAuto && !in.given.has("progress");
  if (bar && command.log_level < LogLevel::kInfo) command.progress = ProgressStyle::kOff;
  command.in_place = in.given.flag("in-place");
  command.dry_run = in.given.flag("dry-run");
  command.json_file = in.given.text("json");
  command.page = page_given(in);
  command.certificate_file = in.given.text("certificate");
  command.output = in.given.text("out");
  command.input = file_at(in, 0);
  check_options(command.options, in);
  if (!in.given.flag("print-config")) {
    check_files({"IN"}, in);
    check_outputs(command, in);
  }
  return command;
}

namespace {

// One for each tolerance, form and preference that may be. Curves only where they are asked for, or
// auto takes them: they are dear to make.
ExploreCommand explore_command(Arguments& in) {
  ExploreCommand command{smooth_command(in), {}, {}};
  SmoothOptions options = command.smooth.options;
  options.convert = false;
  std::vector<std::string> tolerances = in.given.values("tolerance");
  if (tolerances.empty()) tolerances = {"0.005", "0.01", "0.02", "0.05"};
  const bool curves = options.target != nullptr && options.target->curves_in_auto;
  for (const std::string& text : tolerances) {
    // What is wrong with the first has been said.
    if (&text != &tolerances.front() || !in.given.has("tolerance")) {
      options.tolerance_inch.reset();
      options.tolerance_mm = tolerance_in(text, in, options.tolerance_inch).value_or(1);
      check_options(options, in);
    }
    for (const auto& form : forms()) {
      const bool named = in.given.has("output");
      if (named ? form.value != command.smooth.options.output
                : form.value == Form::kCurves && !curves) {
        continue;
      }
      for (const auto& prefer : preferences()) {
        if (in.given.has("prefer") && prefer.value != options.prefer) continue;
        command.settings.push_back(options);
        command.settings.back().output = form.value;
        command.settings.back().prefer = prefer.value;
        if (!named && !problems_of(command.settings.back()).empty()) command.settings.pop_back();
      }
    }
  }
  for (const OptionRow& row : option_rows("explore")) {
    const bool explored = row.name == "output" || row.name == "prefer";
    if (!row.in_config || explored || row.name == "threads" || !in.given.has(row.name)) continue;
    std::vector<std::string> values = in.given.values(row.name);
    if (row.kind != OptionKind::kTexts) values = {fmt::format("{}", fmt::join(values, ","))};
    for (std::string& value : values) {
      command.options_of_smooth.push_back(fmt::format("--{}", row.name));
      command.options_of_smooth.push_back(std::move(value));
    }
  }
  return command;
}

}  // namespace

namespace {

// Each with what is given for it alone, and everything that is wrong with any of them.
SmoothFilesCommand smooth_files_command(Arguments& in) {
  SmoothFilesCommand command;
  for (const char* option : {"out", "json", "report", "certificate"}) {
    if (in.given.has(option))
      in.complain("--{}: is for one program; {} are given", option, in.files.size());
  }
  if (std::ranges::count(in.files, "-") > 0)
    in.complain("-: standard input is a program by itself");
  if (!in.problems.empty()) return command;
  const auto is_output_of = [](const std::string& file, const std::string& other) {
    return is_one_file(file, default_output_path(other).string());
  };
  std::set<std::string> problems;
  for (const std::string& file : in.files) {
    if (std::ranges::any_of(in.files,
                            [&](const std::string& each) { return is_output_of(file, each); })) {
      command.left_out.push_back(file);
      continue;
    }
    Arguments one = {in.given, {file}};
    complete_from_configs("smooth", file, one.given, one.problems);
    command.each.push_back(smooth_command(one));
    problems.insert(one.problems.begin(), one.problems.end());
    for (const SmoothCommand& each : std::span(command.each).first(command.each.size() - 1)) {
      if (is_one_file(each.input, file)) problems.insert(fmt::format("{}: is given twice", file));
    }
  }
  in.problems.assign(problems.begin(), problems.end());
  return command;
}

}  // namespace

Command command_of(std::string_view name, Arguments& in) {
  if (name == "smooth" && in.files.size() > 1 && !in.given.has("print-config")) {
    return smooth_files_command(in);
  }
  if (name == "setup") return setup_command(in);
  complete_from_configs(name, file_at(in, 0), in.given, in.problems);
  if (name == "smooth") {
    SmoothCommand command = smooth_command(in);
    if (in.given.flag("print-config")) return PrintText{config_text(in.given)};
    return command;
  }
  if (name == "explore") return explore_command(in);
  if (name == "verify") return verify_command(in);
  if (name == "inspect") return inspect_command(in);
  if (name == "time") return time_command(in);
  if (name == "batch") return batch_command(in);
  if (name == "freecad") return freecad_command(in);
  if (name == "machines") return list_command(BuiltIn::kMachines, in);
  if (name == "targets") return list_command(BuiltIn::kTargets, in);
  if (in.given.has("table")) return methods_command(in);
  for (const char* option : {"tolerance", "guo-lambda"}) {
    if (in.given.has(option)) in.complain("--{}: goes with --table", option);
  }
  return list_command(BuiltIn::kMethods, in);
}

void refuse_words_after(std::size_t expected, std::string_view what, Arguments& in) {
  for (std::size_t i = expected; i < in.files.size(); ++i) {
    in.complain("'{}': one {} too many", in.files[i], what);
  }
}

}  // namespace batten::postproc
