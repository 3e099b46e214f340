#include "postproc/stream/pipeline.h"

#include <cstdint>
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
#include "postproc/profile/target_profile.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/added_lines.h"
#include "postproc/stream/collected_result.h"
#include "postproc/stream/part_crossings.h"
#include "postproc/stream/provenance.h"
#include "postproc/stream/translated_smoothing.h"
#include "postproc/stream/window.h"

namespace batten::postproc {

namespace {

// Part of the progress: reading is quick.
constexpr double kAfterReading = 0.1;

constexpr std::uint32_t kLastLine = std::numeric_limits<std::uint32_t>::max();

// A program as one window.
class WholeProgram {
 public:
  WholeProgram(const gcode::SourceText& source, const SmoothOptions& options,
               const Progress& progress, const LongRunLimits& long_runs)
      : source_(source),
        options_(options),
        progress_(progress),
        part_{{source, {}, {}, {}, {}}, {}},
        setting_{source, options, {}, long_runs, false, {}} {}

  SmoothResult run() {
    read();
    if (gcode::has_error(collected_.result.diagnostics) || !tell(kAfterReading)) return refused();
    PartRuns runs = find_runs(part_, options_, setting_.long_runs);
    if (!runs.works.empty() && !fits_target()) return refused();
    const ProgressCallback tell_share = [this](double share) {
      return tell(kAfterReading + share * (1 - kAfterReading));
    };
    while (true) {
      WindowDone done = smooth_part(setting_, part_, std::move(runs), additions_, tell_share);
      if (done.outcome != WindowOutcome::kDone) return refused();
      if (!copy_where_parts_cross(done)) return finished(std::move(done));
      runs = find_runs(part_, options_, setting_.long_runs, setting_.facts);
    }
  }

 private:
  bool tell(double part) { return !progress_ || progress_(part); }

  SmoothResult refused() {
    collected_.result.understood = false;
    return std::move(collected_.result);
  }

  void read() {
    const auto language = language_read(source_, options_, collected_.result.diagnostics);
    if (!language) return;
    part_.program =
        gcode::parse(source_, reading_of(options_, *language), collected_.result.diagnostics);
    gcode::tell_of_contradictions(part_.program, options_.source, collected_.result.diagnostics);
    setting_.read_options = read_options_of(options_);
    part_.meaning =
        gcode::interpret(part_.program, setting_.read_options, collected_.result.diagnostics);
    collected_.result.blocks_in = part_.program.blocks.size();
    for (const gcode::ModalState& state : part_.meaning.states) {
      if (collected_.result.units == gcode::Units::kUnknown) collected_.result.units = state.units;
    }
    setting_.was_smoothed =
        was_smoothed(part_.program) && !is_allowed(gcode::reason::kAlreadySmoothed, options_);
    tell_of_other_meanings(part_.program, *options_.target, collected_.result.diagnostics);
    tell_of_own_words();
  }

  // The program's own smoothing words and those of the profile would undo each other. A program
  // that was smoothed before has both, and nothing is added to it.
  void tell_of_own_words() {
    additions_.comment = provenance_comment(*options_.target, options_.tolerance_mm);
    additions_.words =
        filled_in(options_.words, options_.tolerance_mm, collected_.result.units, *options_.target);
    const std::uint32_t line = line_with_words_of(part_.program, additions_.words);
    if (line == 0 || setting_.was_smoothed) return;
    collected_.result.diagnostics.push_back(
        {gcode::Severity::kError, "profile-words-in-program", part_.program.blocks[line - 1].span,
         "words that the profile would add; expected them in the program or in the profile"});
  }

  // What is copied must say on the target what it said where it came from.
  bool fits_target() {
    if (!is_of_another_family(part_.program, *options_.target)) return true;
    const auto tell = options_.convert ? &tell_what_cannot_be_said : &tell_of_other_family;
    tell(part_.program, *options_.target, collected_.result.diagnostics);
    return !gcode::has_error(collected_.result.diagnostics);
  }

  // Whether parts of long runs cross each other where they did not: then more is to be copied.
  bool copy_where_parts_cross(WindowDone& done) {
    PartCrossings crossings(*done.near, options_.tolerance_mm);
    crossings.take(std::move(done.near_edges));
    crossings.look_up_to(kLastLine);
    const std::vector<LineRange> found = crossings.found();
    if (found.empty()) return false;
    std::vector<LineRange>& copied = setting_.facts.copied;
    const std::size_t lines = lines_in(copied);
    copied = more_to_copy(copied, found, *done.near);
    return lines_in(copied) > lines;
  }

  SmoothResult finished(WindowDone done) {
    SmoothResult& result = collected_.result;
    result.text = done.unchanged ? std::string(source_.text()) : std::move(done.text);
    result.proved = done.proved;
    collected_.take(std::move(done));
    collected_.finish();
    return std::move(result);
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  const Progress& progress_;
  ProgramPart part_;
  WindowSetting setting_;
  Additions additions_;
  CollectedResult collected_;
};

}  // namespace

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const Progress& progress, const LongRunLimits& long_runs) {
  if (!is_to_be_translated(source, options)) {
    return WholeProgram(source, options, progress, long_runs).run();
  }
  return smooth_translated(source, options,
                           [&](const gcode::SourceText& text, const SmoothOptions& of_target) {
                             return smooth_program(text, of_target, progress, long_runs);
                           });
}

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const ProgramSink& sink, const Progress& progress,
                            const StreamLimits& limits) {
  std::vector<LineRange> copied;
  bool in_windows = source.text().size() >= limits.bytes_for_windows;
  while (in_windows) {
    const std::size_t lines = lines_in(copied);
    auto result = smooth_in_windows(source, options, sink.take, progress, limits.windows, &copied);
    if (result) return std::move(*result);
    if (!sink.restart()) return {};
    in_windows = lines_in(copied) > lines;  // each round copies more, so the loop ends
  }
  SmoothResult result = smooth_program(source, options, progress, limits.windows.long_runs);
  const std::string text = std::move(result.text);
  result.text.clear();
  result.bytes_handed_on = text.size();
  if (result.understood && !sink.take(text)) result.understood = false;
  return result;
}

}  // namespace batten::postproc
