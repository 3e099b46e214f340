#include "batten/batten.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "gcode/controls/built_in.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/program_time/program_time.h"
#include "postproc/machine/program_time/program_time_blocks.h"
#include "postproc/options/options.h"
#include "postproc/options/own_words.h"
#include "postproc/options/target_on_machine.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/stream/inspect.h"
#include "postproc/stream/pipeline.h"

namespace batten {
namespace {

// The public enumerations have the values of those inside, in the same order.
gcode::Units inner(ProgramUnits units) {
  static_assert(static_cast<int>(gcode::Units::kUnknown) == int(ProgramUnits::kAsWritten) &&
                static_cast<int>(gcode::Units::kInch) == int(ProgramUnits::kInch));
  return static_cast<gcode::Units>(units);
}

Severity outer(gcode::Severity severity) {
  static_assert(static_cast<int>(gcode::Severity::kNote) == int(Severity::kNote) &&
                static_cast<int>(gcode::Severity::kError) == int(Severity::kError));
  return static_cast<Severity>(severity);
}

std::vector<Message> messages_of(const gcode::Diagnostics& found, const gcode::SourceText& source) {
  std::vector<Message> messages;
  for (const gcode::Diagnostic& each : found) {
    const gcode::SourcePlace place = source.place_of(each.where.begin);
    messages.push_back({outer(each.severity), std::string(each.id),
                        static_cast<std::uint32_t>(place.line),
                        static_cast<std::uint32_t>(place.column), each.message});
  }
  return messages;
}

// A program and what it means.
struct Reading {
  // `language`: what a text without certain marks is read in; nothing: as `target` reads.
  Reading(std::string_view text, ProgramUnits units, gcode::SourceKind kind,
          const gcode::Control* target = nullptr,
          const std::optional<gcode::Decimals>& decimals = std::nullopt,
          std::optional<gcode::Language> language = std::nullopt, bool one_tolerance = false)
      : source("program", std::string(text)),
        read{parse(units, kind, target, decimals, language), {}} {
    read.meaning = gcode::interpret(read.program,
                                    {.units = inner(units),
                                     .curves = target == nullptr ? nullptr : target->curves,
                                     .stated_tolerances = !one_tolerance},
                                    found);
    gcode::tell_of_contradictions(read.program, kind, found);
  }

  [[nodiscard]] gcode::Program parse(ProgramUnits units, gcode::SourceKind kind,
                                     const gcode::Control* target,
                                     const std::optional<gcode::Decimals>& decimals,
                                     std::optional<gcode::Language> language) {
    if (!language && target != nullptr) language = target->language;
    language = gcode::source_language(source, kind, language, found);
    const gcode::Language certain = language.value_or(gcode::Language::kRs274);
    const gcode::Decimals numbers = gcode::decimals_read(kind, target, certain, decimals);
    return gcode::parse(source, {certain, numbers, inner(units)}, found);
  }

  [[nodiscard]] postproc::ReadProgram get() const { return {&read.program, &read.meaning}; }

