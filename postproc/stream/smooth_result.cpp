#include "postproc/stream/smooth_result.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>

#include "gcode/state/reason.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/run_smoother.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

namespace {

class Reporter {
 public:
  explicit Reporter(const RunsDone& done) : done_(done) {}

  std::vector<RunReport> run() {
    std::size_t next = 0;
    for (std::size_t i = 0; i < done_.sections.size(); ++i) {
      if (next >= done_.works.size() || done_.works[next].section != i) {
        report_kept_motions(done_.sections[i]);
        continue;
      }
      const RunState& work = done_.works[next++];
      if (work.cut_run) {
        report_piece(work);
      } else {
        runs_.push_back(report_of(work));
      }
    }
    return std::move(runs_);
  }

 private:
  [[nodiscard]] const Run& run_of(const RunState& work) const {
    return std::get<Run>(done_.sections[work.section].content);
  }

  // Neighbouring pieces that are kept for one reason are one run of the report. Where the whole
  // run was tried and no piece of it is left, it is as if it had not been cut.
  void report_piece(const RunState& work) {
    const CutRun& cut = done_.cut_runs[*work.cut_run];
    const auto first = done_.works.begin() + static_cast<std::ptrdiff_t>(cut.first_work);
    const auto last = first + static_cast<std::ptrdiff_t>(cut.pieces);
    const bool all_kept =
        std::all_of(first, last, [](const RunState& w) { return w.chosen() == nullptr; });
    RunReport r = report_of(work);
    // The times of the pieces are those between their neighbours; they are shares of the run's.
    Times before;
    Times after;
    for (auto piece = first; piece != last; ++piece) {
      const Candidate* chosen = piece->chosen();
      before += piece->smoothed.facts.times;
      after += chosen != nullptr ? chosen->times : piece->smoothed.facts.times;
    }
    const double share_before = before.as_set > 0 ? cut.before.as_set / before.as_set : 1;
    const double share_after = after.as_set > 0 ? cut.after.as_set / after.as_set : 1;
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
    before_it.points += r.points - 1;
    before_it.blocks_in += r.blocks_in;
    before_it.blocks_out += r.blocks_out;
    before_it.noise_mm = std::max(before_it.noise_mm, r.noise_mm);
    before_it.max_curvature_before =
        std::max(before_it.max_curvature_before, r.max_curvature_before);
    before_it.max_curvature_after = std::max(before_it.max_curvature_after, r.max_curvature_after);
    before_it.time_before_s += r.time_before_s;
    before_it.time_after_s += r.time_after_s;
  }

  [[nodiscard]] RunReport report_of(const RunState& work) {
    const Section& section = done_.sections[work.section];
    const Candidate* chosen = work.chosen();
    const RunFacts& facts = work.smoothed.facts;
    RunReport r = report_of_blocks(section);
    r.points = motion_count(run_of(work)) + 1;
    r.blocks_in = work.context.blocks;
    r.blocks_out = chosen != nullptr ? chosen->text.blocks : work.context.blocks;
    r.noise_mm = facts.noise;
    r.max_curvature_before = facts.max_curvature;
    r.max_curvature_after = chosen != nullptr ? chosen->max_curvature : facts.max_curvature;
    r.methods = method_times(work.smoothed);
    r.time_before_s = facts.times.as_set;
    r.time_after_s = chosen != nullptr ? chosen->times.as_set : facts.times.as_set;
    if (chosen == nullptr) {
      r.reason = work.reject_reason.empty() ? work.selection.reason : work.reject_reason;
      return r;
    }
    r.status = RunStatus::kRewritten;
    r.method = chosen->method;
    r.form = chosen->form;
    r.chords_for_steps = chosen->chords_for_steps;
    r.proved = done_.proved;
    r.deviation_mm = deviation_within(section);
    return r;
  }

  // Sections are asked for in the order of the program.
  [[nodiscard]] double deviation_within(const Section& section) {
    const auto ends_before = [&](const Stretch& stretch) {
      return stretch.old_last_block < section.first_block;
    };
    while (next_ < done_.stretches.size() && ends_before(done_.stretches[next_])) ++next_;
    double deviation = 0;
    for (std::size_t i = next_; i < done_.stretches.size(); ++i) {
      const Stretch& stretch = done_.stretches[i];
      if (ends_before(stretch)) continue;
      if (stretch.old_first_block > section.last_block) break;
      deviation = std::max(deviation, stretch.comparison.bounds.at_most);
    }
    return deviation;
  }

  [[nodiscard]] RunReport report_of_blocks(const Section& section) const {
    RunReport r;
    r.first_line = done_.program.blocks[section.first_block].line;
    r.last_line = done_.program.blocks[section.last_block].line;
    r.proved = true;  // copied bytes are proved by being the same
    return r;
  }

  // Verbatim sections appear in the report when they hold motions that a user may have wanted
  // smoothed: chains of straight cutting moves.
  void report_kept_motions(const Section& section) {
    std::size_t lines = 0;
    for (std::uint32_t b = section.first_block; b <= section.last_block; ++b) {
      const std::int32_t motion = done_.meaning.blocks[b].motion;
      if (motion >= 0 && done_.meaning.motions[motion].kind == gcode::MotionKind::kLine) ++lines;
    }
    if (lines == 0) return;
    RunReport r = report_of_blocks(section);
    r.points = lines + 1;
    r.blocks_in = section.last_block - section.first_block + 1;
    r.blocks_out = r.blocks_in;
    r.reason = std::get<Verbatim>(section.content).reason;
    runs_.push_back(r);
  }

  const RunsDone& done_;
  std::vector<RunReport> runs_;
  std::size_t next_ = 0;  // stretches before it end before the section that was asked for last
};

}  // namespace

std::vector<RunReport> report_runs(const RunsDone& done) { return Reporter(done).run(); }

namespace {

bool has_unproved_run(const SmoothResult& result) {
  return std::ranges::any_of(result.runs, [](const RunReport& run) {
    return run.status == RunStatus::kKept && run.reason == gcode::reason::kNotProved;
  });
}

}  // namespace

ExitCode judge(const SmoothResult& result, std::string_view source, bool strict) {
  if (!result.understood) return ExitCode::kNotUnderstood;
  // The same bytes need no proof: programs with words that cannot be followed come out as they
  // were.
  const bool proved = result.proved || result.text == source;
  if (!proved || (strict && has_unproved_run(result))) return ExitCode::kNotProved;
  return ExitCode::kDone;
}

std::string_view complaint(ExitCode verdict, bool strict) {
  if (verdict == ExitCode::kNotUnderstood) {
    return "the program is not understood well enough to be rewritten; nothing was written";
  }
  return strict ? "--strict: not every run could be proved; nothing was written"
                : "the new program could not be proved; nothing was written";
}

}  // namespace batten::postproc
