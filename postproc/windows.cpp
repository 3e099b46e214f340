#include "postproc/windows.h"

#include <algorithm>
#include <utility>

#include "gcode/part_reading.h"
#include "gcode/reason.h"
#include "postproc/plan/curve_caution.h"
#include "postproc/program_scout.h"
#include "postproc/proof/part_proof.h"
#include "postproc/runs/band_notes.h"
#include "postproc/runs/part_runs.h"
#include "postproc/runs/program_part.h"
#include "postproc/translation/conversion.h"
#include "postproc/writing/provenance.h"

namespace batten::postproc {

namespace {

// Parts of the progress: the first pass only reads.
constexpr double kAfterScouting = 0.15;
constexpr double kAfterSmoothing = 0.7;  // of a window

enum class Outcome { kDone, kStopped, kNeedsWhole };

class Windows {
 public:
  Windows(const gcode::SourceText& source, const SmoothOptions& options, const TextSink& sink,
          const Progress& progress)
      : source_(source),
        options_(options),
        sink_(sink),
        progress_(progress),
        old_{gcode::ControlCarry(options.units)},
        new_{gcode::ControlCarry(options.units)} {
    read_options_.units = options.units;
    read_options_.curves = options.target->curves();
    additions_.comment = provenance_comment(*options.target, options.tolerance_mm);
  }

  std::optional<SmoothResult> run(std::size_t least_blocks) {
    if (!options_.words.empty()) return std::nullopt;
    if (is_to_be_translated(source_, options_)) return std::nullopt;
    gcode::Diagnostics of_language;
    const auto language = language_read(source_, options_, of_language);
    if (language != gcode::Language::kRs274) return std::nullopt;
    text_.decimals = {reading_of(options_, *language).decimals, options_.units};
    const Tell tell_scouting = [this](double part) { return tell(part * kAfterScouting); };
    ScoutReport facts = scout(source_, options_, least_blocks, tell_scouting);
    if (facts.outcome == Scouting::kWhole) return std::nullopt;
    result_.diagnostics = std::move(facts.found);
    result_.blocks_in = facts.blocks;
    result_.units = facts.units;
    again_ = facts.was_smoothed && !is_allowed(gcode::reason::kAlreadySmoothed, options_);
    if (facts.outcome == Scouting::kStopped) return std::move(result_);
    for (const std::uint32_t end : facts.ends) {
      const Outcome outcome = smooth_window(end);
      if (outcome == Outcome::kNeedsWhole) return std::nullopt;
      if (outcome == Outcome::kStopped) return std::move(result_);
    }
    notes_.tell_rest(result_.diagnostics);
    if (untold_) result_.diagnostics.push_back(std::move(*untold_));
    if (caution_) result_.diagnostics.push_back(std::move(*caution_));
    result_.understood = true;
    result_.proved = true;
    return std::move(result_);
  }

 private:
  bool tell(double part) { return !progress_ || progress_(part); }

  Outcome smooth_window(std::uint32_t end) {
    const std::uint32_t begin = text_.begin;
    const ProgramPart part = read_window(end);
    const Tell tell_part = [&](double share) {
      const double bytes = begin + share * kAfterSmoothing * (end - begin);
      const double done = bytes / static_cast<double>(source_.text().size());
      return tell(kAfterScouting + done * (1 - kAfterScouting));
    };
    PartRuns runs = find_runs(part, options_);
    if (again_) {
      keep_as_smoothed(runs);
    } else if (!smooth_runs(part, options_, tell_part, runs)) {
      return Outcome::kStopped;
    }
    notes_.add(runs.notes, result_.diagnostics);
    const Tell tell_round = [&](double) { return tell_part(1); };
    auto proved = prove_text(part, options_, read_options_, additions_, tell_round, runs);
    if (!proved) return Outcome::kStopped;
    if (!proved->proved || !proved->stands_alone) return Outcome::kNeedsWhole;
    if (!hand_on(part, *proved)) return Outcome::kStopped;
    take_figures(part, runs, *proved);
    go_on_behind(part, std::move(*proved));
    source_.set_aside({begin, end});
    return Outcome::kDone;
  }

  ProgramPart read_window(std::uint32_t end) {
    WindowStart start{old_.events, new_, text_.words_seen, text_.decimals, starts_alike_};
    gcode::Diagnostics told_before;
    gcode::Program program = gcode::parse_part(source_, {.byte = end}, text_, told_before);
    gcode::Interpretation meaning =
        gcode::interpret_part(program, read_options_, old_.control, told_before);
    return {std::move(program), std::move(meaning), std::move(start)};
  }

  bool hand_on(const ProgramPart& part, const ProvedText& proved) {
    const std::string_view bytes =
        proved.unchanged ? source_.text(part.extent()) : std::string_view(proved.text);
    result_.bytes_handed_on += bytes.size();
    if (!proved.unchanged) additions_.comment.clear();
    return sink_(bytes);
  }

  void take_figures(const ProgramPart& part, const PartRuns& runs, const ProvedText& proved) {
    const Verification& verification = proved.verification;
    result_.blocks_out += proved.blocks;
    result_.corner_mm = std::max(result_.corner_mm, verification.corner_mm);
    if (verification.deviation_mm > result_.deviation_mm) {
      result_.deviation_mm = verification.deviation_mm;
      result_.deviation_line = verification.deviation_line;
    }
    auto reports = report_runs({part.program, part.meaning, runs.sections, runs.works,
                                runs.cut_runs, verification.stretches, true});
    if (!untold_) untold_ = untold_smoothing(reports, part.program, *options_.target);
    if (!caution_) caution_ = curve_caution(reports, part.program, *options_.target);
    for (RunReport& run : reports) {
      result_.time_before_s += run.time_before_s;
      result_.time_after_s += run.time_after_s;
      result_.runs.push_back(std::move(run));
    }
  }

  void go_on_behind(const ProgramPart& part, ProvedText proved) {
    old_.events = events_before_next({&part.program, &part.meaning, old_.events});
    if (proved.behind) {
      new_ = std::move(*proved.behind);
    } else {
      new_ = old_;
    }
    starts_alike_ =
        gcode::same_knowledge(old_.control.state, new_.control.state) && old_.events == new_.events;
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  const TextSink& sink_;
  const Progress& progress_;
  gcode::ReadOptions read_options_;
  Additions additions_;
  bool again_ = false;  // the program was smoothed before
  gcode::TextCarry text_;
  TextBefore old_;
  TextBefore new_;
  bool starts_alike_ = true;  // the next window, in the old and in the new text
  BandNoteTally notes_;
  std::optional<gcode::Diagnostic> untold_;
  std::optional<gcode::Diagnostic> caution_;
  SmoothResult result_;
};

}  // namespace

std::optional<SmoothResult> smooth_in_windows(const gcode::SourceText& source,
                                              const SmoothOptions& options, const TextSink& sink,
                                              const Progress& progress, std::size_t least_blocks) {
  return Windows(source, options, sink, progress).run(least_blocks);
}

}  // namespace batten::postproc
