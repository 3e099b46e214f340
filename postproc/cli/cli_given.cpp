#include "postproc/cli/cli_given.h"

#include <algorithm>
#include <array>

namespace batten::postproc {

namespace {

constexpr OptionRow kJson = {
    .name = "json", .value = "FILE", .help = "write the report as JSON, - is standard output"};
constexpr OptionRow kForce = {
    .name = "force", .kind = OptionKind::kFlag, .help = "replace files that exist already"};
constexpr OptionRow kTolerance = {
    .name = "tolerance",
    .value = "LENGTH",
    .help =
        "greatest distance between old and new path: 0.01, 0.01mm or 0.0005in (without a "
        "unit: mm)",
    .default_value = "0.01mm",
    .in_config = true};
constexpr OptionRow kToleranceKind = {
    .name = "tolerance-kind",
    .value = "path|band",
    .help = "what the tolerance means: both ways, or corners may be further from the new path",
    .default_value = "path",
    .in_config = true};
constexpr OptionRow kSide = {
    .name = "side",
    .value = "both|left|right",
    .help = "where the new path may be, seen along the way of travel from above",
    .default_value = "both",
    .in_config = true};
constexpr OptionRow kUnits = {.name = "units",
                              .value = "mm|inch",
                              .help = "units of a program that has no G20 or G21",
                              .in_config = true};
constexpr OptionRow kSource = {
    .name = "source",
    .value = "auto|ngc|fanuc|haas|grbl|siemens|heidenhain",
    .help = "for which control the program was written; auto: what its marks and the target say",
    .default_value = "auto",
    .in_config = true};
constexpr OptionRow kDecimals = {
    .name = "decimals",
    .value = "auto|explicit|implied",
    .help =
        "what X5 means on controls like FANUC: explicit 5 mm, implied 0.005 mm or 0.0005 in "
        "(implied:0.0001 for another increment in mm, a tenth of it in inches); auto: such "
        "blocks are kept",
    .default_value = "auto",
    .in_config = true};
constexpr OptionRow kAllow = {
    .name = "allow",
    .kind = OptionKind::kList,
    .value = "REASON,..",
    .help = "lift rules that keep runs, by their ids in the report; may be repeated",
    .in_config = true};

constexpr OptionRow kProfile = {
    .name = "profile",
    .value = "FILE.toml",
    .help = "the target as your machine has it (batten targets --show NAME prints one)",
    .in_config = true};
// Of every command that tells times.
constexpr OptionRow kMachine = {
    .name = "machine",
    .value = "NAME|FILE",
    .help =
        "the machine whose time counts: built in (batten machines), a NAME.toml, or the "
        "NAME.ini of a LinuxCNC machine; default: the target's",
    .in_config = true};
constexpr OptionRow kGrblSettings = {.name = "grbl-settings",
                                     .value = "FILE",
                                     .help = "limits from what grbl answers to $$, saved as text",
                                     .in_config = true};

constexpr OptionRow kQuiet = {
    .name = "quiet",
    .kind = OptionKind::kFlag,
    .help = "say nothing but what ends or stops the work, as --log-level error"};
constexpr OptionRow kLogLevel = {.name = "log-level",
                                 .value = "error|warning|info",
                                 .help = "how much is said on standard error",
                                 .default_value = "info"};

constexpr std::array kSmoothRows = {
    OptionRow{.name = "target",
              .value = "NAME|FILE.toml",
              .help = "the control that will run the program (batten targets), or a profile of it",
              .in_config = true},
    kProfile,
    kTolerance,
    kToleranceKind,
    kSide,
    kMachine,
    kGrblSettings,
    OptionRow{.name = "method",
              .value = "best|fair|racing|naseath|guo|ozcan|none",
              .help = "how runs are smoothed (batten methods)",
              .default_value = "best",
              .in_config = true},
    OptionRow{.name = "output",
              .value = "auto|curves|arcs|lines",
              .help = "what rewritten runs are made of",
              .default_value = "auto",
              .in_config = true},
    OptionRow{.name = "prefer",
              .value = "time|accuracy|size",
              .help = "what the tolerance is spent on",
              .default_value = "time",
              .in_config = true},
    OptionRow{.name = "linearize",
              .value = "minlink|chord|ilca|blca",
              .help = "how lines are laid along a curve; default: chord, minlink with --prefer "
                      "size",
              .in_config = true},
    OptionRow{.name = "keep-corners",
              .value = "DEG",
              .help = "turns of more degrees than this stay corners",
              .in_config = true},
    kUnits,
    kSource,
    kDecimals,
    kAllow,
    OptionRow{
        .name = "convert",
        .kind = OptionKind::kFlag,
        .help = "take a program for other controls if every block says the same on the target",
        .default_value = "false",
        .in_config = true},
    OptionRow{.name = "out",
              .value = "FILE",
              .help = "the new program, - is standard output; default: IN with .smooth before "
                      "the suffix"},
    OptionRow{.name = "in-place", .kind = OptionKind::kFlag, .help = "replace the input itself"},
    kForce,
    OptionRow{.name = "dry-run",
              .kind = OptionKind::kFlag,
              .help = "do everything but write the new program"},
    OptionRow{.name = "strict",
              .kind = OptionKind::kFlag,
              .help = "write nothing and exit 3 when a run could not be proved",
              .default_value = "false",
              .in_config = true},
    kJson,
    OptionRow{.name = "report",
              .value = "FILE.html",
              .help = "write the report as a page for a browser: path, deviation, time by run"},
    OptionRow{.name = "threads",
              .value = "N",
              .help = "0: all cores; the result is the same for any number",
              .default_value = "0",
              .in_config = true},
    OptionRow{.name = "progress",
              .value = "auto|on|off|linuxcnc",
              .help = "how far the work is, on standard error",
              .default_value = "auto",
              .in_config = true},
    kQuiet,
    kLogLevel,
    OptionRow{.name = "config",
              .value = "FILE.toml",
              .help = "read options from a file; the command line goes first"},
    OptionRow{.name = "print-config",
              .kind = OptionKind::kFlag,
              .help = "print the options as such a file and do nothing else"},
};

constexpr std::array kTargetListRows = {
    OptionRow{
        .name = "show", .value = "NAME", .help = "print a profile of this target to start from"},
    kJson, kForce};
constexpr OptionRow kCurvesOf = {
    .name = "target",
    .value = "NAME|FILE.toml",
    .help =
        "the control whose own curves (G06.2, POLY, G5 ..) are to be read in both programs, or "
        "a profile of it"};

constexpr OptionRow kAllowedBefore = {
    .name = "allow",
    .kind = OptionKind::kList,
    .value = "REASON,..",
    .help =
        "what smooth was allowed; subprogram: calls leave all modes as they find them, in both "
        "programs"};

constexpr std::array kVerifyRows = {kTolerance, kProfile, kCurvesOf, kToleranceKind, kSide,
                                    kUnits,     kSource,  kDecimals, kAllowedBefore, kJson,
                                    kForce,     kQuiet,   kLogLevel};
constexpr std::array kInspectRows = {kUnits, kSource, kDecimals, kAllow,
                                     kJson,  kForce,  kQuiet,    kLogLevel};
constexpr std::array kTimeRows = {
    kMachine,
    kGrblSettings,
    OptionRow{.name = "target",
              .value = "NAME",
              .help = "the control the program is written for (batten targets): what G4 P means"},
    kUnits,
    kSource,
    kDecimals,
    OptionRow{
        .name = "from", .value = "X,Y,Z", .help = "where the tool stands before the program, mm"},
    kJson,
    OptionRow{.name = "profile",
              .value = "FILE.csv",
              .help = "write place, feed, acceleration and jerk each millisecond"},
    kForce,
    kQuiet,
    kLogLevel,
};
// A worker has one thread, and LinuxCNC does not look at a batch.
constexpr std::array<std::string_view, 2> kNotForBatch = {"threads", "progress"};

constexpr std::array kOwnBatchRows = {
    OptionRow{.name = "jobs",
              .value = "N",
              .help = "programs at a time, each in a process with one thread; 0: a processor each",
              .default_value = "0"},
    OptionRow{.name = "shard",
              .value = "I/N",
              .help = "only every N-th program from the I-th on, for several machines",
              .default_value = "1/1"},
    OptionRow{.name = "suffix",
              .kind = OptionKind::kList,
              .value = "SUFFIX",
              .help =
                  "what is a program, in place of nc, ngc, tap, cnc, gcode, ncc, eia, iso; none: "
                  "names without a suffix, all: every file; a list with commas, or repeated"},
    OptionRow{.name = "fail-fast",
              .kind = OptionKind::kFlag,
              .help = "stop at the first program that cannot be written; otherwise carry on"},
    OptionRow{.name = "force",
              .kind = OptionKind::kFlag,
              .help = "replace programs in OUT_TREE that no batch wrote"},
    OptionRow{.name = "progress",
              .value = "auto|on|off",
              .help = "a line with rate and time left on standard error; auto: on a terminal",
              .default_value = "auto"},
    OptionRow{.name = "config",
              .value = "FILE.toml",
              .help = "read options of smooth from a file; the command line goes first"},
};

std::vector<OptionRow> make_batch_rows() {
  std::vector<OptionRow> rows;
  for (const OptionRow& row : kSmoothRows) {
    if (row.in_config && std::ranges::find(kNotForBatch, row.name) == kNotForBatch.end()) {
      rows.push_back(row);
    }
  }
  rows.insert(rows.end(), kOwnBatchRows.begin(), kOwnBatchRows.end());
  return rows;
}

constexpr std::array kFreecadRows = {
    OptionRow{.name = "freecad",
              .value = "PROGRAM",
              .help = "the FreeCAD without a window that is asked; default: the one in PATH"},
    OptionRow{.name = "folder",
              .value = "DIR",
              .help = "write into this folder of macros and ask nobody"},
    OptionRow{.name = "force",
              .kind = OptionKind::kFlag,
              .help = "replace a batten_post.py that is not ours"},
};

constexpr std::array kListRows = {kJson, kForce};
constexpr std::array kMachinesRows = {
    OptionRow{.name = "show",
              .value = "NAME|FILE",
              .help = "print this machine as a file for --machine, with everything in it"},
    kGrblSettings, kJson, kForce};

}  // namespace

std::span<const OptionRow> smooth_rows() { return kSmoothRows; }
std::span<const OptionRow> verify_rows() { return kVerifyRows; }
std::span<const OptionRow> inspect_rows() { return kInspectRows; }
std::span<const OptionRow> target_list_rows() { return kTargetListRows; }
std::span<const OptionRow> time_rows() { return kTimeRows; }
std::span<const OptionRow> batch_rows() {
  static const std::vector<OptionRow> rows = make_batch_rows();
  return rows;
}
std::span<const OptionRow> freecad_rows() { return kFreecadRows; }
std::span<const OptionRow> list_rows() { return kListRows; }
std::span<const OptionRow> machines_rows() { return kMachinesRows; }

void Given::add(std::string_view name, std::string value) {
  values_[std::string(name)].push_back(std::move(value));
}

void Given::add_list(std::string_view name, std::string_view values) {
  constexpr std::string_view kBlanks = " \t";
  for (std::size_t begin = 0; begin <= values.size();) {
    const std::size_t end = std::min(values.find(',', begin), values.size());
    std::string_view part = values.substr(begin, end - begin);
    part.remove_prefix(std::min(part.find_first_not_of(kBlanks), part.size()));
    part = part.substr(0, part.find_last_not_of(kBlanks) + 1);
    add(name, std::string(part));
    begin = end + 1;
  }
}

bool Given::has(std::string_view name) const { return values_.contains(name); }

bool Given::flag(std::string_view name) const { return value(name) == "true"; }

std::optional<std::string> Given::value(std::string_view name) const {
  const auto found = values_.find(name);
  if (found == values_.end() || found->second.empty()) return std::nullopt;
  return found->second.front();
}

std::vector<std::string> Given::values(std::string_view name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? std::vector<std::string>{} : found->second;
}

void Given::complete_from(const Given& other) {
  for (const auto& [name, values] : other.values_) values_.try_emplace(name, values);
}

}  // namespace batten::postproc
