#include "postproc/stream/smooth_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <variant>

#include "gcode/curves/curve_format.h"
#include "gcode/state/reason.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/provenance.h"

namespace batten::postproc {

namespace {

// rms of two sections by their lengths.
double together(double a, double length_a, double b, double length_b) {
  return std::sqrt((a * a * length_a + b * b * length_b) / (length_a + length_b));
}

class Reporter {
 public:
  Reporter(const ProgramPart& part, const PartRuns& runs, double user_tolerance_mm,
           std::span<const ComparedSection> compared, bool proved)
      : part_(part),
        of_part_(runs),
        user_tolerance_(user_tolerance_mm),
        compared_(compared),
        proved_(proved) {}

  std::vector<RunReport> run() {
    std::size_t next = 0;
    for (std::size_t i = 0; i < of_part_.sections.size(); ++i) {
      if (next >= of_part_.works.size() || of_part_.works[next].section != i) {
        report_kept_motions(of_part_.sections[i]);
      } else if (const RunState& work = of_part_.works[next++]; work.cut_run) {
        report_part(work);
      } else {
        runs_.push_back(report_of(work));
      }
    }
    return std::move(runs_);
  }

 private:
  // Neighbouring parts of a run that are kept for one reason are one run of the report. Where the
  // whole run was tried and no part of it is rewritten, it is as if it had not been cut.
  void report_part(const RunState& work) {
    const CutRun& cut = of_part_.cut_runs[*work.cut_run];
    const auto first = of_part_.works.begin() + static_cast<std::ptrdiff_t>(cut.first_work);
    const auto last = first + static_cast<std::ptrdiff_t>(cut.pieces);
    bool all_kept = true;
    RunReport r = report_of(work);
    r.closed = cut.run.closed && &work == &*first;  // counts once
    // The times of the parts are those between their neighbours; they are shares of the run's.
    Times before;
    Times after;
    for (auto part = first; part != last; ++part) {
      const Candidate* chosen = part->chosen();
      all_kept = all_kept && chosen == nullptr;
      before += part->smoothed.facts.scale.original.times;
      after += (chosen != nullptr ? chosen->figures : part->smoothed.facts.scale.original).times;
    }
    const double share_before =
        before.programmed > 0 ? cut.before.programmed / before.programmed : 1;
    const double share_after = after.programmed > 0 ? cut.after.programmed / after.programmed : 1;
    r.time_before_s *= share_before;
    r.time_after_s *= share_after;
    for (MethodTime& each : r.methods) {
      each.time_s *= r.status == RunStatus::kKept ? share_before : share_after;
    }
    if (all_kept && cut.facts) {
      r.reason = cut.reason;
      r.noise_mm = cut.facts->noise;
      r.max_curvature_before = cut.facts->max_curvature;
      r.max_curvature_after = r.max_curvature_before;
    }
    const bool goes_on = &work != &*first && runs_.back().status == RunStatus::kKept &&
                         r.status == RunStatus::kKept && runs_.back().reason == r.reason;
    if (!goes_on) {
      runs_.push_back(r);
      return;
    }
    RunReport& before_it = runs_.back();
    before_it.methods = joined_times({before_it.methods, before_it.time_before_s},
                                     {std::move(r.methods), r.time_before_s});
    before_it.last_line = r.last_line;
    const auto edges = static_cast<double>(before_it.points + r.points - 2);
    before_it.coarse_part +=
        (r.coarse_part - before_it.coarse_part) * static_cast<double>(r.points - 1) / edges;
    before_it.points += r.points - 1;
    before_it.blocks_in += r.blocks_in;
    before_it.blocks_out += r.blocks_out;
    before_it.noise_mm = std::max(before_it.noise_mm, r.noise_mm);
    before_it.max_curvature_before =
        std::max(before_it.max_curvature_before, r.max_curvature_before);
    before_it.max_curvature_after = std::max(before_it.max_curvature_after, r.max_curvature_after);
    before_it.bytes_in += r.bytes_in;
    before_it.bytes_out += r.bytes_out;
    before_it.path_before += r.path_before;
    before_it.path_after += r.path_after;
    before_it.is_cut_short |= r.is_cut_short;
    before_it.time_before_s += r.time_before_s;
    before_it.time_after_s += r.time_after_s;
  }

