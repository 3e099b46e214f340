#include "postproc/cli/cli_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "gcode/controls/built_in.h"
#include "gcode/state/reason.h"
#include "postproc/machine/machine.h"
#include "postproc/options/options.h"
#include "postproc/text/explain.h"
#include "postproc/text/words.h"

namespace batten::postproc {
namespace {

// --- options -------------------------------------------------------------------------------------

using enum OptionKind;
// Of the command line alone, and one that a configuration file may hold.
constexpr OptionRow option(std::string_view name, OptionKind kind, std::string_view value,
                           std::string_view help, std::string_view default_value = {}) {
  return {name, kind, value, help, default_value, false};
}
constexpr OptionRow setting(std::string_view name, OptionKind kind, std::string_view value,
                            std::string_view help, std::string_view default_value = {}) {
  return {name, kind, value, help, default_value, true};
}

constexpr OptionRow kJson =
    option("json", kValue, "FILE", "write the report as JSON, - is standard output");
constexpr OptionRow kCertificate =
    option("certificate", kValue, "FILE",
           "write the evidence of the proof, for a checker that needs no Batten");
constexpr OptionRow kReport =
    option("report", kValue, "FILE.html",
           "write the report as a page for a browser: the path first, then the figures");
constexpr OptionRow kOpen =
    option("open", kFlag, "",
           "show that page in the browser; without --report it is written to a temporary folder");
constexpr OptionRow kForce = option("force", kFlag, "", "replace files that exist already");
constexpr OptionRow kTolerance = setting(
    "tolerance", kValue, "LENGTH",
    "greatest distance between old and new path: 0.01, 0.01mm or 0.0005in (without a unit: mm)",
    "0.01mm");
constexpr OptionRow kOneTolerance =
    setting("one-tolerance", kFlag, "",
            "keep --tolerance in all parts, also where the program says less for a part (a comment "
            "TOLERANCE 0.005, CYCLE832, cycle 32)",
            "false");
constexpr OptionRow kToleranceKind = setting(
    "tolerance-kind", kValue, "path|band",
    "what the tolerance means: both ways, or corners may be further from the new path", "path");
constexpr OptionRow kSide =
    setting("side", kValue, "both|left|right",
            "where the new path may be, seen along the way of travel from above", "both");
constexpr OptionRow kSeam = setting(
    "seam", kValue, "corner|smooth",
    "the corner in which a closed path begins: it stays, or is rounded where two lines meet there",
    "corner");
constexpr OptionRow kUnits =
    setting("units", kValue, "mm|inch", "units of a program that has no G20 or G21");
constexpr OptionRow kSource = setting(
    "source", kValue, "auto|ngc|fanuc|haas|grbl|siemens|heidenhain",
    "for which control the program was written; auto: what its marks and the target say", "auto");
constexpr OptionRow kDecimals =
    setting("decimals", kValue, "auto|explicit|implied",
            "what X5 means on controls like FANUC: explicit 5 mm, implied 0.005 mm or 0.0005 in "
            "(implied:0.0001 for another increment in mm, a tenth of it in inches); auto: such "
            "blocks are kept",
            "auto");
constexpr OptionRow kAllow =
    setting("allow", kList, "REASON,..",
            "lift rules that keep runs, by their ids in the report; may be repeated");
constexpr OptionRow kWord = setting(
    "word", kTexts, "'WORD = EFFECT'",
    "what a word of your own does (docs/profiles.md): 'M501 = keeps state', 'G65 P9810 = moves', "
    "'M98 P9001 = keeps state, returns'; may be repeated");
constexpr OptionRow kDrop = setting(
    "drop", kList, "G64,..",
    "words of another control that are taken out of the program first: G64, G187, G5.1, G5");
constexpr OptionRow kTarget =
    setting("target", kValue, "NAME|FILE.toml",
            "the control that will run the program (batten targets), or a profile of it");
constexpr OptionRow kProfile =
    setting("profile", kValue, "FILE.toml",
            "the target as your machine has it (batten targets --show NAME prints one)");
// Of every command that tells times.
constexpr OptionRow kMachine =
    setting("machine", kValue, "NAME|FILE",
            "the machine whose time counts: built in (batten machines), a NAME.toml, the NAME.ini "
            "of a LinuxCNC machine or the NAME.cfg of one with Klipper; default: the target's");
constexpr OptionRow kGrblSettings =
    setting("grbl-settings", kValue, "FILE", "limits from what grbl answers to $$, saved as text");
constexpr OptionRow kQuiet =
    option("quiet", kFlag, "", "say nothing but what ends or stops the work, as --log-level error");
constexpr OptionRow kLogLevel =
    option("log-level", kValue, "error|warning|info", "how much is said on standard error", "info");

// "time|accuracy|size": how help calls a value that is one of these.
template <const auto& kChoices>
std::string_view one_of() {
  static const std::string names = [] {
    std::vector<std::string_view> each;
    for (const auto& choice : kChoices()) {
      if (choice.in_help) each.push_back(choice.name);
    }
    return fmt::format("{}", fmt::join(each, "|"));
  }();
  return names;
}

constexpr OptionRow kGuoLambda = setting(
    "guo-lambda", kValue, "0..1",
    "of guo-literal: the part of what a blend leaves of a side that the next one leaves too", "0");

std::vector<OptionRow> smooth_rows() {
  return {
      kTarget,
      kProfile,
      kTolerance,
      kOneTolerance,
      kToleranceKind,
      kSide,
      kMachine,
      kGrblSettings,
      setting("method", kValue, one_of<methods>(), "how runs are smoothed (batten methods)",
              "best"),
      setting("output", kValue, one_of<forms>(), "what rewritten runs are made of", "auto"),
      setting("prefer", kValue, one_of<preferences>(), "what the tolerance is spent on", "time"),
      setting("linearize", kValue, one_of<linearizations>(),
              "how lines are laid along a curve; default: chord, minlink with --prefer size"),
      setting("keep-corners", kValue, "DEG", "turns of more degrees than this stay corners"),
      kSeam,
      kGuoLambda,
      kUnits,
      kSource,
      kDecimals,
      kAllow,
      kDrop,
      kWord,
      setting("keep-expressions", kFlag, "",
              "leave blocks alone whose numbers are expressions of variables (Z[#<scale>*5])",
              "false"),
      setting("convert", kFlag, "",
              "take a program for other controls if every block says the same on the target",
              "false"),
      option("out", kValue, "FILE",
             "the new program, - is standard output; default: IN with .smooth before the suffix"),
      option("in-place", kFlag, "", "replace the input itself"),
      kForce,
      option("dry-run", kFlag, "", "do everything but write the new program"),
      setting("strict", kFlag, "", "write nothing and exit 3 when a run could not be proved",
              "false"),
      kJson,
      kReport,
      kOpen,
      kCertificate,
      setting("threads", kValue, "N", "0: all cores; the result is the same for any number", "0"),
      setting("progress", kValue, "auto|on|off|linuxcnc", "how far the work is, on standard error",
              "auto"),
      kQuiet,
      kLogLevel,
      option("config", kValue, "FILE.toml",
             "read options from a file; the command line goes first"),
      option("print-config", kFlag, "", "print the options as such a file and do nothing else")};
}

std::vector<OptionRow> setup_rows() {
  return {
      kTarget,       kMachine,
      kGrblSettings, kTolerance,
      kUnits,        option("out", kValue, "FILE", "the file to write", "config.toml of your own"),
      kJson,         option("force", kFlag, "", "replace a file that exists already")};
}

std::vector<OptionRow> verify_rows() {
  return {
      kTolerance,
      kOneTolerance,
      option("second-check", kFlag, "",
             "check flat sections a second way, too: by the region of the tolerance as polygons"),
      kProfile,
      option(
          "target", kValue, "NAME|FILE.toml",
          "the control whose own curves (G06.2, POLY, G5 ..) are to be read in both programs, or "
          "a profile of it"),
      setting("machine", kValue, "NAME|FILE",
              "the machine that the new program was made for, as in smooth: its settings say how "
              "the target cuts arcs"),
      kGrblSettings,
      kToleranceKind,
      kSide,
      kUnits,
      kSource,
      kDecimals,
      option(
          "allow", kList, "REASON,..",
          "what smooth was allowed; subprogram: calls leave all modes as they find them, in both "
          "programs"),
      kDrop,
      kWord,
      kJson,
      kReport,
      kOpen,
      kCertificate,
      kForce,
      kQuiet,
      kLogLevel};
}

std::vector<OptionRow> time_rows() {
  return {
      kMachine,
      kGrblSettings,
      option("target", kValue, "NAME|FILE.toml",
             "the control the program is written for (batten targets): what G4 P and its splines "
             "mean; or a "
             "profile of it"),
      kWord,
      kUnits,
      kSource,
      kDecimals,
      option("from", kValue, "X,Y,Z", "the tool's position before the program, mm"),
      option("planner", kValue, "control|jerk|s-curve",
             "what moves the axes: the machine's control; the least time within the limits of each "
             "axis, jerk among them; or S-curves from bend to bend [Naseath 2007]",
             "control"),
      option("feed-override", kValue, "PERCENT",
             "as with the feed override of the control at so many percent; rapids stay", "100"),
      option("bound", kFlag, "",
             "tell how much time is left to win in the runs, and where; not of moves under exact "
             "stop, which are kept"),
      option("tolerance", kValue, "LENGTH",
             "for --bound: by paths that are so near, 0.01, 0.01mm or 0.0005in; default: on "
             "the path as it is"),
      kJson,
      kReport,
      kOpen,
      option("profile", kValue, "FILE.csv",
             "write position, feed, acceleration and jerk each millisecond"),
      kForce,
      kQuiet,
      kLogLevel};
}

std::vector<OptionRow> machines_rows() {
  return {option("show", kValue, "NAME|FILE",
                 "print this machine as a file for --machine, with everything in it"),
          kGrblSettings, kJson, kForce};
}

// Those of `smooth` that a configuration file may hold, and own ones. A worker has one thread, and
// LinuxCNC does not look at a batch.
std::vector<OptionRow> batch_rows() {
  std::vector<OptionRow> rows = smooth_rows();
  std::erase_if(rows, [](const OptionRow& row) {
    return !row.in_config || row.name == "threads" || row.name == "progress";
  });
  rows.insert(
      rows.end(),
      {option("jobs", kValue, "N",
              "programs at a time, each in a process with one thread; 0: a processor each", "0"),
       option("shard", kValue, "I/N",
              "only every N-th program from the I-th on, for several machines", "1/1"),
       option("suffix", kList, "SUFFIX",
              "what is a program, in place of nc, ngc, tap, cnc, gcode, ncc, eia, iso, h, mpf, "
              "spf, arc, min, pim, anc, in either case; none: names without a suffix, all: every "
              "file; a list with commas, or repeated"),
       option("pages", kFlag, "",
              "write the page of each program (as smooth --report), to which "
              "batten-batch/index.html leads"),
       option("open", kFlag, "", "show batten-batch/index.html in the browser at the end"), kJson,
       option("fail-fast", kFlag, "",
              "stop at the first program that cannot be written; otherwise carry on"),
       option("force", kFlag, "", "replace programs in OUT_TREE that no batch wrote"),
       option("progress", kValue, "auto|on|off",
              "a line with rate and time left on standard error; auto: on a terminal", "auto"),
       option("config", kValue, "FILE.toml",
              "read options of smooth from a file; the command line goes first")});
  return rows;
}

// Those of `smooth` that say what is written, and lists of what is explored.
std::vector<OptionRow> explore_rows() {
  std::vector<OptionRow> rows = smooth_rows();
  std::erase_if(rows, [](const OptionRow& row) {
    return row.kind == kFlag && row.name != "force" && row.name != "quiet";
  });
  std::erase_if(rows, [](const OptionRow& row) {
    return row.name == "out" || row.name == "report" || row.name == "certificate";
  });
  for (OptionRow& row : rows) {
    if (row.name == "output" || row.name == "prefer") row.default_value = "each";
    if (row.name == "tolerance") {
      row = option("tolerance", kList, "LENGTH,..", "tolerances, each as smooth takes it",
                   "0.005,0.01,0.02,0.05");
    }
  }
  return rows;
}

// --- commands ------------------------------------------------------------------------------------

std::vector<CommandRow> make_command_rows() {
  return {
      {"smooth",
       "Bend fair curves through the short G01 moves of a program and write it again, proved.",
       smooth_rows(),
       {{"IN", "the program, or several; - is standard input"}},
       "Examples:\n"
       "  batten smooth part.nc --target linuxcnc --tolerance 0.01\n"
       "writes part.smooth.nc, nowhere more than 0.01 mm from part.nc.\n"
       "  batten smooth part.nc\n"
       "takes the options of a batten.toml beside part.nc or above it, then those that batten\n"
       "setup has kept; a target that neither names is the one that the program speaks of."},
      {"explore",
       "Show what other tolerances, forms and preferences would win, and recommend one.",
       explore_rows(),
       {{"FILE", "the program, - is standard input"}},
       "Examples:\n"
       "  batten explore part.nc --target linuxcnc\n"
       "  batten explore part.nc --target grbl --tolerance 0.01,0.02 --prefer time --json -\n"
       "Nothing is written. The recommended setting is smoothed and proved as smooth does it. Of\n"
       "the others smooth may keep a run that counts here, and find fewer blocks."},
      {"setup",
       "Keep a control, its machine, a tolerance and units for all programs of yours.",
       setup_rows(),
       {},
       "Examples:\n"
       "  batten setup\n"
       "asks for them and writes them to ~/.config/batten/config.toml.\n"
       "  batten setup --target grbl --grbl-settings settings.txt --tolerance 0.02\n"
       "  batten setup --target linuxcnc --machine mill.ini -o batten.toml\n"
       "A batten.toml counts for the programs in its folder and below it, before your own "
       "options.\n"
       "batten smooth part.nc --print-config shows where each value comes from."},
      {"verify",
       "Prove that a new program does what the old one did, within a tolerance.",
       verify_rows(),
       {{"OLD", "the old program"}, {"NEW", "the new program"}},
       "Example:\n"
       "  batten verify part.nc part.smooth.nc --tolerance 0.01\n"
       "exits with 0 when proved, with 3 on a violation or without a proof."},
      {"inspect",
       "Show the runs of a program, their segments, and why the rest would be kept.",
       {option("target", kValue, "NAME|FILE.toml",
               "the control that will run it, or a profile of it, whose own words are taken: what "
               "it may "
               "make of small circles is noted"),
        kProfile, kUnits, kSource, kDecimals, kAllow, kWord, kJson, kReport, kOpen, kForce, kQuiet,
        kLogLevel},
       {{"IN", "the program, - is standard input"}},
       "Examples:\n"
       "  batten inspect part.nc --json part.json\n"
       "  batten inspect part.nc --open"},
      {"time",
       "Tell how long a machine needs for a program, and where the time goes.",
       time_rows(),
       {{"FILE", "the program, - is standard input"}},
       "Examples:\n"
       "  batten time part.nc --machine linuxcnc\n"
       "  batten time part.nc --machine mill --json part.json --from 0,0,50\n"
       "  batten time part.nc --machine router.toml --profile part.csv\n"
       "  batten time part.nc --machine router --bound --tolerance 0.01\n"
       "  batten time part.nc --machine high-speed --planner jerk\n"
       "  batten time part.nc --machine mill --feed-override 150\n"
       "The profile has a row for each millisecond: t_s, line, x_mm, y_mm, z_mm,\n"
       "feed_mm_per_min, then acceleration (mm/s2) and jerk (mm/s3) of X, Y and Z.\n"
       "Times are those of the control's model; what the text does not tell is listed. With or\n"
       "without a planner, motion rests at the end of each block under exact stop (G60, G61.1,\n"
       "G9; G61 on controls that stop for it)."},
      {"batch",
       "Smooth all programs of a folder tree into another one; a run that was stopped goes on.",
       batch_rows(),
       {{"IN_TREE", "the folder with the programs, never written to"},
        {"OUT_TREE", "the folder for the new ones, with reports in OUT_TREE/batten-batch"}},
       "Example:\n"
       "  batten batch programs smooth --target linuxcnc --tolerance 0.01"},
      {"freecad",
       "Put the post script for FreeCAD where FreeCAD looks for posts, or remove it.",
       {option("freecad", kValue, "PROGRAM",
               "the FreeCAD without a window that is asked; default: the one in PATH"),
        option("folder", kValue, "DIR", "the folder of your macros; FreeCAD is not asked"), kJson,
        option("force", kFlag, "", "replace or remove a batten_post.py that is not ours")},
       {{"ACTION", "install or uninstall"}},
       "Example:\n"
       "  batten freecad install\n"
       "asks the installed FreeCAD for the folder of your macros and writes batten_post.py there;\n"
       "batten freecad uninstall removes it."},
      {"targets",
       "List the controls that programs can be written for, or show one as a profile.",
       {option("show", kValue, "NAME", "print a profile of this target to start from"), kJson,
        kForce},
       {},
       "Example:\n"
       "  batten targets --show haas > mine.toml\n"
       "prints a profile; batten smooth part.nc --target mine.toml reads it."},
      {"machines",
       "List the built-in machines, or print one machine as a file.",
       machines_rows(),
       {},
       "Examples:\n"
       "  batten machines\n"
       "  batten machines --show router > my.toml\n"
       "  batten machines --show mill.ini\n"
       "  batten machines --grbl-settings settings.txt > my.toml"},
      {"methods",
       "List the ways of smoothing, or what each makes of the paths of a file.",
       {option("table", kValue, "FILE.json",
               "paths as lists of points (docs/algorithms/methods.md), - is standard input"),
        option("tolerance", kValue, "LENGTH", "of all these paths, in place of the file's"),
        kGuoLambda, kJson, kForce},
       {},
       "Examples:\n"
       "  batten methods\n"
       "  batten methods --table docs/algorithms/polylines.json\n"
       "prints for each path and method the time by the planner, the greatest curvature, the\n"
       "proved deviation and the number of lines and cubics."},
      {"explain",
       "Say what the id of a kept run, a message or a violation means, and what to do about it.",
       {},
       {{"ID", "as in a report; without it, all of them are listed"}},
       "Example:\n  batten explain exact-stop"},
      {"completion",
       "Write the completion of commands and options for a shell.",
       {},
       {{"SHELL", "bash or zsh"}},
       "Example:\n  batten completion bash > ~/.local/share/bash-completion/completions/batten"},
      {"man", "Write the manual page.", {}, {}, "Example:\n  batten man | man -l -"},
  };
}

// --- completions of shells -----------------------------------------------------------------------

// "path|band": lower-case words between bars. "NAME|FILE.toml" is no list of names.
std::vector<std::string_view> names_in(std::string_view value) {
  std::vector<std::string_view> names;
  if (value.find('|') == std::string_view::npos) return names;
  const bool plain = std::ranges::all_of(value, [](char c) {
    return std::islower(static_cast<unsigned char>(c)) != 0 || c == '|' || c == '-';
  });
  if (!plain) return names;
  while (!value.empty()) {
    const std::size_t end = std::min(value.find('|'), value.size());
    names.push_back(value.substr(0, end));
    value.remove_prefix(std::min(end + 1, value.size()));
  }
  return names;
}

// What a word without dashes can be.
std::vector<std::string_view> names_for_file(std::string_view file) {
  if (file == "ID") return explained_ids();
  if (file == "SHELL") return {"bash", "zsh"};
  return {};
}

// The values that an option can have, where they are names: those of its help ("time|size"), the
// targets, the machines, the reasons that can be lifted.
std::vector<std::string_view> names_for(const OptionRow& row) {
  std::vector<std::string_view> names = names_in(row.value);
  if (row.name == "target") {
    for (const gcode::Control& control : gcode::controls()) names.push_back(control.name);
  } else if (row.name == "machine") {
    for (const Machine& machine : built_in_machines()) names.emplace_back(machine.name);
  } else if (row.name == "allow") {
    for (const auto& each : gcode::reason::explanations()) {
      if (each.can_be_allowed) names.push_back(each.id);
    }
  }
  return names;
}

// Whether the option's value can be a file.
bool takes_file(const OptionRow& row) {
  return row.value.find("FILE") != std::string_view::npos ||
         row.value.find("DIR") != std::string_view::npos ||
         row.value.find("TREE") != std::string_view::npos;
}

// --- bash ---------------------------------------------------------------------------------------

std::string bash_values(const CommandRow& command) {
  std::string cases;
  for (const OptionRow& row : command.rows) {
    if (row.kind == OptionKind::kFlag) continue;
    const std::string_view brief = short_form_of(row);
    const std::string name = fmt::format("--{}{}{}", row.name, brief.empty() ? "" : "|", brief);
    const auto names = names_for(row);
    cases += fmt::format("        {}) _batten_reply {} \"{}\"; return ;;\n", name,
                         takes_file(row) ? "files" : "names", fmt::join(names, " "));
  }
  return cases;
}

std::string bash_command(const CommandRow& command) {
  std::vector<std::string> options;
  for (const OptionRow& row : command.rows) options.push_back(fmt::format("--{}", row.name));
  std::vector<std::string_view> words;
  bool files = false;
  for (const auto& [name, help] : command.files) {
    const auto names = names_for_file(name);
    words.insert(words.end(), names.begin(), names.end());
    files = files || names.empty();
  }
  return fmt::format(
      "    {})\n"
      "      case $previous in\n{}      esac\n"
      "      if [[ $word == -* ]]; then _batten_reply names \"{} --help\"\n"
      "      else _batten_reply {} \"{}\"; fi ;;\n",
      command.name, bash_values(command), fmt::join(options, " "), files ? "files" : "names",
      fmt::join(words, " "));
}

// --- zsh ----------------------------------------------------------------------------------------

// For the inside of '..[help]..' of _arguments.
std::string zsh_text(std::string_view text) {
  return escaped(text, {{'\'', "'\\''"}, {'[', "\\["}, {']', "\\]"}, {':', "\\:"}, {'\\', "\\\\"}});
}

std::string zsh_value(const OptionRow& row) {
  const auto names = names_for(row);
  const std::string title = zsh_text(row.value);
  if (takes_file(row) && !names.empty()) {
    // Names first, files too.
    return fmt::format(":{}:{{compadd -- {}; _files}}", title, fmt::join(names, " "));
  }
  if (takes_file(row)) return fmt::format(":{}:_files", title);
  return fmt::format(":{}:({})", title, fmt::join(names, " "));
}

std::string zsh_option(const OptionRow& row) {
  const std::string help = zsh_text(row.help);
  const std::string_view brief = short_form_of(row);
  if (row.kind == OptionKind::kFlag) return fmt::format("'--{}[{}]'", row.name, help);
  const std::string_view again = may_be_repeated(row) ? "*" : "";
  std::string text = fmt::format("'{}--{}=[{}]{}'", again, row.name, help, zsh_value(row));
  if (!brief.empty()) text += fmt::format(" \\\n        '{}[{}]{}'", brief, help, zsh_value(row));
  return text;
}

std::string zsh_command(const CommandRow& command) {
  std::string text = fmt::format("    {})\n      _arguments", command.name);
  for (const OptionRow& row : command.rows) text += " \\\n        " + zsh_option(row);
  text += " \\\n        '--help[show the options]'";
  std::size_t place = 0;
  for (const auto& [name, help] : command.files) {
    const auto names = names_for_file(name);
    text += fmt::format(
        " \\\n        '{}:{}:{}'", ++place, zsh_text(name),
        names.empty() ? std::string("_files") : fmt::format("({})", fmt::join(names, " ")));
  }
  return text + " ;;\n";
}

std::string bash_completion() {
  std::vector<std::string_view> commands;
  std::string cases;
  for (const CommandRow& command : command_rows()) {
    commands.push_back(command.name);
    cases += bash_command(command);
  }
  return fmt::format(
      "# Completion of batten for bash, made by `batten completion bash`.\n"
      "\n"
      "_batten_reply() {{  # files|names WORDS\n"
      "  COMPREPLY=($(compgen -W \"$2\" -- \"$word\"))\n"
      "  [[ $1 == files ]] || return 0\n"
      "  local file\n"
      "  compopt -o filenames 2>/dev/null\n"
      "  while IFS= read -r file; do COMPREPLY+=(\"$file\"); done < <(compgen -f -- \"$word\")\n"
      "}}\n"
      "\n"
      "_batten() {{\n"
      "  COMPREPLY=()\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}}\n"
      "  if (( COMP_CWORD == 1 )); then\n"
      "    _batten_reply names \"{} --help --version --explain\"\n"
      "    return\n"
      "  fi\n"
      "  case ${{COMP_WORDS[1]}} in\n"
      "{}"
      "    --explain) _batten_reply names \"{}\" ;;\n"
      "  esac\n"
      "}}\n"
      "\n"
      "complete -F _batten batten\n",
      fmt::join(commands, " "), cases, fmt::join(explained_ids(), " "));
}

std::string zsh_completion() {
  std::string commands;
  std::string cases;
  for (const CommandRow& command : command_rows()) {
    commands += fmt::format("    '{}:{}'\n", command.name, zsh_text(command.description));
    cases += zsh_command(command);
  }
  return fmt::format(
      "#compdef batten\n"
      "# Completion of batten for zsh, made by `batten completion zsh`.\n"
      "\n"
      "_batten() {{\n"
      "  local -a commands\n"
      "  commands=(\n{}  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  local command=$words[2]\n"
      "  shift words\n"
      "  (( CURRENT-- ))\n"
      "  case $command in\n"
      "{}"
      "  esac\n"
      "}}\n"
      "\n"
      "_batten \"$@\"\n",
      commands, cases);
}

// --- the manual page -----------------------------------------------------------------------------

// Text that roff prints as it stands: backslashes and dashes are meant, a point or an apostrophe at
// the beginning of a line is no request.
std::string roff(std::string_view text) {
  std::string safe;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) safe += "\\&";
    if (c == '\\') {
      safe += "\\e";
    } else if (c == '-') {
      safe += "\\-";
    } else {
      safe += c;
    }
    begins = c == '\n';
  }
  return safe;
}

