#include "postproc/stream/window.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/part_reading.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "postproc/runs/long_run_cuts.h"
#include "postproc/stream/added_lines.h"
#include "postproc/stream/provenance.h"

namespace batten::postproc {

namespace {

// Share of the work: proving costs about as much as smoothing.
constexpr double kAfterRuns = 0.7;

bool knows_the_same(const TextBefore& a, const TextBefore& b) {
  return a.control.state == b.control.state && a.events == b.events;
}

// What the proof and the reports of the runs say of a part.
void take(const WindowSetting& setting, const ProgramPart& part, PartRuns runs, ProvedText proved,
          WindowDone& done) {
  const Verification& verification = proved.verification;
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
  done.notes_on_runs = notes_on_runs(done.runs, part.program, *setting.options.target);
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

void CollectedResult::take(WindowDone window) {
  notes_.add(window.notes, result.diagnostics);
  result.blocks_out += window.blocks;
  result.added_lines += window.added_lines;
  result.corner_mm = std::max(result.corner_mm, window.corner_mm);
  if (window.deviation_mm > result.deviation_mm) {
    result.deviation_mm = window.deviation_mm;
    result.deviation_line = window.deviation_line;
  }
  for (gcode::Diagnostic& note : window.notes_on_runs) {  // one of each is enough
    if (std::ranges::find(notes_on_runs_, note.id, &gcode::Diagnostic::id) ==
        notes_on_runs_.end()) {
      notes_on_runs_.push_back(std::move(note));
    }
  }
  for (RunReport& run : window.runs) {
    result.time_before_s += run.time_before_s;
    result.time_after_s += run.time_after_s;
    result.runs.push_back(std::move(run));
  }
}

void CollectedResult::finish() {
  notes_.tell_rest(result.diagnostics);
  std::ranges::move(notes_on_runs_, std::back_inserter(result.diagnostics));
  result.understood = true;
}

namespace {

void add_violations(const AddedLines& added, const ReadProgram& read, Verification& verification) {
  const auto add = [&](const std::vector<Violation>& violations) {
    verification.violations.insert(verification.violations.end(), violations.begin(),
                                   violations.end());
  };
  add(added.violations);
  add(events_in_brackets(read, added.brackets));
}

// Violations of one stretch, which no other stretch has a part in.
bool is_of_one_stretch(const Violation& violation) {
  return violation.kind == ViolationKind::kDistance ||
         violation.kind == ViolationKind::kNotProved || violation.kind == ViolationKind::kSide ||
         violation.kind == ViolationKind::kCrossing || violation.kind == ViolationKind::kTarget;
}

class Prover {
 public:
  Prover(const ProgramPart& part, const SmoothOptions& options,
         const gcode::ReadOptions& read_options, const Additions& additions,
         const ProgressCallback& tell, PartRuns& runs)
      : part_(part),
        options_(options),
        read_options_(read_options),
        additions_(additions),
        tell_(tell),
        runs_(runs) {}

  std::optional<ProvedText> run() {
    while (true) {
      ProvedText round = anything_rewritten() ? verified_text() : part_itself();
      if (!tell_(0)) return std::nullopt;
      if (!round.proved && take_back(round.verification)) continue;
      round.stands_alone = stands_alone_;
      if (round.unchanged) round.near_edges = near_edges(std::nullopt);
      return round;
    }
  }

 private:
  [[nodiscard]] bool anything_rewritten() const {
    return std::ranges::any_of(runs_.works,
                               [](const RunState& work) { return work.chosen() != nullptr; });
  }

  // Both readers know the same, and read the same bytes.
  [[nodiscard]] bool needs_no_proof() const { return !part_.window || part_.window->same_as_old; }

  ProvedText part_itself() {
    if (!needs_no_proof()) {
      ProvedText same = verified_text();
      same.unchanged = true;
      same.text.clear();
      return same;
    }
    ProvedText same;
    same.unchanged = true;
    same.proved = true;
    same.blocks = part_.program.blocks.size();
    return same;
  }

  [[nodiscard]] std::vector<NearEdges> near_edges(const std::optional<WrittenSections>& written) {
    if (!runs_.near || runs_.near->empty()) return {};
    return near_edges_of({&part_.program, &part_.meaning}, runs_.sections, written, *runs_.near,
                         options_.tolerance_mm);
  }

  ProvedText verified_text() {
    ProvedText round;
    AssembledText assembled = assemble(part_.program, runs_.sections, runs_.works, additions_);
    round.text = std::move(assembled.text);
    AddedLines added = take_added_lines(part_.program, round.text, additions_.words);
    const gcode::SourceText written(part_.program.source.name(), std::move(added.text));
    gcode::Diagnostics ignored;
    const gcode::Program program = read_text(written, ignored);
    gcode::ControlCarry control =
        part_.window ? part_.window->new_text.control : gcode::ControlCarry(read_options_.units);
    const gcode::Interpretation meaning =
        gcode::interpret_part(program, read_options_, control, ignored);
    ReadProgram before{&part_.program, &part_.meaning};
    ReadProgram after{&program, &meaning};
    std::vector<std::uint32_t> new_cuts;
    // Between lines that a profile adds nothing is cut: these lines are gone where it is compared.
    if (!runs_.cuts.empty() && additions_.words.empty()) {
      new_cuts = cuts_in(program, assembled.begins);
      before.cuts = runs_.cuts;
      after.cuts = new_cuts;
    }
    if (part_.window) {
      before.before = part_.window->old_events;
      after.before = part_.window->new_text.events;
    }
    const Promise promise(options_.tolerance_mm, options_.tolerance_kind, options_.side,
                          options_.target);
    round.verification = verify(before, after, promise, options_.threads);
    add_violations(added, after, round.verification);
    blame_refused(program, assembled.begins, round.verification);
    round.added_lines = added.lines;
    round.blocks = program.blocks.size();
    round.proved = round.verification.proved();
    // Lines of a profile stand between the sections; such a program is proved in one.
    if (round.proved && additions_.words.empty()) {
      round.near_edges = near_edges(WrittenSections{after, assembled.begins});
    }
    if (part_.window) {
      round.behind = {std::move(control), events_before_next(after)};
    }
    return round;
  }

  // What the target refuses is new text: it belongs to the run that it was written for. Lines of a
  // profile stand between the sections: nearly is near enough to find the run.
  void blame_refused(const gcode::Program& written, const std::vector<std::size_t>& begins,
                     Verification& verification) const {
    if (!additions_.words.empty()) return;
    for (Violation& violation : verification.violations) {
      if (violation.kind != ViolationKind::kTarget) continue;
      const auto block =
          std::ranges::lower_bound(written.blocks, violation.new_line, {}, &gcode::Block::line);
      const auto next = std::ranges::upper_bound(begins, std::size_t{block->span.begin});
      const auto section = static_cast<std::size_t>(next - begins.begin()) - 1;
      violation.old_line = part_.program.blocks[runs_.sections[section].first_block].line;
    }
  }

  // Where the sections that begin at cuts begin in the new text. The proof does not rest on it: its
  // pieces together are the whole, wherever they end.
  [[nodiscard]] std::vector<std::uint32_t> cuts_in(const gcode::Program& program,
                                                   const std::vector<std::size_t>& begins) const {
    std::vector<std::uint32_t> cuts;
    for (std::size_t i = 0; i < runs_.sections.size(); ++i) {
      if (!std::ranges::binary_search(runs_.cuts, runs_.sections[i].first_block)) continue;
      const auto block = std::ranges::lower_bound(
          program.blocks, begins[i], {}, [](const gcode::Block& b) { return b.span.begin; });
      cuts.push_back(static_cast<std::uint32_t>(block - program.blocks.begin()));
    }
    return cuts;
  }

  [[nodiscard]] gcode::Program read_text(const gcode::SourceText& written,
                                         gcode::Diagnostics& ignored) const {
    if (!part_.window) {
      const gcode::Reading reading{part_.program.language, part_.program.decimals,
                                   read_options_.units};
      return gcode::parse(written, reading, ignored);
    }
    gcode::TextCarry carry;
    carry.words_seen = part_.window->words_seen;
    carry.decimals = part_.window->decimals;
    return gcode::parse_part(written, {}, carry, ignored);
  }

  // The rewritten run that holds a line of the input; the nearest rewritten one before it where
  // the line stands behind a run, for a violation may be noticed late.
  RunState* rewritten_run_at(std::uint32_t line) {
    RunState* found = nullptr;
    for (RunState& work : runs_.works) {
      if (part_.program.blocks[runs_.sections[work.section].first_block].line > line) break;
      if (work.chosen() != nullptr) found = &work;
    }
    return found;
  }

  // Returns whether any run gave way.
  bool take_back(const Verification& verification) {
    std::vector<RunState*> blamed;
    std::vector<RunState*> crossing;
    std::vector<RunState*> over;
    std::vector<RunState*> refused;
    for (const Violation& violation : verification.violations) {
      RunState* work = rewritten_run_at(violation.old_line);
      if (part_.window && (work == nullptr || !is_of_one_stretch(violation))) {
        stands_alone_ = false;
        return false;
      }
      if (work == nullptr) continue;
      switch (violation.kind) {
        case ViolationKind::kCrossing:
          crossing.push_back(work);
          break;
        case ViolationKind::kSide:
          over.push_back(work);
          break;
        case ViolationKind::kTarget:
          refused.push_back(work);
          break;
        default:
          blamed.push_back(work);
      }
    }
    if (reject(std::move(crossing), gcode::reason::kCrossesItself)) return true;
    if (reject(std::move(over), gcode::reason::kWrongSide)) return true;
    if (reject(std::move(refused), gcode::reason::kTargetCannot)) return true;
    if (blamed.empty()) {
      // A violation that belongs to no run: believe none of them.
      for (RunState& work : runs_.works) {
        if (work.chosen() != nullptr) blamed.push_back(&work);
      }
    }
    return reject(std::move(blamed), gcode::reason::kNotProved);
  }

  bool reject(std::vector<RunState*> works, std::string_view why) {
    std::sort(works.begin(), works.end());
    works.erase(std::unique(works.begin(), works.end()), works.end());
    for (RunState* work : works) {
      work->reject(why);
      if (work->chosen() == nullptr && work->smoothed.left_out) {
        work->start_again(std::get<Run>(runs_.sections[work->section].content), options_);
      }
      if (work->cut_run)
        revert_costly_pieces(runs_.cut_runs[*work->cut_run], runs_.works, options_);
    }
    return !works.empty();
  }

  const ProgramPart& part_;
  const SmoothOptions& options_;
  const gcode::ReadOptions& read_options_;
  const Additions& additions_;
  const ProgressCallback& tell_;
  PartRuns& runs_;
  bool stands_alone_ = true;  // no violation has to do with other windows
};

}  // namespace

std::optional<ProvedText> prove_text(const ProgramPart& part, const SmoothOptions& options,
                                     const gcode::ReadOptions& read_options,
                                     const Additions& additions, const ProgressCallback& tell,
                                     PartRuns& runs) {
  return Prover(part, options, read_options, additions, tell, runs).run();
}

}  // namespace batten::postproc
