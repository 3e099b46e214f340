#include "postproc/stream/window_work.h"

#include <utility>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/part_reading.h"
#include "gcode/state/control_state.h"
#include "postproc/runs/boundary_timing.h"
#include "postproc/stream/form_notes.h"
#include "postproc/stream/part_proof.h"
#include "postproc/stream/provenance.h"

namespace batten::postproc {

namespace {

constexpr double kAfterWindowsRuns = 0.7;  // share of the work

bool knows_the_same(const TextBefore& a, const TextBefore& b) {
  return gcode::same_knowledge(a.control.state, b.control.state) && a.events == b.events;
}

class WindowWork {
 public:
  WindowWork(const WindowSetting& setting, const WindowPlace& place, const Guess& before,
             const ProgressCallback& tell)
      : setting_(setting), place_(place), before_(before), tell_(tell), at_(place.from) {}

  WindowDone run() {
    const ProgramPart part = read();
    PartRuns runs = find_runs(part, setting_.options, setting_.long_runs, setting_.facts);
    const ProgressCallback tell_runs = [this](double share) {
      return tell_(share * kAfterWindowsRuns);
    };
    if (setting_.was_smoothed) {
      keep_as_smoothed(runs);
    } else if (!smooth_runs(part, setting_.options, tell_runs, runs)) {
      return stopped();
    }
    const ProgressCallback tell_round = [this](double) { return tell_(kAfterWindowsRuns); };
    Additions additions;
    if (!done_.before.says_smoothed) {
      additions.comment =
          provenance_comment(*setting_.options.target, setting_.options.tolerance_mm);
    }
    auto proved =
        prove_text(part, setting_.options, setting_.read_options, additions, tell_round, runs);
    if (!proved) return stopped();
    if (!proved->proved || !proved->stands_alone) {
      done_.outcome = WindowOutcome::kNeedsWhole;
      return std::move(done_);
    }
    take(part, std::move(runs), std::move(*proved));
    setting_.source.release_pages({place_.from.text.begin, place_.end});
    if (!tell_(1)) return stopped();
    return std::move(done_);
  }

 private:
  WindowDone stopped() {
    done_.outcome = WindowOutcome::kStopped;
    return std::move(done_);
  }

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
    done_.before = before_(at_.before);
    start.old_events = at_.before.events;
    start.new_text = done_.before.known;
    start.words_seen = at_.text.words_seen;
    start.decimals = at_.text.decimals;
    start.same_as_old = knows_the_same(start.new_text, at_.before);
    ReadPart window = read_on({.byte = place_.end});
    done_.old_behind = at_.before;
    if (place_.ends_in_run) {
      const ReadPart behind = read_on({.blocks = kNeighbourBlocks});
      start.moves_behind = moves_from(behind.program, behind.meaning, 0);
    }
    return {std::move(window.program), std::move(window.meaning), std::move(start)};
  }

  void take(const ProgramPart& part, PartRuns runs, ProvedText proved) {
    const Verification& verification = proved.verification;
    done_.unchanged = proved.unchanged;
    done_.text = std::move(proved.text);
    done_.blocks = proved.blocks;
    done_.corner_mm = verification.corner_mm;
    done_.deviation_mm = verification.deviation_mm;
    done_.deviation_line = verification.deviation_line;
    done_.behind.known = proved.behind ? std::move(*proved.behind) : done_.old_behind;
    done_.behind.says_smoothed = done_.before.says_smoothed || !proved.unchanged;
    done_.runs = report_runs({part.program, part.meaning, runs.sections, runs.works, runs.cut_runs,
                              verification.stretches, true});
    done_.untold = missing_provenance(done_.runs, part.program, *setting_.options.target);
    done_.form_notes = form_notes(done_.runs, part.program, *setting_.options.target);
    done_.notes = std::move(runs.notes);
    done_.near_edges = std::move(proved.near_edges);
    if (!part.program.blocks.empty()) done_.last_line = part.program.blocks.back().line;
  }

  const WindowSetting& setting_;
  const WindowPlace& place_;
  const Guess& before_;
  const ProgressCallback& tell_;
  ReadingPlace at_;  // what is read up to here
  WindowDone done_;
};

}  // namespace

WindowDone smooth_window(const WindowSetting& setting, const WindowPlace& place,
                         const Guess& before, const ProgressCallback& tell) {
  return WindowWork(setting, place, before, tell).run();
}

bool same_before(const NewTextBefore& a, const NewTextBefore& b) {
  return a.says_smoothed == b.says_smoothed && knows_the_same(a.known, b.known);
}

}  // namespace batten::postproc
