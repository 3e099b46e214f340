#include "postproc/stream/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/state/reason.h"
#include "gcode/writer/block_numbers.h"
#include "postproc/convert/conversion.h"
#include "postproc/convert/program_operations.h"
#include "postproc/convert/translation.h"
#include "postproc/profile/target_profile.h"
#include "postproc/proof/verification.h"
#include "postproc/smooth/forms/provenance.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/part_reader.h"

namespace batten::postproc {

namespace {

// A program for another control: said in the target's words, smoothed with what rounding to the
// target's digits has left of the tolerance, and proved against the source.
class TranslatedSmoothing {
 public:
  TranslatedSmoothing(const gcode::SourceText& source, const SmoothOptions& options,
                      const Progress& progress, const StreamLimits& limits)
      : source_(source),
        options_(options),
        progress_(progress),
        limits_(limits),
        read_(read_whole(
            source,
            {options.source,
             reading_of(options,
                        language_to_translate(source, options).value_or(gcode::Language::kRs274)),
             {.units = options.units, .stated_tolerances = !options.one_tolerance}},
            found_)) {}

  SmoothResult run() {
    if (gcode::has_error(found_) || !translate()) return finished({});
    SmoothResult result = smooth();
    if (!result.understood) return finished({});
    if (prove(result)) return finished(std::move(result));
    keep_all(result);
    if (prove(result)) return finished(std::move(result));
    found_.push_back(
        {gcode::Severity::kError, "cannot-convert", first_span(),
         fmt::format("the translation could not be proved against the program: {}", violation_)});
    return finished({});
  }

 private:
  // mm
  [[nodiscard]] double least_tolerance() const {
    const auto blocks = static_cast<std::uint32_t>(read_.program.blocks.size());
    const auto stated =
        blocks > 0 ? gcode::least_stated_mm(read_.meaning, 0, blocks - 1) : std::optional<double>();
    return std::min(options_.tolerance_mm, stated.value_or(options_.tolerance_mm));
  }

  [[nodiscard]] gcode::SourceSpan first_span() const {
    return read_.program.blocks.empty() ? gcode::SourceSpan{} : read_.program.blocks.front().span;
  }

  bool translate() {
    ProgramOperations operations = operations_of(read_.program, read_.meaning);
    const gcode::Control& target = *options_.target;
    const TranslationSource said{read_.program,
                                 read_.meaning,
                                 operations,
                                 is_allowed(gcode::reason::kWorkOffset, options_),
                                 is_allowed(gcode::reason::kToolLength, options_),
                                 is_allowed(gcode::reason::kBlankForm, options_)};
    const std::string name = program_name(source_.name());
    translation_ = target.language == gcode::Language::kKlartext
                       ? in_klartext(said, target, name)
                       : in_plain_words(said, target, name);
    std::vector<Obstacle> obstacles = std::move(operations.obstacles);
    std::ranges::move(translation_.obstacles, std::back_inserter(obstacles));
    if (!options_.words.empty()) {
      obstacles.push_back({first_span(),
                           "cannot be converted with a profile that adds words: convert it first, "
                           "then smooth it with the profile"});
    }
    std::ranges::stable_sort(obstacles, {}, [](const Obstacle& o) { return o.where.begin; });
    tell_obstacles(obstacles, read_.program, target, found_);
    return obstacles.empty();
  }

  SmoothResult smooth() {
    SmoothOptions options = options_;
    options.convert = false;
    options.units = gcode::Units::kUnknown;
    options.source = kind_of(options_.target->language);
    options.decimals = gcode::Decimals{};
    // The least that the program says for any of its parts counts for all: the translation does not
    // say all of it.
    options.tolerance_mm = least_tolerance();
    options.one_tolerance = true;
    if (translation_.rounding_mm < options.tolerance_mm) {
      options.tolerance_mm -= translation_.rounding_mm;
    } else {
      options.method = Method::kNone;
    }
    const gcode::SourceText text(source_.name(), translation_.text);
    SmoothResult result = smooth_program(text, options, progress_, limits_);
    refer_to_source(result, text);
    // The comment that the program was smoothed says the whole tolerance.
    const std::string said = provenance_comment(*options_.target, options.tolerance_mm);
    const std::size_t at = result.text.find(said);
    if (!said.empty() && at != std::string::npos) {
      result.text.replace(at, said.size(),
                          provenance_comment(*options_.target, options_.tolerance_mm));
    }
    return result;
  }

  // Of plain words: as the target reads them.
  static gcode::SourceKind kind_of(gcode::Language language) {
    const auto families = gcode::source_families();
    const auto family = std::ranges::find(families, language, &gcode::SourceFamily::language);
    const bool plain = language == gcode::Language::kRs274 || family == families.end();
    return plain ? gcode::SourceKind::kAuto : family->kind;
  }