std::string option_text(const OptionRow& row) {
  std::string head = "\\fB" + roff(fmt::format("--{}", row.name)) + "\\fR";
  const std::string_view brief = short_form_of(row);
  if (!brief.empty()) head = "\\fB" + roff(brief) + "\\fR, " + head;
  if (row.kind != OptionKind::kFlag) head += " \\fI" + roff(row.value) + "\\fR";
  std::string help(row.help);
  if (!row.default_value.empty() && row.kind != OptionKind::kFlag) {
    help += fmt::format("; default: {}", row.default_value);
  }
  return fmt::format(".TP\n{}\n{}.\n", head, roff(help));
}

std::string command_text(const CommandRow& command) {
  std::string synopsis = fmt::format("\\fBbatten {}\\fR", roff(command.name));
  for (const auto& [name, help] : command.files) {
    synopsis += fmt::format(" \\fI{}\\fR", roff(name));
  }
  if (!command.rows.empty()) synopsis += " [\\fIoptions\\fR]";
  std::string text = fmt::format(".SS {}\n{}\n", synopsis, roff(command.description));
  for (const auto& [name, help] : command.files) {
    text += fmt::format(".TP\n\\fI{}\\fR\n{}.\n", roff(name), roff(help));
  }
  for (const OptionRow& row : command.rows) text += option_text(row);
  text += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(command.example));
  return text;
}

