#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/foreign_file.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "postproc/commands/certificate_file.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/convert/conversion.h"
#include "postproc/proof/certificate.h"
#include "postproc/proof/verification.h"
#include "postproc/report/html_report.h"
#include "postproc/report/own_words_report.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/part_reader.h"
#include "postproc/stream/part_verification.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/text/json_values.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

// More violations than this tell nothing new on a screen; the JSON report has them all.
constexpr std::size_t kMostViolations = 20;

std::optional<gcode::Language> language_of_target(const VerifyCommand& command) {
  return command.target != nullptr ? std::optional(command.target->language) : std::nullopt;
}

// The language of the old program, where it was converted: the target reads another one, and the
// new program is in that. A text without certain marks counts as plain words.
std::optional<gcode::Language> language_before(const gcode::SourceText& old_source,
                                               const gcode::SourceText& new_source,
                                               const VerifyCommand& command) {
  const auto target = language_of_target(command);
  if (!target) return std::nullopt;
  const auto before = language_before_target(old_source, command.source, *target);
  const auto after = language_before_target(new_source, gcode::SourceKind::kAuto, *target);
  return before != target && after == target ? before : std::nullopt;
}

// By ViolationKind.
constexpr std::array<std::string_view, 9> kKindNames = {
    "distance", "not-proved", "side", "crossing", "feed", "rapid", "event", "state", "target"};

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

std::string second_check_text(const Verification& verification, const VerifyCommand& command) {
  if (!command.twice) return "";
  const auto flat = std::ranges::count_if(verification.sections, &ComparedSection::in_region);
  return fmt::format(
      "  second check: {} of {} changed sections lie in one plane; each path of them lies in the "
      "region of the tolerance about the other, and passes its holes on the same side\n",
      flat, verification.sections.size());
}

// ", 2 of them within 0.002 to 0.005 mm as the old program says"
std::string closer_sections_text(const Verification& verification, const VerifyCommand& command) {
  std::vector<double> closer;
  for (const ComparedSection& section : verification.sections) {
    if (section.tolerance_mm < command.tolerance_mm) closer.push_back(section.tolerance_mm);
  }
  if (closer.empty()) return "";
  const auto [least, greatest] = std::ranges::minmax(closer);
  const std::string to = greatest > least ? fmt::format(" to {:g}", greatest) : "";
  return fmt::format(", {} of them within {:g}{} mm as the old program says", closer.size(), least,
                     to);
}

std::string summary_of(const Verification& verification, const VerifyCommand& command) {
  if (!verification.proved()) {
    return fmt::format("NOT PROVED: {} of the new program against the old one\n",
                       plural(verification.violations.size(), "violation"));
  }
  const bool band = command.tolerance_kind == geometry::ToleranceKind::kBand;
  const std::string corners =
      verification.corner_mm > 0
          ? fmt::format(", of a corner from the new path {:.4f} mm", verification.corner_mm)
          : "";
  return fmt::format(
             "proved: {} keeps {:g} mm to {}, {}\n"
             "  greatest deviation {:.4f} mm{}{}; {}{}, {} acting words and blocks the same\n",
             command.new_program, command.tolerance_mm, command.old_program,
             band ? "in order, in the band reading" : "both ways and in order",
             verification.deviation_mm,
             verification.deviation_line > 0
                 ? fmt::format(" near line {}", verification.deviation_line)
                 : "",
             corners, plural(verification.sections.size(), "changed section"),
             closer_sections_text(verification, command), verification.events_compared) +
         second_check_text(verification, command);
}

Json json_of(const ComparedSection& section) {
  const geometry::PathComparison& comparison = section.comparison;
  return {{"old_first_line", section.old_first_line},
          {"old_last_line", section.old_last_line},
          {"new_first_line", section.new_first_line},
          {"new_last_line", section.new_last_line},
          {"tolerance_mm", section.tolerance_mm},
          {"proved", comparison.verdict == geometry::Verdict::kProved},
          {"at_least_mm", comparison.bounds.at_least},
          {"at_most_mm", comparison.bounds.at_most},  // infinite: null
          {"certificate_size", comparison.certificate_size},
          {"in_region", section.in_region}};
}