  [[nodiscard]] std::uint32_t source_line(std::uint32_t line) const {
    const auto& lines = translation_.source_lines;
    if (line == 0 || lines.empty()) return 0;
    return lines[std::min<std::size_t>(line, lines.size()) - 1];
  }

  // Positions in the translation become those of the source.
  void refer_to_source(SmoothResult& result, const gcode::SourceText& text) {
    for (gcode::Diagnostic& each : result.diagnostics) {
      const auto before = text.text().substr(0, each.where.begin);
      const auto line = static_cast<std::uint32_t>(std::ranges::count(before, '\n')) + 1;
      const std::uint32_t mine = source_line(line);
      each.where = mine > 0 ? read_.program.blocks[mine - 1].span : first_span();
      found_.push_back(std::move(each));
    }
    for (KeptCause& cause : result.kept.causes) {
      cause.first_line = source_line(cause.first_line);
      if (cause.line > 0) cause.line = source_line(cause.line);
    }
    for (RunReport& run : result.runs) {
      run.first_line = source_line(run.first_line);
      run.last_line = source_line(run.last_line);
      run.tolerance_mm = least_tolerance();
    }
  }

  void keep_all(SmoothResult& result) const {
    result.text = translation_.text;
    for (RunReport& run : result.runs) {
      run.status = RunStatus::kKept;
      run.reason = gcode::reason::kNotProved;
      run.method = {};
      run.blocks_out = run.blocks_in;
      run.time_after_s = run.time_before_s;
      run.bytes_out = run.bytes_in;
      run.path_after = run.path_before;
      run.max_curvature_after = run.max_curvature_before;
      run.deviation_mm = 0;
    }
    result.runs_after_s = result.runs_before_s;
    result.path_after = result.path_before;
  }

  // The text with its block numbers, as it will be written.
  bool prove(SmoothResult& result) {
    const gcode::Language language = options_.target->language;
    std::string written =
        language == gcode::Language::kKlartext ? with_numbers(result.text, 0) : result.text;
    const gcode::SourceText text(source_.name(), written);
    gcode::Diagnostics found;
    const gcode::DwellForm dwells = options_.target->dwell_form;
    const gcode::Program program =
        gcode::parse(text, gcode::Reading{.language = language, .dwells = dwells}, found);
    const gcode::Interpretation meaning =
        gcode::interpret(program, {.curves = options_.target->curves}, found);
    const Verification verification =
        verify({&read_.program, &read_.meaning}, {&program, &meaning},
               {options_.tolerance_mm, options_.tolerance_kind, options_.side, options_.target});
    if (!verification.proved() || gcode::has_error(found)) {
      if (!verification.violations.empty()) {
        const Violation& first = verification.violations.front();
        violation_ = fmt::format("{} at line {}: {}", first.id, first.old_line, first.message);
      }
      return false;
    }
    result.text = std::move(written);
    result.bytes_out = result.text.size();
    result.program_before = time_of(read_.program, read_.meaning, options_);
    result.program_after = time_of(program, meaning, options_);
    result.proved = true;
    result.blocks_out = program.blocks.size();
    result.deviation_mm = verification.deviation_mm;
    result.deviation_line = verification.deviation_line;
    result.corner_mm = verification.corner_mm;
    return true;
  }

  SmoothResult finished(SmoothResult result) {
    result.diagnostics = std::move(found_);
    result.blocks_in = read_.program.blocks.size();
    add_stated(stated_in(read_.program, read_.meaning), result.stated);
    result.units = first_units(read_.meaning);
    return result;
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  const Progress& progress_;
  const StreamLimits& limits_;
  gcode::Diagnostics found_;
  gcode::ReadPart read_;
  Translation translation_;
  std::string violation_;
};

}  // namespace

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const Progress& progress, const StreamLimits& limits) {
  if (is_to_be_translated(source, options)) {
    return TranslatedSmoothing(source, options, progress, limits).run();
  }
  std::string text;
  const ProgramSink sink = {[&](std::string_view part) {
                              text += part;
                              return true;
                            },
                            [&] {
                              text.clear();
                              return true;
                            }};
  SmoothResult result = smooth_windows(source, options, sink, progress, limits, {});
  if (result.understood) result.text = std::move(text);
  return result;
}

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const ProgramSink& sink, const Progress& progress,
                            const StreamLimits& limits, const PartSurvey& survey) {
  if (!is_to_be_translated(source, options)) {
    return smooth_windows(source, options, sink, progress, limits, survey);
  }
  SmoothResult result = TranslatedSmoothing(source, options, progress, limits).run();
  if (result.understood && !sink.take(result.text)) result.understood = false;
  result.text.clear();
  return result;
}

}  // namespace batten::postproc
