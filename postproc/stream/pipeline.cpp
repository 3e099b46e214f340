#include "postproc/stream/pipeline.h"

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
#include "gcode/state/reason.h"
#include "postproc/convert/conversion.h"
#include "postproc/profile/target_words.h"
#include "postproc/runs/band_notes.h"
#include "postproc/runs/program_part.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/added_lines.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/form_notes.h"
#include "postproc/stream/part_crossings.h"
#include "postproc/stream/part_proof.h"
#include "postproc/stream/provenance.h"
#include "postproc/stream/translated_smoothing.h"

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

}  // namespace

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const Progress& progress, const LongRunLimits& long_runs) {
  if (is_to_be_translated(source, options)) return smooth_translated(source, options, progress);
  SmoothResult result = Smoothing(source, options, progress, long_runs).run();
  for (const RunReport& run : result.runs) {
    result.time_before_s += run.time_before_s;
    result.time_after_s += run.time_after_s;
  }
  return result;
}

}  // namespace batten::postproc
