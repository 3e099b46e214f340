// What the pipeline promises for any program whatever. Used by the fuzzer and by the unit tests.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "postproc/convert/conversion.h"
#include "postproc/machine/machine.h"
#include "postproc/options/options.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/stream/pipeline.h"

namespace batten::postproc::promises {

// FNV-1a: different first lines, different options; the same ones for the same program.
inline std::uint32_t hash_of(std::string_view text) {
  std::uint32_t hash = 2166136261U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return hash;
}

// One of the targets that read the language of the text, where that is certain; else one of all.
inline const gcode::Control* target_for_text(std::string_view text, std::uint32_t hash) {
  const auto marks = gcode::language_marks(gcode::SourceText("fuzz", std::string(text)));
  std::vector<const gcode::Control*> fitting;
  for (const gcode::Control& target : gcode::controls()) {
    if (marks.empty() || target.language == marks.front().language) fitting.push_back(&target);
  }
  return fitting[hash % fitting.size()];
}

// Options that the first line of a program stands for.
inline SmoothOptions options_for_text(std::string_view text) {
  constexpr std::array<double, 5> kTolerances = {0.01, 0.01, 0.002, 0.05, 1};
  constexpr std::array kForms = {Form::kAuto, Form::kCurves, Form::kArcs, Form::kLines};
  constexpr std::array kPrefer = {Prefer::kTime, Prefer::kAccuracy, Prefer::kSize};
  constexpr std::array kMethods = {Method::kBest,    Method::kFair, Method::kTimeOptimal,
                                   Method::kNaseath, Method::kGuo,  Method::kOzcan};
  const std::uint32_t hash = hash_of(text.substr(0, text.find('\n')));
  SmoothOptions options;
  options.target = target_for_text(text, hash);
  options.machine = find_machine(options.target->machine);
  options.tolerance_mm = kTolerances[hash / 64 % kTolerances.size()];
  options.output = kForms[hash / 512 % kForms.size()];
  options.prefer = kPrefer[hash / 4096 % kPrefer.size()];
  options.method = kMethods[hash / 32768 % kMethods.size()];
  options.tolerance_kind =
      hash / 262144 % 4 == 0 ? geometry::ToleranceKind::kBand : geometry::ToleranceKind::kPath;
  options.units = gcode::Units::kMillimetre;
  if (hash / 1048576 % 4 != 0) options.decimals = gcode::Decimals{};  // X5 is 5 mm
  options.threads = 1;
  return options;
}

struct TextAsRead {
  TextAsRead(const gcode::SourceText& source, const SmoothOptions& options)
      : program(gcode::parse(
            source,
            reading_of(options,
                       language_read(source, options, found).value_or(gcode::Language::kRs274)),
            found)),
        meaning(gcode::interpret(
            program, {.units = options.units, .curves = options.target->curves}, found)) {}
  gcode::Diagnostics found;
  gcode::Program program;
  gcode::Interpretation meaning;
};

// Byte where line `line` (from 1) begins; the size of the text behind the last one.
inline std::size_t begin_of_line(const gcode::Program& program, std::uint32_t line) {
  return line <= program.blocks.size() ? program.blocks[line - 1].span.begin
                                       : program.source.text().size();
}

// Does everything outside rewritten runs stand in the new text, unchanged and in order? The first
// part begins it and the last part ends it, where they are not runs.
inline bool rest_is_copied(const gcode::Program& before, const SmoothResult& result) {
  const std::string_view text = result.text;
  std::size_t from = 0;  // in the new text
  std::uint32_t next = 1;
  const auto kept_up_to = [&](std::uint32_t end) {
    const std::size_t begin = begin_of_line(before, next);
    return before.source.text().substr(begin, begin_of_line(before, end) - begin);
  };
  for (const RunReport& run : result.runs) {
    if (run.status != RunStatus::kRewritten) continue;
    const std::string_view part = kept_up_to(run.first_line);
    const std::size_t at = text.find(part, from);
    if (at == std::string_view::npos || (next == 1 && at != 0)) return false;
    from = at + part.size();
    next = run.last_line + 1;
  }
  const std::string_view last = kept_up_to(static_cast<std::uint32_t>(before.blocks.size() + 1));
  if (next == 1) return text == last;
  return text.ends_with(last) && text.size() - last.size() >= from;
}

// The promise that does not hold for this program; empty when all do.
inline std::string broken_by(std::string_view text, const SmoothOptions& options) {
  const gcode::SourceText source("fuzz", std::string(text));
  const SmoothResult result = smooth_program(source, options);
  if (!result.understood) return "";
  const TextAsRead before(source, options);
  if (!result.proved) return "the new program is not proved by its maker";
  if (!(result.deviation_mm <= options.tolerance_mm)) return "a deviation above the tolerance";
  const TextAsRead after(gcode::SourceText("fuzz", result.text), options);
  const Promise promise(options.tolerance_mm, options.tolerance_kind, options.side);
  const Verification found =
      verify({&before.program, &before.meaning}, {&after.program, &after.meaning}, promise);
  if (!found.proved()) return "not proved: " + found.violations.front().message;
  if (!rest_is_copied(before.program, result)) return "something that was kept is not the same";
  for (const RunReport& run : result.runs) {
    if (!(run.deviation_mm <= run.tolerance_mm)) return "a deviation above that of its part";
    if (run.reason.empty() != (run.status == RunStatus::kRewritten)) return "kept without a reason";
  }
  // A control without comments has no place for the mark that a program was smoothed.
  if (comment_line(*options.target, "mark").empty()) return "";
  const SmoothResult again = smooth_program(gcode::SourceText("fuzz", result.text), options);
  return again.text == result.text ? "" : "a second pass changes something";
}

}  // namespace batten::postproc::promises