constexpr std::string_view kDescription =
    "Batten takes a CNC program that a CAM system wrote as thousands of short G01 lines, bends "
    "smooth\ncurves through them within a tolerance, and writes the program again as arcs or "
    "lines. "
    "It then reads\nits own output back and proves that the new path is nowhere further from the "
    "old one than allowed;\nwhat it does not understand or cannot prove, it copies byte for byte.\n"
    "A - in place of a file is standard input or output. Messages and progress go to standard "
    "error.";

constexpr std::string_view kExitStatus =
    ".TP\n0\nDone; for verify: proved.\n.TP\n1\nWrong options; no file was touched.\n.TP\n2\nThe "
    "input is not understood; nothing was written.\n.TP\n3\nNot proved, or verify found a "
    "violation.\n.TP\n4\nA file could not be read or written.\n.TP\n5\nInternal error; nothing was "
    "written.\n";

constexpr std::string_view kEnvironment =
    ".TP\nBATTEN_CONFIG\nA file with options, as --config takes it; a batten.toml near the program "
    "goes before it.\n.TP\nXDG_CONFIG_HOME\nThe folder with batten/config.toml, which batten setup "
    "writes; default: ~/.config.\n.TP\nAXIS_PROGRESS_BAR\nWhen 1, progress is written as "
    "LinuxCNC's filters do it.\n";

}  // namespace

