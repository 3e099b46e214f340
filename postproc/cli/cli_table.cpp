#include "postproc/cli/cli_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace batten::postproc {
namespace {

// --- options -------------------------------------------------------------------------------------

using enum OptionKind;
constexpr bool kInConfig = true;

constexpr OptionRow kJson = {"json", kValue, "FILE",
                             "write the report as JSON, - is standard output"};
constexpr OptionRow kForce = {"force", kFlag, "", "replace files that exist already"};
constexpr OptionRow kTolerance = {
    "tolerance",
    kValue,
    "LENGTH",
    "greatest distance between old and new path: 0.01, 0.01mm or 0.0005in (without a unit: mm)",
    "0.01mm",
    kInConfig};
constexpr OptionRow kToleranceKind = {
    "tolerance-kind",
    kValue,
    "path|band",
    "what the tolerance means: both ways, or corners may be further from the new path",
    "path",
    kInConfig};
constexpr OptionRow kSide = {"side",
                             kValue,
                             "both|left|right",
                             "where the new path may be, seen along the way of travel from above",
                             "both",
                             kInConfig};
constexpr OptionRow kUnits = {
    "units", kValue, "mm|inch", "units of a program that has no G20 or G21", "", kInConfig};
constexpr OptionRow kSource = {
    "source",
    kValue,
    "auto|ngc|fanuc|haas|grbl|siemens|heidenhain",
    "for which control the program was written; auto: what its marks and the target say",
    "auto",
    kInConfig};
constexpr OptionRow kDecimals = {
    "decimals",
    kValue,
    "auto|explicit|implied",
    "what X5 means on controls like FANUC: explicit 5 mm, implied 0.005 mm or 0.0005 in "
    "(implied:0.0001 for another increment in mm, a tenth of it in inches); auto: such "
    "blocks are kept",
    "auto",
    kInConfig};
constexpr OptionRow kAllow = {
    "allow",     kList,
    "REASON,..", "lift rules that keep runs, by their ids in the report; may be repeated",
    "",          kInConfig};
constexpr OptionRow kProfile = {
    "profile",   kValue,
    "FILE.toml", "the target as your machine has it (batten targets --show NAME prints one)",
    "",          kInConfig};
// Of every command that tells times.
constexpr OptionRow kMachine = {
    "machine",
    kValue,
    "NAME|FILE",
    "the machine whose time counts: built in (batten machines), a NAME.toml, or the "
    "NAME.ini of a LinuxCNC machine; default: the target's",
    "",
    kInConfig};
constexpr OptionRow kGrblSettings = {
    "grbl-settings", kValue, "FILE", "limits from what grbl answers to $$, saved as text", "",
    kInConfig};
constexpr OptionRow kQuiet = {"quiet", kFlag, "",
                              "say nothing but what ends or stops the work, as --log-level error"};
constexpr OptionRow kLogLevel = {"log-level", kValue, "error|warning|info",
                                 "how much is said on standard error", "info"};

std::vector<OptionRow> smooth_rows() {
  return {
      {"target", kValue, "NAME|FILE.toml",
       "the control that will run the program (batten targets), or a profile of it", "", kInConfig},
      kProfile,
      kTolerance,
      kToleranceKind,
      kSide,
      kMachine,
      kGrblSettings,
      {"method", kValue, "best|fair|racing|naseath|guo|ozcan|none",
       "how runs are smoothed (batten methods)", "best", kInConfig},
      {"output", kValue, "auto|curves|arcs|lines", "what rewritten runs are made of", "auto",
       kInConfig},
      {"prefer", kValue, "time|accuracy|size", "what the tolerance is spent on", "time", kInConfig},
      {"linearize", kValue, "minlink|chord|ilca|blca",
       "how lines are laid along a curve; default: chord, minlink with --prefer size", "",
       kInConfig},
      {"keep-corners", kValue, "DEG", "turns of more degrees than this stay corners", "",
       kInConfig},
      kUnits,
      kSource,
      kDecimals,
      kAllow,
      {"convert", kFlag, "",
       "take a program for other controls if every block says the same on the target", "false",
       kInConfig},
      {"out", kValue, "FILE",
       "the new program, - is standard output; default: IN with .smooth before the suffix"},
      {"in-place", kFlag, "", "replace the input itself"},
      kForce,
      {"dry-run", kFlag, "", "do everything but write the new program"},
      {"strict", kFlag, "", "write nothing and exit 3 when a run could not be proved", "false",
       kInConfig},
      kJson,
      {"report", kValue, "FILE.html",
       "write the report as a page for a browser: path, deviation, time by run"},
      {"threads", kValue, "N", "0: all cores; the result is the same for any number", "0",
       kInConfig},
      {"progress", kValue, "auto|on|off|linuxcnc", "how far the work is, on standard error", "auto",
       kInConfig},
      kQuiet,
      kLogLevel,
      {"config", kValue, "FILE.toml", "read options from a file; the command line goes first"},
      {"print-config", kFlag, "", "print the options as such a file and do nothing else"},
  };
}

std::vector<OptionRow> verify_rows() {
  return {
      kTolerance,
      kProfile,
      {"target", kValue, "NAME|FILE.toml",
       "the control whose own curves (G06.2, POLY, G5 ..) are to be read in both programs, or "
       "a profile of it"},
      kToleranceKind,
      kSide,
      kUnits,
      kSource,
      kDecimals,
      {"allow", kList, "REASON,..",
       "what smooth was allowed; subprogram: calls leave all modes as they find them, in both "
       "programs"},
      kJson,
      kForce,
      kQuiet,
      kLogLevel,
  };
}

std::vector<OptionRow> time_rows() {
  return {
      kMachine,
      kGrblSettings,
      {"target", kValue, "NAME",
       "the control the program is written for (batten targets): what G4 P means"},
      kUnits,
      kSource,
      kDecimals,
      {"from", kValue, "X,Y,Z", "the tool's position before the program, mm"},
      kJson,
      {"profile", kValue, "FILE.csv",
       "write position, feed, acceleration and jerk each millisecond"},
      kForce,
      kQuiet,
      kLogLevel,
  };
}

std::vector<OptionRow> own_batch_rows() {
  return {
      {"jobs", kValue, "N",
       "programs at a time, each in a process with one thread; 0: a processor each", "0"},
      {"shard", kValue, "I/N", "only every N-th program from the I-th on, for several machines",
       "1/1"},
      {"suffix", kList, "SUFFIX",
       "what is a program, in place of nc, ngc, tap, cnc, gcode, ncc, eia, iso; none: "
       "names without a suffix, all: every file; a list with commas, or repeated"},
      {"fail-fast", kFlag, "",
       "stop at the first program that cannot be written; otherwise carry on"},
      {"force", kFlag, "", "replace programs in OUT_TREE that no batch wrote"},
      {"progress", kValue, "auto|on|off",
       "a line with rate and time left on standard error; auto: on a terminal", "auto"},
      {"config", kValue, "FILE.toml",
       "read options of smooth from a file; the command line goes first"},
  };
}

std::vector<OptionRow> freecad_rows() {
  return {{"freecad", kValue, "PROGRAM",
           "the FreeCAD without a window that is asked; default: the one in PATH"},
          {"folder", kValue, "DIR", "write into this folder of macros and ask nobody"},
          {"force", kFlag, "", "replace a batten_post.py that is not ours"}};
}

std::vector<OptionRow> machines_rows() {
  return {{"show", kValue, "NAME|FILE",
           "print this machine as a file for --machine, with everything in it"},
          kGrblSettings,
          kJson,
          kForce};
}

// Those of `smooth` that a configuration file may hold, and own ones. A worker has one thread, and
// LinuxCNC does not look at a batch.
std::vector<OptionRow> batch_rows() {
  std::vector<OptionRow> rows = smooth_rows();
  std::erase_if(rows, [](const OptionRow& row) {
    return !row.in_config || row.name == "threads" || row.name == "progress";
  });
  for (const OptionRow& row : own_batch_rows()) rows.push_back(row);
  return rows;
}

// --- commands ------------------------------------------------------------------------------------

std::vector<CommandRow> make_command_rows() {
  return {
      {"smooth",
       "Bend fair curves through the short G01 moves of a program and write it again, proved.",
       smooth_rows(),
       {{"IN", "the program, - is standard input"}},
       "Example:\n"
       "  batten smooth part.nc --target linuxcnc --tolerance 0.01\n"
       "writes part.smooth.nc, nowhere more than 0.01 mm from part.nc."},
      {"verify",
       "Prove that a new program does what the old one did, within a tolerance.",
       verify_rows(),
       {{"OLD", "the old program"}, {"NEW", "the new program"}},
       "Example:\n"
       "  batten verify part.nc part.smooth.nc --tolerance 0.01\n"
       "exits with 0 when proved, with 3 on a violation or without a proof."},
      {"inspect",
       "Show the runs of a program, their segments, and why the rest would be kept.",
       {kUnits, kSource, kDecimals, kAllow, kJson, kForce, kQuiet, kLogLevel},
       {{"IN", "the program, - is standard input"}},
       "Example:\n  batten inspect part.nc --json part.json"},
      {"time",
       "Tell how long a machine needs for a program, and where the time goes.",
       time_rows(),
       {{"FILE", "the program, - is standard input"}},
       "Examples:\n"
       "  batten time part.nc --machine linuxcnc\n"
       "  batten time part.nc --machine mill --json part.json --from 0,0,50\n"
       "  batten time part.nc --machine router.toml --profile part.csv\n"
       "The profile has a row for each millisecond: t_s, line, x_mm, y_mm, z_mm,\n"
       "feed_mm_per_min, then acceleration (mm/s2) and jerk (mm/s3) of X, Y and Z.\n"
       "Times are those of the control's model; what the text does not tell is listed."},
      {"batch",
       "Smooth all programs of a folder tree into another one; a run that was stopped goes on.",
       batch_rows(),
       {{"IN_TREE", "the folder with the programs, never written to"},
        {"OUT_TREE", "the folder for the new ones, with reports in OUT_TREE/batten-batch"}},
       "Example:\n"
       "  batten batch programs smooth --target linuxcnc --tolerance 0.01"},
      {"freecad",
       "Put the post script for FreeCAD where FreeCAD looks for posts.",
       freecad_rows(),
       {{"ACTION", "install"}},
       "Example:\n"
       "  batten freecad install\n"
       "asks the installed FreeCAD for the folder of your macros and writes batten_post.py there."},
      {"targets",
       "List the controls that programs can be written for, or show one as a profile.",
       {{"show", kValue, "NAME", "print a profile of this target to start from"}, kJson, kForce},
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
      {"methods", "List the ways of smoothing.", {kJson, kForce}, {}, "Example:\n  batten methods"},
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
    ".TP\nAXIS_PROGRESS_BAR\nWhen 1, progress is written as LinuxCNC's filters do it.\n";

}  // namespace

const std::vector<CommandRow>& command_rows() {
  static const std::vector<CommandRow> rows = make_command_rows();
  return rows;
}

const std::vector<OptionRow>& option_rows(std::string_view command) {
  return std::ranges::find(command_rows(), command, &CommandRow::name)->rows;
}

std::string_view short_form_of(const OptionRow& row) { return row.name == "out" ? "-o" : ""; }

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