Json json_of(const Violation& violation) {
  return {{"kind", kKindNames.at(static_cast<std::size_t>(violation.kind))},
          {"id", violation.id},
          {"old_line", violation.old_line},
          {"new_line", violation.new_line},
          {"deviation_mm", violation.deviation_mm},
          {"message", violation.message}};
}

Json json_of(const Verification& verification, const VerifyCommand& command,
             const std::vector<CalledFile>& called, const gcode::Diagnostics& of_new,
             const gcode::SourceText& new_source) {
  const auto item = [](const auto& each) { return json_of(each); };
  Json json = as_report("verify", {{"old", command.old_program},
                                   {"new", command.new_program},
                                   {"tolerance_mm", command.tolerance_mm},
                                   {"one_tolerance", command.one_tolerance},
                                   {"tolerance_kind", name_of(command.tolerance_kind)},
                                   {"side", name_of(command.side)},
                                   {"words", own_words_json(command.own_words)},
                                   {"proved", verification.proved()},
                                   {"deviation_mm", verification.deviation_mm},
                                   {"deviation_line", verification.deviation_line},
                                   {"corner_mm", verification.corner_mm},
                                   {"events_compared", verification.events_compared},
                                   {"violations", json_list(verification.violations, item)},
                                   {"sections", json_list(verification.sections, item)},
                                   {"diagnostics", diagnostics_json(of_new, new_source)}});
  if (!called.empty()) json["called"] = called_json(called);
  return json;
}

// Moves without a unit are an error among the diagnostics: a tolerance means nothing then.
int end_not_understood(gcode::Diagnostics& of_old, const gcode::SourceText& source,
                       const VerifyCommand& command) {
  print(of_old, source, command.log_level, command.command_line);
  say("the old program is not understood, so nothing can be proved about the new one");
  return static_cast<int>(ExitCode::kNotUnderstood);
}

Promise promise_of(const VerifyCommand& command) {
  Promise promise(command.tolerance_mm, command.tolerance_kind, command.side, command.target);
  promise.twice = command.twice;
  return promise;
}

// The two programs, as they were read and compared.
struct Compared {
  const TextToVerify& before;
  const TextToVerify& after;
  const std::vector<CalledFile>& called;
  std::size_t dropped = 0;  // words of the old one
};

// JSON and page. 0 when written or not asked for; else says why and returns the exit code.
int write_reports(const VerifyCommand& command, const Verification& verification,
                  const gcode::Diagnostics& of_new, const Compared& texts) {
  if (command.json_file.empty() && !command.page.is_wanted()) return 0;
  Json json = json_of(verification, command, texts.called, of_new, texts.after.source);
  if (!command.drop.empty()) json["dropped"] = {{"names", command.drop}, {"words", texts.dropped}};
  write_report(command.json_file, command.force, [&] { return json_text(json); });
  if (!command.page.is_wanted()) return 0;
  std::vector<PageLines> rows;
  for (const ComparedSection& section : verification.sections) {
    rows.push_back({section.old_first_line, section.old_last_line});
  }
  gcode::Diagnostics said_before;
  const gcode::ReadPart before = read_whole(texts.before.source, texts.before.reading, said_before);
  const gcode::ReadPart after = read_whole(texts.after.source, texts.after.reading, said_before);
  const PageOf page{"verify", json, command.new_program, command.command_line, rows};
  return write_page(command.page, command.force, command.new_program,
                    html_report(page, {&before.program, &before.meaning},
                                {&after.program, &after.meaning}, promise_of(command)));
}

// Both are told.
bool either_changed(const WatchedFile& one, const WatchedFile& other) {
  const bool one_changed = changed_while_read(one);
  return changed_while_read(other) || one_changed;
}

