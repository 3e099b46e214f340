#include "postproc/stream/translated_smoothing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/reason.h"
#include "gcode/writer/block_numbers.h"
#include "postproc/convert/conversion.h"
#include "postproc/convert/program_operations.h"
#include "postproc/convert/translation.h"
#include "postproc/proof/verification.h"
#include "postproc/stream/provenance.h"

namespace batten::postproc {

namespace {

// Rounding places to the target's digits is a part of the tolerance: smoothing has the rest.
class TranslatedSmoothing {
 public:
  TranslatedSmoothing(const gcode::SourceText& source, const SmoothOptions& options,
                      const Smoother& smoother)
      : source_(source),
        options_(options),
        smoother_(smoother),
        program_(gcode::parse(
            source,
            reading_of(options,
                       language_to_translate(source, options).value_or(gcode::Language::kRs274)),
            found_)) {}

  SmoothResult run() {
    gcode::tell_of_contradictions(program_, options_.source, found_);
    meaning_ = gcode::interpret(program_, {.units = options_.units}, found_);
    if (gcode::has_error(found_) || !translate()) return refused();
    SmoothResult result = smooth();
    if (!result.understood) return refused();
    if (prove(result)) return finished(std::move(result));
    result = unsmoothed(std::move(result));
    if (prove(result)) return finished(std::move(result));
    found_.push_back(
        {gcode::Severity::kError, "cannot-convert", first_span(),
         fmt::format("the translation could not be proved against the program: {}", violation_)});
    return refused();
  }

 private:
  [[nodiscard]] gcode::SourceSpan first_span() const {
    return program_.blocks.empty() ? gcode::SourceSpan{} : program_.blocks.front().span;
  }

  SmoothResult refused() {
    SmoothResult result;
    result.diagnostics = std::move(found_);
    result.blocks_in = program_.blocks.size();
    result.units = units();
    return result;
  }

  [[nodiscard]] gcode::Units units() const {
    for (const gcode::ModalState& state : meaning_.states) {
      if (state.units != gcode::Units::kUnknown) return state.units;
    }
    return gcode::Units::kUnknown;
  }

  [[nodiscard]] bool is_allowed(std::string_view id) const {
    return std::ranges::find(options_.allowed, id) != options_.allowed.end();
  }

  bool translate() {
    ProgramOperations operations = operations_of(program_, meaning_);
    const gcode::Control& target = *options_.target;
    const TranslationSource said{program_,
                                 meaning_,
                                 operations,
                                 is_allowed(gcode::reason::kWorkOffset),
                                 is_allowed(gcode::reason::kToolLength),
                                 is_allowed(gcode::reason::kBlankForm)};
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
    tell_obstacles(obstacles, program_, target, found_);
    return obstacles.empty();
  }

  // In the target's language, with what rounding has left of the tolerance.
  SmoothResult smooth() {
    SmoothOptions options = options_;
    options.convert = false;
    options.units = gcode::Units::kUnknown;
    options.source = kind_of(options_.target->language);
    options.decimals = gcode::Decimals{};
    options.tolerance_mm = options_.tolerance_mm - translation_.rounding_mm;
    if (options.tolerance_mm <= 0) options.method = Method::kNone;
    if (options.tolerance_mm <= 0) options.tolerance_mm = options_.tolerance_mm;
    const gcode::SourceText text(source_.name(), translation_.text);
    SmoothResult result = smoother_(text, options);
    tell_of(result, text);
    tell_whole_tolerance(result.text, options.tolerance_mm);
    return result;
  }

  // In the comment that says that the program was smoothed.
  void tell_whole_tolerance(std::string& text, double part) const {
    const std::string said = provenance_comment(*options_.target, part);
    const std::size_t at = text.find(said);
    if (said.empty() || at == std::string::npos) return;
    text.replace(at, said.size(), provenance_comment(*options_.target, options_.tolerance_mm));
  }

  // Of plain words: as the target reads them.
  static gcode::SourceKind kind_of(gcode::Language language) {
    if (language == gcode::Language::kRs274) return gcode::SourceKind::kAuto;
    for (const gcode::SourceFamily& family : gcode::source_families()) {
      if (family.language == language) return family.kind;
    }
    return gcode::SourceKind::kAuto;
  }

  [[nodiscard]] std::uint32_t source_line(std::uint32_t line) const {
    const auto& lines = translation_.source_lines;
    if (line == 0 || lines.empty()) return 0;
    return lines[std::min<std::size_t>(line, lines.size()) - 1];
  }

  // Places in the translation are told as those of the source.
  void tell_of(SmoothResult& result, const gcode::SourceText& text) {
    for (gcode::Diagnostic& each : result.diagnostics) {
      const auto before = text.text().substr(0, each.where.begin);
      const auto line = static_cast<std::uint32_t>(std::ranges::count(before, '\n')) + 1;
      const std::uint32_t mine = source_line(line);
      each.where = mine > 0 ? program_.blocks[mine - 1].span : first_span();
      found_.push_back(std::move(each));
    }
    for (RunReport& run : result.runs) {
      run.first_line = source_line(run.first_line);
      run.last_line = source_line(run.last_line);
    }
  }

  SmoothResult unsmoothed(SmoothResult result) const {
    result.text = translation_.text;
    for (RunReport& run : result.runs) {
      run.status = RunStatus::kKept;
      run.reason = gcode::reason::kNotProved;
      run.method = {};
      run.blocks_out = run.blocks_in;
      run.time_after_s = run.time_before_s;
      run.max_curvature_after = run.max_curvature_before;
      run.deviation_mm = 0;
    }
    result.time_after_s = result.time_before_s;
    return result;
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
        verify({&program_, &meaning_}, {&program, &meaning},
               {options_.tolerance_mm, options_.tolerance_kind, options_.side});
    if (!verification.proved() || gcode::has_error(found)) {
      if (!verification.violations.empty()) {
        const Violation& first = verification.violations.front();
        violation_ = fmt::format("{} at line {}: {}", first.id, first.old_line, first.message);
      }
      return false;
    }
    result.text = std::move(written);
    result.proved = true;
    result.blocks_out = program.blocks.size();
    result.deviation_mm = verification.deviation_mm;
    result.deviation_line = verification.deviation_line;
    result.corner_mm = verification.corner_mm;
    return true;
  }

  SmoothResult finished(SmoothResult result) {
    result.diagnostics = std::move(found_);
    result.blocks_in = program_.blocks.size();
    result.units = units();
    return result;
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  const Smoother& smoother_;
  gcode::Diagnostics found_;
  gcode::Program program_;
  gcode::Interpretation meaning_;
  Translation translation_;
  std::string violation_;
};

}  // namespace

SmoothResult smooth_translated(const gcode::SourceText& source, const SmoothOptions& options,
                               const Smoother& smoother) {
  return TranslatedSmoothing(source, options, smoother).run();
}

}  // namespace batten::postproc
