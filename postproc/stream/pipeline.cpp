#include "postproc/stream/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/conversion_reason.h"
#include "gcode/state/reason.h"
#include "gcode/writer/block_numbers.h"
#include "postproc/convert/conversion.h"
#include "postproc/convert/obstacles.h"
#include "postproc/convert/program_operations.h"
#include "postproc/convert/translation.h"
#include "postproc/profile/target_words.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/band_notes.h"
#include "postproc/runs/program_part.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/added_lines.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/form_notes.h"
#include "postproc/stream/part_crossings.h"
#include "postproc/stream/part_proof.h"
#include "postproc/stream/provenance.h"

namespace batten::postproc {

namespace {

// Parts of the progress: reading is quick, proving costs about as much as smoothing.
constexpr double kAfterReading = 0.1;
constexpr double kAfterSmoothing = 0.7;

constexpr std::uint32_t kLastLine = std::numeric_limits<std::uint32_t>::max();

class Smoothing {
 public:
  Smoothing(const gcode::SourceText& source, const SmoothOptions& options, const Progress& progress,
            const LongRunLimits& long_runs)
      : source_(source),
        options_(options),
        progress_(progress),
        long_runs_(long_runs),
        part_{{source, {}, {}, {}, {}}, {}} {}

  SmoothResult run() {
    read();
    result_.understood = !gcode::has_error(result_.diagnostics);
    if (!result_.understood || !tell(kAfterReading)) return refused();
    runs_ = find_runs(part_, options_, long_runs_);
    if (!runs_.works.empty() && !fits_target()) return refused();
    while (true) {
      if (!smooth()) return refused();
      auto proved = prove();
      if (!proved) return refused();
      if (!copy_where_parts_cross(*proved)) return told(std::move(*proved));
      runs_ = find_runs(part_, options_, long_runs_, facts_);
    }
  }

 private:
  bool tell(double part) { return !progress_ || progress_(part); }

  SmoothResult refused() {
    result_.understood = false;
    result_.text.clear();
    return std::move(result_);
  }

  void read() {
    const auto language = language_read(source_, options_, result_.diagnostics);
    if (!language) return;
    part_.program = gcode::parse(source_, reading_of(options_, *language), result_.diagnostics);
    gcode::tell_of_contradictions(part_.program, options_.source, result_.diagnostics);
    read_options_ = read_options_of(options_);
    part_.meaning = gcode::interpret(part_.program, read_options_, result_.diagnostics);
    result_.blocks_in = part_.program.blocks.size();
    for (const gcode::ModalState& state : part_.meaning.states) {
      if (result_.units == gcode::Units::kUnknown) result_.units = state.units;
    }
    again_ = was_smoothed(part_.program) && !is_allowed(gcode::reason::kAlreadySmoothed, options_);
    tell_of_other_meanings(part_.program, *options_.target, result_.diagnostics);
    tell_of_own_words();
  }

  // The program's own smoothing words and those of the profile would undo each other. A program
  // that was smoothed before has both, and nothing is added to it.
  void tell_of_own_words() {
    additions_.comment = provenance_comment(*options_.target, options_.tolerance_mm);
    additions_.words =
        filled_in(options_.words, options_.tolerance_mm, result_.units, *options_.target);
    const std::uint32_t line = line_with_words_of(part_.program, additions_.words);
    if (line == 0 || again_) return;
    result_.diagnostics.push_back(
        {gcode::Severity::kError, "profile-words-in-program", part_.program.blocks[line - 1].span,
         "words that the profile would add; expected them in the program or in the profile"});
  }

  // What is copied must say on the target what it said where it came from.
  bool fits_target() {
    if (!is_of_another_family(part_.program, *options_.target)) return true;
    const auto tell = options_.convert ? &tell_what_cannot_be_said : &tell_of_other_family;
    tell(part_.program, *options_.target, result_.diagnostics);
    return !gcode::has_error(result_.diagnostics);
  }

  bool smooth() {
    if (again_) {
      keep_as_smoothed(runs_);
      return true;
    }
    const ProgressCallback tell_part = [this](double part) {
      return tell(kAfterReading + part * (kAfterSmoothing - kAfterReading));
    };
    return smooth_runs(part_, options_, tell_part, runs_);
  }

  std::optional<ProvedText> prove() {
    const ProgressCallback tell_round = [this](double) { return tell(kAfterSmoothing); };
    return prove_text(part_, options_, read_options_, additions_, tell_round, runs_);
  }

