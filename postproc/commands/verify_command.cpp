#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/proof/point_spelling.h"
#include "postproc/proof/verification.h"
#include "postproc/stream/added_lines.h"
#include "postproc/stream/chunk_reader.h"
#include "postproc/stream/part_verification.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

namespace {

// More breaches than this tell nothing new on a screen; the JSON report has them all.
constexpr std::size_t kMostViolations = 20;

struct Read {
  gcode::SourceText source;
  gcode::Program program;
  gcode::Interpretation interpretation;
  gcode::Diagnostics diagnostics;
};

// The one that is named, or that the profile adapts.
const gcode::Control* target_of(const VerifyCommand& command) {
  if (command.target != nullptr) return command.target;
  return command.profile != nullptr ? &command.profile->adapted : nullptr;
}

const gcode::CurveFormat* curves_of(const VerifyCommand& command) {
  const gcode::Control* target = target_of(command);
  return target != nullptr ? target->curves : nullptr;
}

Promise promise_of(const VerifyCommand& command) {
  return {command.tolerance_mm, command.tolerance_kind, command.side, target_of(command)};
}

std::optional<gcode::Language> language_of_target(const VerifyCommand& command) {
  const gcode::Control* target = target_of(command);
  return target != nullptr ? std::optional(target->language) : std::nullopt;
}

// The language of the old program, where it was converted: the target reads another one, and the
// new program is in that. A text without certain marks counts as plain words.
std::optional<gcode::Language> language_before(const gcode::SourceText& old_source,
                                               const gcode::SourceText& new_source,
                                               const VerifyCommand& command) {
  const auto target = language_of_target(command);
  if (!target) return std::nullopt;
  gcode::Diagnostics uncertain;
  const auto before = gcode::source_language(old_source, command.source, std::nullopt, uncertain);
  const auto after =
      gcode::source_language(new_source, gcode::SourceKind::kAuto, std::nullopt, uncertain);
  return before != target && after == target ? before : std::nullopt;
}

// `language`: what a text without certain marks is read in; nothing: as the target reads.
// `dwells`: what its G4 means.
Read read(const gcode::SourceText& source, const VerifyCommand& command, gcode::SourceKind kind,
          std::optional<gcode::Language> language, gcode::DwellForm dwells) {
  gcode::Diagnostics found;
  const auto own = gcode::source_language(source, kind,
                                          language ? language : language_of_target(command), found);
  const gcode::Language certain = own.value_or(gcode::Language::kRs274);
  const gcode::Decimals decimals =
      gcode::decimals_read(kind, target_of(command), certain, command.decimals);
  gcode::Program program = gcode::parse(source, {certain, decimals, command.units, dwells}, found);
  gcode::tell_of_contradictions(program, kind, found);
  gcode::Interpretation interpretation =
      gcode::interpret(program,
                       {.units = command.units,
                        .curves = curves_of(command),
                        .calls_keep_modes = calls_keep_modes(command.allowed)},
                       found);
  return {source, std::move(program), std::move(interpretation), std::move(found)};
}

std::string_view name_of(ViolationKind kind) {
  switch (kind) {
    case ViolationKind::kDistance:
      return "distance";
    case ViolationKind::kNotProved:
      return "not-proved";
    case ViolationKind::kSide:
      return "side";
    case ViolationKind::kCrossing:
      return "crossing";
    case ViolationKind::kFeed:
      return "feed";
    case ViolationKind::kRapid:
      return "rapid";
    case ViolationKind::kEvent:
      return "event";
    case ViolationKind::kTarget:
      return "target";
    case ViolationKind::kState:
      break;
  }
  return "state";
}

std::string text_of(const Violation& violation, const VerifyCommand& command) {
  const std::string place = violation.new_line > 0
                                ? fmt::format("{}:{}", command.new_program, violation.new_line)
                                : fmt::format("{}:{}", command.old_program, violation.old_line);
  const std::string old_place =
      violation.new_line > 0 && violation.old_line > 0
          ? fmt::format(" (line {} of the old program)", violation.old_line)
          : "";
  return fmt::format("{}: {}: {}{}\n", place, violation.id, violation.message, old_place);
}

std::string summary_of(const Verification& verification, const VerifyCommand& command) {
  if (!verification.proved()) {
    return fmt::format("NOT PROVED: {} of the new program against the old one\n",
                       verification.violations.size() == 1
                           ? "1 breach"
                           : fmt::format("{} breaches", verification.violations.size()));
  }
  const bool band = command.tolerance_kind == geometry::ToleranceKind::kBand;
  const std::string corners =
      verification.corner_mm > 0
          ? fmt::format(", of a corner from the new path {:.4f} mm", verification.corner_mm)
          : "";
  return fmt::format(
      "proved: {} keeps {:g} mm to {}, {}\n"
      "  greatest deviation {:.4f} mm{}{}; {} changed stretches, {} acting words and blocks the "
      "same\n",
      command.new_program, command.tolerance_mm, command.old_program,
      band ? "in order, in the band reading" : "both ways and in order", verification.deviation_mm,
      verification.deviation_line > 0 ? fmt::format(" near line {}", verification.deviation_line)
                                      : "",
      corners, verification.stretches.size(), verification.events_compared);
}

Json json_of(const Stretch& stretch) {
  const geometry::PathComparison& comparison = stretch.comparison;
  return {{"old_first_line", stretch.old_first_line},
          {"old_last_line", stretch.old_last_line},
          {"new_first_line", stretch.new_first_line},
          {"new_last_line", stretch.new_last_line},
          {"proved", comparison.verdict == geometry::Verdict::kProved},
          {"at_least_mm", comparison.bounds.at_least},
          {"at_most_mm", std::isfinite(comparison.bounds.at_most) ? Json(comparison.bounds.at_most)
                                                                  : Json(nullptr)},
          {"certificate_size", comparison.certificate_size}};
}

std::string json_report(const Verification& verification, const VerifyCommand& command,
                        const gcode::Diagnostics& of_new, const gcode::SourceText& new_source) {
  Json violations = Json::array();
  for (const Violation& violation : verification.violations) {
    violations.push_back({{"kind", name_of(violation.kind)},
                          {"id", violation.id},
                          {"old_line", violation.old_line},
                          {"new_line", violation.new_line},
                          {"deviation_mm", violation.deviation_mm},
                          {"message", violation.message}});
  }
  Json stretches = Json::array();
  for (const Stretch& stretch : verification.stretches) {
    stretches.push_back(json_of(stretch));
  }
  return json_text({{"batten", BATTEN_VERSION},
                    {"old", command.old_program},
                    {"new", command.new_program},
                    {"tolerance_mm", command.tolerance_mm},
                    {"tolerance_kind", postproc::name_of(command.tolerance_kind)},
                    {"side", postproc::name_of(command.side)},
                    {"proved", verification.proved()},
                    {"deviation_mm", verification.deviation_mm},
                    {"deviation_line", verification.deviation_line},
                    {"corner_mm", verification.corner_mm},
                    {"events_compared", verification.events_compared},
                    {"breaches", std::move(violations)},
                    {"stretches", std::move(stretches)},
                    {"diagnostics", diagnostics_json(of_new, new_source)}});
}

// Moves without a unit are an error among the diagnostics: a tolerance means nothing then.
bool is_understood(const Read& read, LogLevel level) {
  print(read.diagnostics, read.source, level);
  return !gcode::has_error(read.diagnostics);
}

// 0 when written or not asked for; else says why and returns the exit code.
int write_json(const VerifyCommand& command, const Verification& verification,
               const gcode::Diagnostics& of_new, const gcode::SourceText& new_source) {
  if (command.json_file.empty()) return 0;
  return write_result(command.json_file, json_report(verification, command, of_new, new_source),
                      command.force);
}

// Both are told.
bool either_changed(const WatchedFile& one, const WatchedFile& other) {
  const bool one_changed = changed_while_read(one);
  return changed_while_read(other) || one_changed;
}

// The same bytes do the same on every control, in any unit, and whether they are understood here
// or not.
int accept_same_bytes(const VerifyCommand& command, const gcode::SourceText& source) {
  if (command.log_level >= LogLevel::kInfo) {
    say_lines(fmt::format("proved: {} and {} are the same, byte for byte\n", command.new_program,
                          command.old_program));
  }
  if (command.json_file.empty()) return 0;
  const Read same =
      read(source, command, command.source, std::nullopt, gcode::dwells_of(command.source));
  return write_json(command, {}, same.diagnostics, source);
}

// The new program without the lines that a profile may add; as it is where there is no profile.
AddedLines without_added_lines(const VerifyCommand& command, const Read& before,
                               const gcode::SourceText& new_source) {
  ProfileWords words;
  if (command.profile != nullptr) {
    gcode::Units units = gcode::Units::kUnknown;
    for (const gcode::ModalState& state : before.interpretation.states) {
      if (units == gcode::Units::kUnknown) units = state.units;
    }
    words =
        filled_in(command.profile->words, command.tolerance_mm, units, command.profile->adapted);
  }
  return take_added_lines(before.program, new_source.text(), words);
}

// Nothing says for which control the programs are, nor how it counts numbers without a point.
bool is_control_open(const VerifyCommand& command) {
  return target_of(command) == nullptr && command.source == gcode::SourceKind::kAuto &&
         !command.decimals;
}

void compare_points(const VerifyCommand& command, const gcode::SourceText& old_source,
                    const gcode::SourceText& new_source, Verification& verification) {
  if (!is_control_open(command)) return;
  if (auto violation = other_point_spelling(old_source, new_source)) {
    verification.violations.push_back(std::move(*violation));
  }
}

void append(const std::vector<Violation>& violations, Verification& verification) {
  verification.violations.insert(verification.violations.end(), violations.begin(),
                                 violations.end());
}

// Says what was found, and returns the exit code. `added`: lines of a profile, which are not
// compared.
int tell(const VerifyCommand& command, const Verification& verification, std::size_t added,
         const gcode::Diagnostics& of_new, const gcode::SourceText& new_source) {
  for (std::size_t i = 0; i < verification.violations.size() && i < kMostViolations; ++i) {
    say_lines(text_of(verification.violations[i], command));
  }
  if (verification.violations.size() > kMostViolations) {
    say(fmt::format("{} more breaches, see --json",
                    verification.violations.size() - kMostViolations));
  }
  if (!verification.proved() || command.log_level >= LogLevel::kInfo) {
    say_lines(summary_of(verification, command));
  }
  if (added > 0 && verification.proved()) {
    say_lines(
        fmt::format("  besides {} lines that the profile {} adds, whose effect on the control "
                    "is not known here\n",
                    added, command.profile->file));
  }
  const int code = write_json(command, verification, of_new, new_source);
  return verification.proved() ? code : static_cast<int>(ExitCode::kNotProved);
}

// How a program of the RS-274 family is read in parts; nothing for others.
std::optional<PartReading> part_reading(const gcode::SourceText& source,
                                        const VerifyCommand& command) {
  gcode::Diagnostics uncertain;
  const auto language =
      gcode::source_language(source, command.source, language_of_target(command), uncertain);
  if (language != gcode::Language::kRs274) return std::nullopt;
  PartReading reading;
  reading.source = command.source;
  reading.decimals =
      gcode::decimals_read(command.source, target_of(command), *language, command.decimals);
  reading.dwells = gcode::dwells_of(command.source);
  reading.options = {.units = command.units,
                     .curves = curves_of(command),
                     .calls_keep_modes = calls_keep_modes(command.allowed)};
  return reading;
}

// Long programs that are proved part by part; nothing: the whole is to be asked.
std::optional<VerifiedInParts> proved_in_parts(const VerifyCommand& command,
                                               const gcode::SourceText& old_source,
                                               const gcode::SourceText& new_source) {
  const std::size_t size = std::max(old_source.text().size(), new_source.text().size());
  if (size < kBytesForParts || command.profile != nullptr) return std::nullopt;
  const auto old_reading = part_reading(old_source, command);
  const auto new_reading = part_reading(new_source, command);
  for (const gcode::SourceText* source : {&old_source, &new_source}) {
    source->release_pages({0, static_cast<std::uint32_t>(source->text().size())});
  }
  if (!old_reading || !new_reading) return std::nullopt;
  return verify_in_parts({old_source, *old_reading}, {new_source, *new_reading},
                         promise_of(command), interrupted);
}

}  // namespace