// The same bytes of a program do the same on every control, in any unit, and whether they are
// understood here or not.
int accept_same_bytes(const VerifyCommand& command, const gcode::SourceText& source) {
  if (!gcode::foreign_kind_of(source.text()).empty()) {
    gcode::Diagnostics found;
    (void)gcode::source_language(source, command.source, std::nullopt, found);
    print(std::as_const(found), source, command.log_level);
    return static_cast<int>(ExitCode::kNotUnderstood);
  }
  if (command.log_level >= LogLevel::kInfo) {
    say_lines(fmt::format("proved: {} and {} are the same, byte for byte\n", command.new_program,
                          command.old_program));
  }
  const int certificate = write_certificate(command, source, source);
  if (certificate != 0) return certificate;
  if (command.json_file.empty() && !command.page.is_wanted()) return 0;
  const TextToVerify text{source,
                          reading_of(source, command, command.source, language_of_target(command),
                                     gcode::dwells_of(command.source))};
  gcode::Diagnostics found = text.reading.of_language;
  (void)read_whole(source, text.reading, found);
  return write_reports(command, {}, found, {text, text, {}});
}

// The new program without the lines that a profile may add; as it is where there is no profile.
AddedLines without_added_lines(const VerifyCommand& command, const TextToVerify& before,
                               const gcode::SourceText& new_source) {
  gcode::Diagnostics ignored;
  const gcode::ReadPart read = read_whole(before.source, before.reading, ignored);
  gcode::Units units = gcode::Units::kUnknown;
  for (const gcode::ModalState& state : read.meaning.states) {
    if (units == gcode::Units::kUnknown) units = state.units;
  }
  return take_added_lines(
      read.program, new_source.text(),
      filled_in(command.profile->words, command.tolerance_mm, units, command.profile->adapted));
}

// Where nothing says for which control the programs are, nor how it counts numbers without a point.
void compare_points(const VerifyCommand& command, const gcode::SourceText& old_source,
                    const gcode::SourceText& new_source, Verification& verification) {
  if (command.target != nullptr || command.source != gcode::SourceKind::kAuto || command.decimals) {
    return;
  }
  if (auto violation = other_point_spelling(old_source, new_source)) {
    verification.violations.push_back(std::move(*violation));
  }
}

// Both programs, and how each is read.
struct BothTexts {
  TextToVerify before;
  gcode::SourceText compared;  // the new one, where the lines of a profile are empty
  PartReading after;
  AddedLines added;
  CalledFiles called = {};  // both call the same programs, those beside the old one
};

BothTexts both_texts(const VerifyCommand& command, const gcode::SourceText& old_source,
                     const gcode::SourceText& new_source) {
  const auto foreign = language_before(old_source, new_source, command);
  BothTexts both{{old_source, reading_of(old_source, command, command.source,
                                         foreign ? foreign : language_of_target(command),
                                         gcode::dwells_of(command.source))},
                 new_source,
                 {},
                 {}};
  if (!foreign) {
    both.called = read_called_files(old_source, command.old_program, both.before.reading.text);
  }
  both.before.reading.options.subprograms = both.called.programs;
  if (command.profile != nullptr) {
    both.added = without_added_lines(command, both.before, new_source);
    both.compared = gcode::SourceText(new_source.name(), std::move(both.added.text));
  }
  both.after = foreign
                   ? reading_of(both.compared, command, gcode::SourceKind::kAuto,
                                language_of_target(command), command.target->dwell_form)
                   : reading_of(both.compared, command, command.source,
                                both.before.reading.text.language, both.before.reading.text.dwells);
  both.after.options.subprograms = both.called.programs;
  return both;
}