const std::vector<CommandRow>& command_rows() {
  static const std::vector<CommandRow> rows = make_command_rows();
  return rows;
}

const std::vector<OptionRow>& option_rows(std::string_view command) {
  return std::ranges::find(command_rows(), command, &CommandRow::name)->rows;
}

std::string_view short_form_of(const OptionRow& row) {
  return row.name == "out" ? "-o" : row.name == "target" ? "-t" : "";
}

std::optional<std::string> completion_for(std::string_view shell) {
  if (shell == "bash") return bash_completion();
  if (shell == "zsh") return zsh_completion();
  return std::nullopt;
}

std::string man_page() {
  std::string text = fmt::format(
      ".\\\" Made by `batten man`.\n"
      ".TH BATTEN 1 \"\" \"batten {}\" \"User Commands\"\n"
      ".SH NAME\nbatten \\- smooth CNC programs made of short lines, and prove what was written\n"
      ".SH SYNOPSIS\n\\fBbatten\\fR \\fIcommand\\fR [\\fIoptions\\fR] [\\fIfiles\\fR]\n"
      ".SH DESCRIPTION\n{}\n.SH COMMANDS\n",
      roff(BATTEN_VERSION), roff(kDescription));
  for (const CommandRow& command : command_rows()) text += command_text(command);
  text += ".SH EXIT STATUS\n";
  text += kExitStatus;
  text += ".SH ENVIRONMENT\n";
  text += kEnvironment;
  text +=
      ".SH COPYRIGHT\nFree software under the GNU General Public License, version 3 or later.\n";
  return text;
}

}  // namespace batten::postproc