  [[nodiscard]] RunReport report_of(const RunState& work) {
    const Section& section = of_part_.sections[work.section];
    const Candidate* chosen = work.chosen();
    const RunFacts& facts = work.smoothed.facts;
    RunReport r = report_of_blocks(section);
    r.points = motion_count(std::get<Run>(section.content)) + 1;
    r.blocks_in = work.context.blocks;
    r.blocks_out = chosen != nullptr ? chosen->text.blocks : work.context.blocks;
    r.closed = std::get<Run>(section.content).closed;
    r.had_curves = facts.form == Form::kCurves;
    const Figures& before = facts.scale.original;
    const Figures& after = chosen != nullptr ? chosen->figures : before;
    r.bytes_in = work.context.bytes;
    r.bytes_out = chosen != nullptr ? chosen->text.text.size() : work.context.bytes;
    r.path_before = {facts.length, before.distance, before.roughness};
    r.path_after = {facts.length, after.distance, after.roughness};
    r.noise_mm = facts.noise;
    r.coarse_part = facts.coarse;
    r.max_curvature_before = facts.max_curvature;
    r.max_curvature_after = chosen != nullptr ? chosen->max_curvature : facts.max_curvature;
    r.methods = method_times(work.smoothed);
    r.is_cut_short = work.smoothed.is_cut_short;
    r.time_before_s = before.times.programmed;
    r.time_after_s = after.times.programmed;
    if (chosen == nullptr) {
      r.reason = work.reject_reason.empty() ? work.selection.reason : work.reject_reason;
      return r;
    }
    r.status = RunStatus::kRewritten;
    r.method = chosen->method;
    r.form = chosen->form;
    r.chords_for_steps = chosen->chords_for_steps;
    r.arcs_as_chords = chosen->arcs_as_chords;
    r.rounds_seam = chosen->rounds_seam;
    r.computed_blocks = computed_blocks(section);
    r.proved = proved_;
    r.deviation_mm = deviation_within(section);
    return r;
  }

  [[nodiscard]] std::size_t computed_blocks(const Section& section) const {
    std::size_t count = 0;
    for (std::uint32_t b = section.first_block; b <= section.last_block; ++b) {
      const auto words = part_.program.words_of(part_.program.blocks[b]);
      count += std::ranges::any_of(words, &gcode::Word::computed) ? 1 : 0;
    }
    return count;
  }

  // Sections are asked for in the order of the program.
  [[nodiscard]] double deviation_within(const Section& section) {
    const auto ends_before = [&](const ComparedSection& compared) {
      return compared.old_last_block < section.first_block;
    };
    while (next_ < compared_.size() && ends_before(compared_[next_])) ++next_;
    double deviation = 0;
    for (std::size_t i = next_; i < compared_.size(); ++i) {
      const ComparedSection& compared = compared_[i];
      if (ends_before(compared)) continue;
      if (compared.old_first_block > section.last_block) break;
      deviation = std::max(deviation, compared.comparison.bounds.at_most);
    }
    return deviation;
  }

  [[nodiscard]] RunReport report_of_blocks(const Section& section) const {
    RunReport r;
    r.first_line = part_.program.blocks[section.first_block].line;
    r.last_line = part_.program.blocks[section.last_block].line;
    const auto stated =
        gcode::least_stated_mm(part_.meaning, section.first_block, section.last_block);
    r.tolerance_mm = std::min(user_tolerance_, stated.value_or(user_tolerance_));
    r.proved = true;  // copied bytes are proved by being the same
    return r;
  }

  // Verbatim sections appear in the report when they hold motions that a user may have wanted
  // smoothed: chains of straight cutting moves.
  void report_kept_motions(const Section& section) {
    std::size_t lines = 0;
    for (std::uint32_t b = section.first_block; b <= section.last_block; ++b) {
      const std::int32_t motion = part_.meaning.blocks[b].motion;
      if (motion >= 0 && part_.meaning.motions[motion].kind == gcode::MotionKind::kLine) ++lines;
    }
    if (lines == 0) return;
    RunReport r = report_of_blocks(section);
    r.points = lines + 1;
    r.blocks_in = section.last_block - section.first_block + 1;
    r.blocks_out = r.blocks_in;
    r.reason = std::get<Verbatim>(section.content).reason;
    runs_.push_back(r);
  }