int run(const VerifyCommand& command) {
  const WatchedFile old_watched(command.old_program);
  const WatchedFile new_watched(command.new_program);
  const auto old_source = read_program(command.old_program);
  const auto new_source = read_program(command.new_program);
  if (interrupted()) return end_interrupted();
  if (!old_source || !new_source) return static_cast<int>(ExitCode::kFileError);
  if (old_source->text() == new_source->text()) {
    if (either_changed(old_watched, new_watched)) return static_cast<int>(ExitCode::kFileError);
    return accept_same_bytes(command, *new_source);
  }

  if (auto parts = proved_in_parts(command, *old_source, *new_source)) {
    compare_points(command, *old_source, *new_source, parts->verification);
    if (either_changed(old_watched, new_watched)) return static_cast<int>(ExitCode::kFileError);
    print(parts->of_old, *old_source, command.log_level);
    print(parts->of_new, *new_source, command.log_level);
    return tell(command, parts->verification, 0, parts->of_new, *new_source);
  }
  if (interrupted()) return end_interrupted();
  const auto foreign = language_before(*old_source, *new_source, command);
  const Read before =
      read(*old_source, command, command.source, foreign, gcode::dwells_of(command.source));
  const AddedLines added = without_added_lines(command, before, *new_source);
  const Read after = read(gcode::SourceText(new_source->name(), added.text), command,
                          foreign ? gcode::SourceKind::kAuto : command.source,
                          foreign ? *language_of_target(command) : before.program.language,
                          foreign ? target_of(command)->dwell_form : before.program.dwells);
  if (either_changed(old_watched, new_watched)) return static_cast<int>(ExitCode::kFileError);
  if (!is_understood(before, command.log_level)) {
    say("the old program is not understood, so nothing can be proved about the new one");
    return static_cast<int>(ExitCode::kNotUnderstood);
  }
  if (!is_understood(after, command.log_level)) {
    say("NOT PROVED: the new program is not understood, and the old one is");
    return static_cast<int>(ExitCode::kNotProved);
  }
  Verification verification =
      verify({.program = &before.program, .interpretation = &before.interpretation},
             {.program = &after.program, .interpretation = &after.interpretation},
             promise_of(command));
  if (interrupted()) return end_interrupted();
  if (either_changed(old_watched, new_watched)) return static_cast<int>(ExitCode::kFileError);
  if (before.program.language == gcode::Language::kRs274 &&
      after.program.language == gcode::Language::kRs274) {
    compare_points(command, *old_source, *new_source, verification);
  }
  append(added.violations, verification);
  append(events_in_brackets({.program = &after.program, .interpretation = &after.interpretation},
                            added.brackets),
         verification);

  return tell(command, verification, added.lines, after.diagnostics, after.source);
}

}  // namespace batten::postproc