  // Whether parts of long runs cross each other where they did not: then more is to be copied.
  bool copy_where_parts_cross(ProvedText& proved) {
    PartCrossings crossings(*runs_.near, options_.tolerance_mm);
    crossings.take(std::move(proved.near_edges));
    crossings.look_up_to(kLastLine);
    const std::vector<LineRange> found = crossings.found();
    if (found.empty()) return false;
    const std::size_t lines = lines_in(facts_.copied);
    facts_.copied = more_to_copy(facts_.copied, found, *runs_.near);
    return lines_in(facts_.copied) > lines;
  }

  SmoothResult told(ProvedText proved) {
    append_band_notes(runs_.notes, result_.diagnostics);
    const Verification& verification = proved.verification;
    result_.text = proved.unchanged ? std::string(source_.text()) : std::move(proved.text);
    result_.proved = proved.proved;
    result_.blocks_out = proved.blocks;
    result_.added_lines = proved.added_lines;
    result_.deviation_mm = verification.deviation_mm;
    result_.deviation_line = verification.deviation_line;
    result_.corner_mm = verification.corner_mm;
    result_.runs = report_runs({part_.program, part_.meaning, runs_.sections, runs_.works,
                                runs_.cut_runs, verification.stretches, result_.proved});
    if (auto told = missing_provenance(result_.runs, part_.program, *options_.target)) {
      result_.diagnostics.push_back(std::move(*told));
    }
    std::ranges::move(form_notes(result_.runs, part_.program, *options_.target),
                      std::back_inserter(result_.diagnostics));
    return std::move(result_);
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  const Progress& progress_;
  LongRunLimits long_runs_;
  SmoothResult result_;
  gcode::ReadOptions read_options_;
  ProgramPart part_;
  PartRuns runs_;
  LongRunFacts facts_;
  Additions additions_;
  bool again_ = false;  // the program was smoothed before
};

// Rounding places to the target's digits is a part of the tolerance: smoothing has the rest.
class TranslatedSmoothing {
 public:
  TranslatedSmoothing(const gcode::SourceText& source, const SmoothOptions& options,
                      const Progress& progress)
      : source_(source),
        options_(options),
        progress_(progress),
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
    const gcode::Dialect& target = *options_.target;
    const TranslationSource said{program_,
                                 meaning_,
                                 operations,
                                 is_allowed(gcode::reason::kWorkOffset),
                                 is_allowed(gcode::reason::kToolLength),
                                 is_allowed(gcode::reason::kBlankForm)};
    const std::string name = program_name(source_.name());
    translation_ = target.language() == gcode::Language::kKlartext
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
    options.source = kind_of(options_.target->language());
    options.decimals = gcode::Decimals{};
    options.tolerance_mm = options_.tolerance_mm - translation_.rounding_mm;
    if (options.tolerance_mm <= 0) options.method = Method::kNone;
    if (options.tolerance_mm <= 0) options.tolerance_mm = options_.tolerance_mm;
    const gcode::SourceText text(source_.name(), translation_.text);
    SmoothResult result = smooth_program(text, options, progress_);
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
    const gcode::Language language = options_.target->language();
    std::string written =
        language == gcode::Language::kKlartext ? with_numbers(result.text, 0) : result.text;
    const gcode::SourceText text(source_.name(), written);
    gcode::Diagnostics found;
    const gcode::DwellForm dwells = options_.target->dwell_form();
    const gcode::Program program =
        gcode::parse(text, gcode::Reading{.language = language, .dwells = dwells}, found);
    const gcode::Interpretation meaning =
        gcode::interpret(program, {.curves = options_.target->curves()}, found);
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
  const Progress& progress_;
  gcode::Diagnostics found_;
  gcode::Program program_;
  gcode::Interpretation meaning_;
  Translation translation_;
  std::string violation_;
};

}  // namespace

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const Progress& progress, const LongRunLimits& long_runs) {
  if (is_to_be_translated(source, options)) {
    return TranslatedSmoothing(source, options, progress).run();
  }
  SmoothResult result = Smoothing(source, options, progress, long_runs).run();
  for (const RunReport& run : result.runs) {
    result.time_before_s += run.time_before_s;
    result.time_after_s += run.time_after_s;
  }
  return result;
}

}  // namespace batten::postproc