// Says what was found, and returns the exit code. `added`: lines of a profile, which are not
// compared.
int tell(const VerifyCommand& command, const Verification& verification, std::size_t added,
         const gcode::Diagnostics& of_new, const Compared& texts) {
  for (std::size_t i = 0; i < verification.violations.size() && i < kMostViolations; ++i) {
    say_lines(text_of(verification.violations[i], command));
  }
  if (verification.violations.size() > kMostViolations) {
    say(fmt::format("{} more violations, see --json",
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
  if (verification.proved() && texts.dropped > 0) {
    say_lines(fmt::format("  but for {} that --drop takes out of the old program ({})\n",
                          plural(texts.dropped, "word"), fmt::join(command.drop, ", ")));
  }
  if (verification.proved() && command.log_level >= LogLevel::kInfo) {
    say_lines(text_of(texts.called) + own_words_text(command.own_words));
  }
  const int code = write_reports(command, verification, of_new, texts);
  return verification.proved() ? code : static_cast<int>(ExitCode::kNotProved);
}

}  // namespace

int write_certificate(const VerifyCommand& command, const gcode::SourceText& old_source,
                      const gcode::SourceText& new_source) {
  if (command.certificate_file.empty()) return 0;
  const BothTexts both = both_texts(command, old_source, new_source);
  gcode::Diagnostics found;
  const gcode::ReadPart before = read_whole(old_source, both.before.reading, found);
  const gcode::ReadPart after = read_whole(both.compared, both.after, found);
  const Certificate certificate =
      certificate_of({&before.program, &before.meaning}, {&after.program, &after.meaning},
                     new_source.text(), command.tolerance_mm);
  if (!certificate.problem.empty()) {
    say(fmt::format("{}: no certificate was written: {}", command.certificate_file,
                    certificate.problem));
    return static_cast<int>(ExitCode::kNotProved);
  }
  return write_result(command.certificate_file, certificate.text, command.force);
}

int run(const VerifyCommand& command) {
  if (!may_write_reports(command) || !may_be_written(command.certificate_file, command.force)) {
    return static_cast<int>(ExitCode::kFileError);
  }
  const WatchedFile old_watched(command.old_program);
  const WatchedFile new_watched(command.new_program);
  std::size_t dropped = 0;
  const auto old_source = read_program(command.old_program, command.drop, dropped);
  const auto new_source = read_program(command.new_program);
  if (interrupted()) return end_interrupted();
  if (!old_source || !new_source) return static_cast<int>(ExitCode::kFileError);
  if (old_source->text() == new_source->text()) {
    if (either_changed(old_watched, new_watched)) return static_cast<int>(ExitCode::kFileError);
    return accept_same_bytes(command, *new_source);
  }

  BothTexts both = both_texts(command, *old_source, *new_source);
  const gcode::SourceText& compared = both.compared;
  const TextToVerify& before = both.before;
  if (gcode::has_error(before.reading.of_language)) {
    return end_not_understood(both.before.reading.of_language, *old_source, command);
  }
  AddedLines& added = both.added;
  const TextToVerify after{compared, both.after, std::move(added.brackets)};
  auto verified = verify_texts(before, after, promise_of(command), interrupted);
  if (!verified || interrupted()) return end_interrupted();
  if (either_changed(old_watched, new_watched) || changed_while_read(both.called)) {
    return static_cast<int>(ExitCode::kFileError);
  }
  if (gcode::has_error(verified->of_old)) {
    return end_not_understood(verified->of_old, *old_source, command);
  }
  print(std::as_const(verified->of_old), *old_source, command.log_level);
  print(verified->of_new, compared, command.log_level, command.command_line);
  if (gcode::has_error(verified->of_new)) {
    say("NOT PROVED: the new program is not understood, and the old one is");
    return static_cast<int>(ExitCode::kNotProved);
  }
  Verification& verification = verified->verification;
  if (before.reading.text.language == gcode::Language::kRs274 &&
      after.reading.text.language == gcode::Language::kRs274) {
    compare_points(command, *old_source, *new_source, verification);
  }
  std::ranges::move(added.violations, std::back_inserter(verification.violations));
  std::ranges::move(verified->in_brackets, std::back_inserter(verification.violations));
  const int code = tell(command, verification, added.lines, verified->of_new,
                        {before, after, both.called.files, dropped});
  return code != 0 ? code : write_certificate(command, *old_source, *new_source);
}

}  // namespace batten::postproc
