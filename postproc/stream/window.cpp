#include "postproc/stream/window.h"

#include <utility>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/part_reading.h"
#include "gcode/state/control_state.h"
#include "postproc/runs/long_run_cuts.h"
#include "postproc/stream/form_notes.h"
#include "postproc/stream/part_proof.h"
#include "postproc/stream/provenance.h"

namespace batten::postproc {

namespace {

// Share of the work: proving costs about as much as smoothing.
constexpr double kAfterRuns = 0.7;

bool knows_the_same(const TextBefore& a, const TextBefore& b) {
  return gcode::same_knowledge(a.control.state, b.control.state) && a.events == b.events;
}

// What the proof and the reports of the runs say of a part.
void take(const WindowSetting& setting, const ProgramPart& part, PartRuns runs, ProvedText proved,
          WindowDone& done) {
  const Verification& verification = proved.verification;
  const gcode::Control& target = *setting.options.target;
  done.unchanged = proved.unchanged;
  done.proved = proved.proved;
  done.text = std::move(proved.text);
  done.blocks = proved.blocks;
  done.added_lines = proved.added_lines;
  done.corner_mm = verification.corner_mm;
  done.deviation_mm = verification.deviation_mm;
  done.deviation_line = verification.deviation_line;
  done.read_again = proved.behind.has_value();
  if (proved.behind) done.behind.known = std::move(*proved.behind);
  done.runs = report_runs({part.program, part.meaning, runs.sections, runs.works, runs.cut_runs,
                           verification.stretches, proved.proved});
  done.untold = missing_provenance(done.runs, part.program, target);
  done.form_notes = form_notes(done.runs, part.program, target);
  done.notes = std::move(runs.notes);
  done.near = std::move(runs.near);
  done.near_edges = std::move(proved.near_edges);
  if (!part.program.blocks.empty()) done.last_line = part.program.blocks.back().line;
}

class WindowWork {
 public:
  WindowWork(const WindowSetting& setting, const WindowPlace& place, const Guess& before,
             const ProgressCallback& tell)
      : setting_(setting), place_(place), before_(before), tell_(tell), at_(place.from) {}

  WindowDone run() {
    const ProgramPart part = read();
    PartRuns runs = find_runs(part, setting_.options, setting_.long_runs, setting_.facts);
    Additions additions;
    if (!before_new_.says_smoothed) {
      additions.comment =
          provenance_comment(*setting_.options.target, setting_.options.tolerance_mm);
    }
    WindowDone done = smooth_part(setting_, part, std::move(runs), additions, tell_);
    done.old_behind = at_behind_;
    done.before = before_new_;
    if (done.outcome == WindowOutcome::kDone && !done.proved) {
      done.outcome = WindowOutcome::kNeedsWhole;
    }
    if (done.outcome != WindowOutcome::kDone) return done;
    if (done.unchanged && !done.read_again) done.behind.known = done.old_behind;
    done.behind.says_smoothed = before_new_.says_smoothed || !done.unchanged;
    setting_.source.release_pages({place_.from.text.begin, place_.end});
    return done;
  }

 private:
  struct ReadPart {
    gcode::Program program;
    gcode::Interpretation meaning;
  };

  ReadPart read_on(const gcode::PartEnd& end) {
    gcode::Diagnostics told_before;
    gcode::Program program = gcode::parse_part(setting_.source, end, at_.text, told_before);
    gcode::Interpretation meaning =
        gcode::interpret_part(program, setting_.read_options, at_.before.control, told_before);
    at_.before.events = events_before_next({&program, &meaning, at_.before.events});
    return {std::move(program), std::move(meaning)};
  }

  ProgramPart read() {
    WindowStart start;
    if (at_.text.begin < place_.begin) {
      const ReadPart before = read_on({.byte = place_.begin});
      if (place_.begins_in_run) {
        const auto blocks = static_cast<std::uint32_t>(before.program.blocks.size());
        start.moves_before = moves_before(before.program, before.meaning, blocks);
      }
    }
    before_new_ = before_(at_.before);
    start.old_events = at_.before.events;
    start.new_text = before_new_.known;
    start.words_seen = at_.text.words_seen;
    start.decimals = at_.text.decimals;
    start.same_as_old = knows_the_same(start.new_text, at_.before);
    ReadPart window = read_on({.byte = place_.end});
    at_behind_ = at_.before;
    if (place_.ends_in_run) {
      const ReadPart behind = read_on({.blocks = kNeighbourBlocks});
      start.moves_behind = moves_from(behind.program, behind.meaning, 0);
    }
    return {std::move(window.program), std::move(window.meaning), std::move(start)};
  }

  const WindowSetting& setting_;
  const WindowPlace& place_;
  const Guess& before_;
  const ProgressCallback& tell_;
  ReadingPlace at_;  // what is read up to here
  NewTextBefore before_new_;
  TextBefore at_behind_;  // behind the window, in the old text
};

}  // namespace

WindowDone smooth_part(const WindowSetting& setting, const ProgramPart& part, PartRuns runs,
                       const Additions& additions, const ProgressCallback& tell) {
  WindowDone done;
  done.outcome = WindowOutcome::kStopped;
  const ProgressCallback tell_runs = [&](double share) { return tell(share * kAfterRuns); };
  const ProgressCallback tell_round = [&](double) { return tell(kAfterRuns); };
  if (setting.was_smoothed) {
    keep_as_smoothed(runs);
  } else if (!smooth_runs(part, setting.options, tell_runs, runs)) {
    return done;
  }
  auto proved =
      prove_text(part, setting.options, setting.read_options, additions, tell_round, runs);
  if (!proved) return done;
  done.outcome = proved->stands_alone ? WindowOutcome::kDone : WindowOutcome::kNeedsWhole;
  if (done.outcome != WindowOutcome::kDone) return done;
  take(setting, part, std::move(runs), std::move(*proved), done);
  if (!tell(1)) done.outcome = WindowOutcome::kStopped;
  return done;
}

WindowDone smooth_window(const WindowSetting& setting, const WindowPlace& place,
                         const Guess& before, const ProgressCallback& tell) {
  return WindowWork(setting, place, before, tell).run();
}

bool same_before(const NewTextBefore& a, const NewTextBefore& b) {
  return a.says_smoothed == b.says_smoothed && knows_the_same(a.known, b.known);
}

}  // namespace batten::postproc