  gcode::SourceText source;
  gcode::Diagnostics found;
  gcode::ReadPart read;
};

void refuse_if_any(const std::vector<std::string>& problems) {
  if (problems.empty()) return;
  std::string text;
  for (const std::string& problem : problems) text += (text.empty() ? "" : "\n") + problem;
  throw std::invalid_argument(text);
}

template <typename Value>
void choose(Value& field, std::string_view option, std::string_view name,
            std::span<const postproc::Choice<Value>> choices, std::vector<std::string>& problems) {
  const auto found = std::ranges::find(choices, name, &postproc::Choice<Value>::name);
  if (found != choices.end()) {
    field = found->value;
  } else {
    problems.push_back(std::string(option) + ": there is no '" + std::string(name) + "'");
  }
}

// Null for no name, and with a problem where there is no such target.
const gcode::Control* find_target(std::string_view name, std::vector<std::string>& problems) {
  const gcode::Control* target = gcode::find_control(name);
  if (target == nullptr && !name.empty()) {
    problems.push_back("target: there is no '" + std::string(name) + "'");
  }
  return target;
}

gcode::SourceKind source_kind(std::string_view name) {
  gcode::SourceKind kind = gcode::SourceKind::kAuto;
  std::vector<std::string> problems;
  choose(kind, "source", name, postproc::sources(), problems);
  refuse_if_any(problems);
  return kind;
}

std::optional<gcode::Decimals> declared_decimals(std::string_view text, gcode::SourceKind kind,
                                                 const gcode::Control* target) {
  std::vector<std::string> problems;
  const auto declared = postproc::read_decimals(text, problems);
  if (problems.empty()) problems = postproc::problems_of_decimals(declared, kind, target);
  refuse_if_any(problems);
  return declared;
}

// The machine lives as long as this.
struct InnerOptions {
  postproc::SmoothOptions options;
  std::shared_ptr<const postproc::Machine> own_machine;
  std::shared_ptr<const gcode::Control> own_target;
};

InnerOptions inner(const Options& given) {
  InnerOptions all;
  std::vector<std::string> problems;
  postproc::SmoothOptions& options = all.options;
  options.target = find_target(given.target, problems);
  if (given.target.empty()) problems.emplace_back("target: there is no ''");
  if (!given.machine.empty() || options.target != nullptr) {
    const bool own = options.target == nullptr || !given.machine.empty();
    const std::string choice = own ? given.machine : options.target->machine;
    all.own_machine = postproc::choose_machine(choice, "machine", problems);
    options.machine = all.own_machine.get();
    if (options.target != nullptr && options.machine != nullptr) {
      all.own_target = postproc::target_on_machine(*options.target, *options.machine);
      options.target = all.own_target.get();
    }
  }
  options.tolerance_mm = given.tolerance_mm;
  options.one_tolerance = given.one_tolerance;
  options.tolerance_kind =
      given.band_reading ? geometry::ToleranceKind::kBand : geometry::ToleranceKind::kPath;
  choose(options.method, "method", given.method, postproc::methods(), problems);
  choose(options.output, "output", given.output, postproc::forms(), problems);
  choose(options.prefer, "prefer", given.prefer, postproc::preferences(), problems);
  choose(options.source, "source", given.source, postproc::sources(), problems);
  options.decimals = postproc::read_decimals(given.decimals, problems);
  if (!given.linearize.empty()) {
    options.linearize.emplace();
    choose(*options.linearize, "linearize", given.linearize, postproc::linearizations(), problems);
  }
  options.keep_corners_deg = given.keep_corners_deg;
  options.allowed = given.allow;
  postproc::OwnWordList own_words;
  for (const std::string& word : given.words) own_words.add(word, problems);
  options.own_words = own_words.words();
  options.keep_expressions = given.keep_expressions;
  options.units = inner(given.units);
  options.threads = given.threads;
  if (problems.empty()) problems = postproc::problems_of(options);
  refuse_if_any(problems);
  return all;
}

}  // namespace

std::string version() { return BATTEN_VERSION; }

std::vector<std::string> target_names() {
  std::vector<std::string> names;
  for (const gcode::Control& each : gcode::controls()) names.emplace_back(each.name);
  return names;
}

std::vector<std::string> machine_names() {
  std::vector<std::string> names;
  for (const postproc::Machine& machine : postproc::built_in_machines()) {
    names.push_back(machine.name);
  }
  return names;
}

ReadResult read(std::string_view program, ProgramUnits units, std::string_view source) {
  const Reading reading(program, units, source_kind(source));
  ReadResult result;
  result.understood = !gcode::has_error(reading.found);
  result.blocks = reading.read.program.blocks.size();
  for (const auto& section : postproc::inspect(reading.read, {})) {
    result.parts.push_back({section.first_line, section.last_line, section.cutting_moves,
                            std::string(section.reason)});
  }
  result.messages = messages_of(reading.found, reading.source);
  return result;
}

SmoothedProgram smooth(std::string_view program, const Options& options) {
  const InnerOptions all = inner(options);
  const gcode::SourceText source("program", std::string(program));
  postproc::SmoothResult done = postproc::smooth_program(source, all.options);
  SmoothedProgram result;
  result.understood = done.understood;
  // The same bytes need no proof.
  result.proved = done.understood && (done.proved || done.text == program);
  result.deviation_mm = done.deviation_mm;
  result.seconds_before = done.program_before.seconds;
  result.seconds_after = done.program_after.seconds;
  result.blocks_before = done.blocks_in;
  result.blocks_after = done.blocks_out;
  for (const postproc::RunReport& run : done.runs) {
    result.parts.push_back({run.first_line, run.last_line,
                            run.status == postproc::RunStatus::kRewritten, std::string(run.reason),
                            std::string(run.method), run.blocks_in, run.blocks_out,
                            run.deviation_mm, run.time_before_s, run.time_after_s});
  }
  result.messages = messages_of(done.diagnostics, source);
  result.text = std::move(done.text);
  return result;
}

Proof verify(std::string_view old_program, std::string_view new_program, double tolerance_mm,
             ProgramUnits units, std::string_view target, std::string_view source,
             std::string_view decimals, bool one_tolerance) {
  const gcode::SourceKind kind = source_kind(source);
  if (!(tolerance_mm > 0) || !std::isfinite(tolerance_mm)) {
    throw std::invalid_argument("tolerance_mm: expected a finite length above 0");
  }
  std::vector<std::string> problems;
  const gcode::Control* control = find_target(target, problems);
  refuse_if_any(problems);
  const auto declared = declared_decimals(decimals, kind, control);
  Proof proof;
  if (old_program == new_program) {
    proof.proved = true;
    return proof;
  }
  const Reading before(old_program, units, kind, control, declared, std::nullopt, one_tolerance);
  const Reading after(new_program, units, kind, control, declared, before.read.program.language,
                      one_tolerance);
  for (const Reading* each : {&before, &after}) {
    for (Message& message : messages_of(each->found, each->source)) {
      if (message.severity == Severity::kError) proof.messages.push_back(std::move(message));
    }
  }
  if (!proof.messages.empty()) return proof;
  const postproc::Verification found = postproc::verify(before.get(), after.get(), tolerance_mm);
  proof.proved = found.proved();
  proof.deviation_mm = found.deviation_mm;
  proof.deviation_line = found.deviation_line;
  for (const postproc::Violation& violation : found.violations) {
    proof.differences.push_back(
        {violation.id, violation.old_line, violation.new_line, violation.message});
  }
  return proof;
}

ProgramTime time(std::string_view program, const TimeOptions& options) {
  std::vector<std::string> problems;
  const auto machine = postproc::choose_machine(options.machine, "machine", problems);
  const gcode::Control* target = find_target(options.target, problems);
  refuse_if_any(problems);
  const gcode::SourceKind kind = source_kind(options.source);
  const Reading reading(program, options.units, kind, target,
                        declared_decimals(options.decimals, kind, target));
  ProgramTime result;
  result.messages = messages_of(reading.found, reading.source);
  result.understood = !gcode::has_error(reading.found);
  if (!result.understood) return result;
  const postproc::ProgramTime found = postproc::time_program(
      reading.read.program, reading.read.meaning, *machine,
      {.dwell_unit = postproc::dwell_unit_of(target, *machine), .start = std::nullopt});
  result.seconds = found.seconds.sum();
  result.cutting = found.seconds.cutting;
  result.rapids = found.seconds.rapids;
  result.dwells = found.seconds.dwells;
  result.tool_changes = found.seconds.tool_changes;
  result.spindle = found.seconds.spindle;
  result.rotary = found.seconds.rotary;
  result.below_half_feed = found.below_half_feed;
  for (const postproc::NotTimed& each : found.not_timed) {
    result.not_timed.push_back(
        {std::string(each.id), each.first_line, each.count, std::string(each.text)});
  }
  return result;
}

}  // namespace batten