  const ProgramPart& part_;
  const PartRuns& of_part_;
  double user_tolerance_;  // mm
  std::span<const ComparedSection> compared_;
  bool proved_;
  std::vector<RunReport> runs_;
  std::size_t next_ = 0;  // those before it end before the section that was asked for last
};

}  // namespace

PathFigures& PathFigures::operator+=(const PathFigures& other) {
  if (!(other.length_mm > 0)) return *this;
  distance_mm = together(distance_mm, length_mm, other.distance_mm, other.length_mm);
  roughness = together(roughness, length_mm, other.roughness, other.length_mm);
  length_mm += other.length_mm;
  return *this;
}

std::vector<RunReport> report_runs(const ProgramPart& part, const PartRuns& runs,
                                   double user_tolerance_mm,
                                   std::span<const ComparedSection> compared, bool proved) {
  return Reporter(part, runs, user_tolerance_mm, compared, proved).run();
}

std::vector<StatedFrom> stated_in(const gcode::Program& part,
                                  const gcode::Interpretation& meaning) {
  const gcode::Units units = first_units(meaning);
  std::vector<StatedFrom> stated;
  for (const gcode::StatedAt& at : meaning.stated) {
    stated.push_back({part.blocks[at.block].line, gcode::least_mm(at.stated, units)});
  }
  return stated;
}

void add_stated(const std::vector<StatedFrom>& part, std::vector<StatedFrom>& all) {
  for (const StatedFrom& from : part) {
    const auto before = all.empty() ? std::nullopt : all.back().tolerance_mm;
    if (from.tolerance_mm != before) all.push_back(from);
  }
}

gcode::Units first_units(const gcode::Interpretation& meaning) {
  const auto known = [](const gcode::ModalState& state) {
    return state.units != gcode::Units::kUnknown;
  };
  const auto first = std::ranges::find_if(meaning.states, known);
  return first == meaning.states.end() ? gcode::Units::kUnknown : first->units;
}

ExitCode judge(const SmoothResult& result, std::string_view source, bool strict) {
  if (!result.understood) return ExitCode::kNotUnderstood;
  // The same bytes need no proof: programs with words that cannot be followed are unchanged.
  const bool proved = result.proved || result.text == source;
  const bool any_unproved = std::ranges::any_of(result.runs, [](const RunReport& run) {
    return run.status == RunStatus::kKept && run.reason == gcode::reason::kNotProved;
  });
  return proved && !(strict && any_unproved) ? ExitCode::kDone : ExitCode::kNotProved;
}

std::string_view complaint(ExitCode verdict, bool strict) {
  if (verdict == ExitCode::kNotUnderstood) {
    return "the program is not understood well enough to be rewritten; nothing was written";
  }
  return strict ? "--strict: not every run could be proved; nothing was written"
                : "the new program could not be proved; nothing was written";
}

gcode::Diagnostics notes_on_runs(std::span<const RunReport> runs, const gcode::Program& program,
                                 const gcode::Control& target) {
  gcode::Diagnostics notes;
  const auto is_rewritten = [](const RunReport& run) {
    return run.status == RunStatus::kRewritten;
  };
  const auto tell_first = [&](gcode::Severity severity, const char* id, std::string message,
                              const auto& holds) {
    const auto first = std::ranges::find_if(runs, holds);
    if (first == runs.end()) return;
    notes.push_back({severity, id,
                     program.blocks[first->first_line - program.blocks.front().line].span,
                     std::move(message)});
  };
  if (provenance_comment(target, 1).empty()) {
    tell_first(gcode::Severity::kNote, "missing-provenance",
               "target " + std::string(target.name) +
                   " has no certain comment, so nothing in the program says that it was smoothed: "
                   "smoothing it once more would add its tolerance again",
               is_rewritten);
  }
  if (target.curves != nullptr && !target.curves->caution.empty()) {
    tell_first(gcode::Severity::kWarning, "curves-unverified", std::string(target.curves->caution),
               [&](const RunReport& run) {
                 return is_rewritten(run) && (run.form == Form::kCurves || run.had_curves);
               });
  }
  tell_first(
      gcode::Severity::kNote, "chords-for-steps",
      "the equal steps of --linearize ilca are too many for this run; found chords, expected "
      "equal steps",
      [](const RunReport& run) { return run.chords_for_steps; });
  tell_first(
      gcode::Severity::kNote, "search-cut-short",
      "not every form and method was tried for this run: its moves took as much work as each may "
      "take",
      [](const RunReport& run) { return run.is_cut_short; });
  const gcode::ArcChords& own = target.chords;
  tell_first(
      gcode::Severity::kNote, "arcs-as-chords",
      fmt::format("some arcs of this run are lines, since {} itself would cut them into "
                  "chords {} mm {}, too coarse here; expected a finer setting of the control",
                  target.name, own.error > 0 ? own.error : own.longest,
                  own.error > 0 ? "beside them" : "long"),
      [](const RunReport& run) { return run.arcs_as_chords; });
  return notes;
}

void SeamTally::add(std::span<const RunReport> runs, const gcode::Program& program) {
  for (const RunReport& run : runs) {
    if (!run.closed) continue;
    ++closed_;
    if (run.rounds_seam) ++rounded_;
    if (first_closed_) continue;
    first_closed_ = program.blocks[run.first_line - program.blocks.front().line].span;
  }
}

SeamTally& SeamTally::operator+=(const SeamTally& next) {
  closed_ += next.closed_;
  rounded_ += next.rounded_;
  if (!first_closed_) first_closed_ = next.first_closed_;
  return *this;
}

gcode::Diagnostics SeamTally::diagnostics() const {
  if (rounded_ > 0) return {};
  const std::string found = closed_ == 0
                                ? "no run ends where it begins"
                                : fmt::format(
                                      "found {} closed {}, the first here, expected one that is "
                                      "rewritten and begins in a corner that may be rounded",
                                      closed_, closed_ == 1 ? "run" : "runs");
  return {{gcode::Severity::kNote, "seam-not-rounded", first_closed_.value_or(gcode::SourceSpan{}),
           "--seam smooth changes nothing: " + found}};
}

}  // namespace batten::postproc
