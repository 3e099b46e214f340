#include "postproc/stream/window.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include "gcode/reading/parser.h"
#include "gcode/reading/part_reading.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/smooth/forms/provenance.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/misread_arcs.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/system/memory.h"

namespace batten::postproc {

namespace {

// Share of the work: proving costs about as much as smoothing.
constexpr double kAfterRuns = 0.7;

bool knows_the_same(const TextBefore& a, const TextBefore& b) {
  return a.control.state == b.control.state && a.events == b.events;
}

class WindowWork {
 public:
  WindowWork(const WindowSetting& setting, const WindowPlace& place,
             const std::optional<PartSums>& beside)
      : setting_(setting), place_(place), beside_(beside), at_(place.from) {}

  WindowDone run(const Guess& guess, const ProgressCallback& tell) {
    WindowDone done;
    if (setting_.whole) {
      before_ = guess(at_.before);
      old_after_ = at_.before;
      done.part = setting_.whole;
    } else {
      done.part = std::make_shared<const ProgramPart>(read(guess));
    }
    done.before = before_;
    done.old_after = old_after_;
    smooth(tell, done);
    if (done.outcome != WindowOutcome::kDone) return done;
    done.after = {done.proof.after.value_or(old_after_),
                  before_.says_smoothed || !done.proof.unchanged};
    if (!setting_.whole) setting_.source.release_pages({place_.from.text.begin, place_.end});
    return done;
  }

 private:
  gcode::ReadPart read_on(const gcode::PartEnd& end) {
    gcode::Diagnostics ignored;
    gcode::Program program = gcode::parse_part(setting_.source, end, at_.text, ignored);
    gcode::Interpretation meaning =
        gcode::interpret_part(program, setting_.read_options, at_.before.control, ignored);
    at_.before.events = events_before_next({&program, &meaning, at_.before.events});
    return {std::move(program), std::move(meaning)};
  }

  ProgramPart read(const Guess& guess) {
    WindowStart start;
    if (at_.text.begin < place_.begin) {
      const gcode::ReadPart before = read_on({.byte = place_.begin});
      if (place_.begins_in_run) {
        const auto blocks = static_cast<std::uint32_t>(before.program.blocks.size());
        start.moves_before = moves_before(before.program, before.meaning, blocks);
      }
    }
    before_ = guess(at_.before);
    start.old_events = at_.before.events;
    start.new_text = before_.known;
    start.words_seen = at_.text.words_seen;
    start.decimals = at_.text.decimals;
    start.same_as_old = knows_the_same(start.new_text, at_.before);
    gcode::ReadPart window = read_on({.byte = place_.end});
    old_after_ = at_.before;
    if (place_.ends_in_run) {
      const gcode::ReadPart after = read_on({.blocks = kNeighbourBlocks});
      start.moves_behind = moves_from(after.program, after.meaning, 0);
    }
    return {std::move(window.program), std::move(window.meaning), std::move(start)};
  }

  void smooth(const ProgressCallback& tell, WindowDone& done) {
    const ProgramPart& part = *done.part;
    PartRuns runs = find_runs(part, setting_.options, setting_.long_runs, setting_.facts);
    runs.beside = beside_;
    const ProgressCallback tell_runs = [&](double share) { return tell(share * kAfterRuns); };
    const ProgressCallback tell_round = [&](double) { return tell(kAfterRuns); };
    if (setting_.was_smoothed) {
      keep_as_smoothed(runs);
    } else if (setting_.survey) {
      if (!setting_.survey(part, runs, tell_runs)) return;
    } else if (!smooth_runs(part, setting_.options, tell_runs, runs)) {
      return;
    } else if (setting_.options.method != Method::kNone) {
      done.scale.emplace(setting_.options.tolerance_mm);
      done.scale->add(part.program, part.meaning, runs.sections);
    }
    if (!part.window) give_back_free_memory();
    auto proof =
        prove_text(part, setting_.options, setting_.read_options, additions(), tell_round, runs);
    if (!proof) return;
    done.proof = std::move(*proof);
    if (!done.proof.stands_alone || (part.window && !done.proof.proved)) {
      done.outcome = WindowOutcome::kNotProvedAlone;
      return;
    }
    const std::vector<ComparedSection> compared =
        std::exchange(done.proof.verification.sections, {});
    done.runs = report_runs(part, runs, setting_.options.tolerance_mm, compared, done.proof.proved);
    done.stated = stated_in(part.program, part.meaning);
    done.causes.add(part.program, part.meaning, runs.sections, grouping_of(setting_.options),
                    reject_reasons(runs));
    for (const RunState& work : runs.works) {
      if (!work.cut_run) done.outlook += work.outlook;
    }
    for (const CutRun& cut : runs.cut_runs) done.outlook += cut.outlook;
    if (!setting_.survey) done.sums = sums_of(runs.works, runs.cut_runs, setting_.options);
    if (setting_.options.seam == geometry::Seam::kSmooth && !setting_.survey) {
      done.seams.emplace().add(done.runs, part.program);
    }
    done.notes_on_runs = notes_on_runs(done.runs, part.program, *setting_.options.target);
    std::ranges::move(note_misread_arcs(part.program, part.meaning, *setting_.options.target),
                      std::back_inserter(done.notes_on_runs));
    done.notes = std::move(runs.notes);
    done.near = std::move(runs.near);
    if (!part.program.blocks.empty()) done.last_line = part.program.blocks.back().line;
    if (tell(1)) done.outcome = WindowOutcome::kDone;
  }

  // Of each section.
  static std::vector<std::string_view> reject_reasons(const PartRuns& runs) {
    std::vector<std::string_view> reasons(runs.sections.size());
    for (const RunState& work : runs.works) {
      if (work.chosen() != nullptr) continue;
      reasons[work.section] =
          work.reject_reason.empty() ? work.selection.reason : work.reject_reason;
    }
    return reasons;
  }

  [[nodiscard]] Additions additions() const {
    Additions additions;
    additions.words = setting_.words;
    if (!before_.says_smoothed) {
      additions.comment =
          provenance_comment(*setting_.options.target, setting_.options.tolerance_mm);
    }
    return additions;
  }

  const WindowSetting& setting_;
  const WindowPlace& place_;
  const std::optional<PartSums>& beside_;
  ReadingPlace at_;  // what is read up to here
  NewTextBefore before_;
  TextBefore old_after_;
};

}  // namespace

WindowDone smooth_window(const WindowSetting& setting, const WindowPlace& place,
                         const Guess& before, const ProgressCallback& tell,
                         const std::optional<PartSums>& beside) {
  return WindowWork(setting, place, beside).run(before, tell);
}

bool same_before(const NewTextBefore& a, const NewTextBefore& b) {
  return a.says_smoothed == b.says_smoothed && knows_the_same(a.known, b.known);
}

namespace {

// Violations of a run by itself, whose place is known; what a run is rejected for first comes
// first. Other violations may follow from them.
struct Rule {
  ViolationKind kind;
  std::string_view reason;
};
constexpr Rule kOfOneRun[] = {{ViolationKind::kCrossing, gcode::reason::kCrossesItself},
                              {ViolationKind::kSide, gcode::reason::kWrongSide},
                              {ViolationKind::kTarget, gcode::reason::kTargetCannot},
                              {ViolationKind::kDistance, gcode::reason::kNotProved},
                              {ViolationKind::kNotProved, gcode::reason::kNotProved}};

std::vector<std::uint32_t> blocks_at(const std::vector<std::size_t>& bytes,
                                     const gcode::Program& program) {
  std::vector<std::uint32_t> blocks;
  for (const std::size_t byte : bytes) {
    const auto block = std::ranges::lower_bound(
        program.blocks, byte, {}, [](const gcode::Block& each) { return each.span.begin; });
    blocks.push_back(static_cast<std::uint32_t>(block - program.blocks.begin()));
  }
  return blocks;
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
      if (!round.proved && take_back(round)) {
        if (!smooth_rejected()) return std::nullopt;
        revert_growth_of(part_, options_, runs_);
        continue;
      }
      if (round.unchanged) round.near_edges = near_edges(std::nullopt);
      return round;
    }
  }

 private:
  [[nodiscard]] bool anything_rewritten() const {
    return std::ranges::any_of(runs_.works,
                               [](const RunState& work) { return work.chosen() != nullptr; });
  }

  // No proof is needed where both readers know the same, and read the same bytes.
  ProvedText part_itself() {
    ProvedText same;
    if (part_.window && !part_.window->same_as_old) {
      same = verified_text();
      same.text.clear();
    } else {
      same.proved = true;
      same.blocks = part_.program.blocks.size();
    }
    same.unchanged = true;
    return same;
  }

  [[nodiscard]] std::vector<NearEdges> near_edges(const std::optional<WrittenSections>& written) {
    if (!runs_.near || runs_.near->empty()) return {};
    return near_edges_of({&part_.program, &part_.meaning}, runs_.sections, written, *runs_.near,
                         options_.tolerance_mm);
  }

  ProvedText verified_text() {
    ProvedText round;
    AssembledText assembled =
        assemble(part_.program, runs_.sections, runs_.works, additions_, *options_.target);
    const bool adds_nothing = additions_.words.empty();  // then the text itself is proved
    AddedLines added;
    if (adds_nothing) {
      added.text = std::move(assembled.text);
    } else {
      round.text = std::move(assembled.text);
      added = take_added_lines(part_.program, round.text, additions_.words);
    }
    const gcode::SourceText written(part_.program.source.name(), std::move(added.text));
    gcode::Diagnostics ignored;
    gcode::Program program = read_text(written, ignored);
    gcode::ControlCarry control =
        part_.window ? part_.window->new_text.control : gcode::ControlCarry(read_options_.units);
    gcode::Interpretation meaning = gcode::interpret_part(program, read_options_, control, ignored);
    ReadProgram before{&part_.program, &part_.meaning};
    ReadProgram after{&program, &meaning};
    const std::vector<std::uint32_t> begins = blocks_at(assembled.begins, program);
    // Between lines that a profile adds nothing is cut: these lines are gone where it is compared.
    // The proof does not rely on the cuts: its parts together are the whole, wherever they end.
    const std::vector<std::uint32_t> new_cuts =
        adds_nothing ? places_of(runs_.cuts, begins) : std::vector<std::uint32_t>();
    if (!new_cuts.empty()) {
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
    if (adds_nothing && !round.verification.proved()) {
      add_violations_of_pieces(before, after, begins, promise, round.verification);
    }
    for (const auto& more : {added.violations, events_in_brackets(after, added.brackets)}) {
      round.verification.violations.insert(round.verification.violations.end(), more.begin(),
                                           more.end());
    }
    blame_refused(program, begins, round.verification);
    round.added_lines = added.lines;
    round.blocks = program.blocks.size();
    round.proved = round.verification.proved();
    // Lines of a profile stand between the sections; such a program is proved in one.
    if (round.proved && adds_nothing) {
      round.near_edges = near_edges(WrittenSections{after, begins});
    }
    if (part_.window) round.after = {std::move(control), events_before_next(after)};
    if (adds_nothing) round.text = written.text();
    round.read = read_as_written(round.text, {std::move(program), std::move(meaning)});
    return round;
  }

  // With the lines that a profile adds, which are none of what was proved.
  [[nodiscard]] std::shared_ptr<const gcode::ReadPart> read_as_written(
      const std::string& text, gcode::ReadPart without_added) const {
    if (additions_.words.empty()) {
      return std::make_shared<const gcode::ReadPart>(std::move(without_added));
    }
    gcode::Diagnostics ignored;
    gcode::Program program = read_text({part_.program.source.name(), text}, ignored);
    gcode::Interpretation meaning = gcode::interpret(program, read_options_, ignored);
    return std::make_shared<const gcode::ReadPart>(
        gcode::ReadPart{std::move(program), std::move(meaning)});
  }

  // Where sections that begin at such blocks of the old text begin in the new one.
  [[nodiscard]] std::vector<std::uint32_t> places_of(
      const std::vector<std::uint32_t>& old_blocks,
      const std::vector<std::uint32_t>& begins) const {
    std::vector<std::uint32_t> places;
    if (old_blocks.empty()) return places;
    for (std::size_t i = 0; i < begins.size(); ++i) {
      if (std::ranges::binary_search(old_blocks, runs_.sections[i].first_block)) {
        places.push_back(begins[i]);
      }
    }
    return places;
  }

  // A path is compared up to where it leaves the tolerance. So that one round tells of all pieces
  // of runs that do, each is compared by itself as well; what that proves, the whole still has to.
  void add_violations_of_pieces(ReadProgram before, ReadProgram after,
                                const std::vector<std::uint32_t>& begins, const Promise& promise,
                                Verification& verification) const {
    const auto is_apart = [](const Violation& violation) {
      return violation.kind == ViolationKind::kDistance ||
             violation.kind == ViolationKind::kNotProved;
    };
    if (std::ranges::none_of(verification.violations, is_apart)) return;
    std::vector<std::uint32_t> cuts;
    for (const RunState& work : runs_.works) {
      const Section& section = runs_.sections[work.section];
      if (work.cut_run && work.first > 0) cuts.push_back(section.first_block);
    }
    if (cuts.empty()) return;
    std::vector<std::uint32_t> old_cuts;
    std::ranges::set_union(cuts, runs_.cuts, std::back_inserter(old_cuts));
    const std::vector<std::uint32_t> new_cuts = places_of(old_cuts, begins);
    before.cuts = old_cuts;
    after.cuts = new_cuts;
    Verification of_pieces = verify(before, after, promise, options_.threads);
    for (Violation& violation : of_pieces.violations) {
      if (is_apart(violation)) verification.violations.push_back(std::move(violation));
    }
  }

  // What the target refuses is new text: it belongs to the run that it was written for.
  void blame_refused(const gcode::Program& written, const std::vector<std::uint32_t>& begins,
                     Verification& verification) const {
    if (!additions_.words.empty()) return;
    for (Violation& violation : verification.violations) {
      if (violation.kind != ViolationKind::kTarget) continue;
      const auto block =
          std::ranges::lower_bound(written.blocks, violation.new_line, {}, &gcode::Block::line);
      const auto next = std::ranges::upper_bound(begins, block - written.blocks.begin());
      const auto section = static_cast<std::size_t>(next - begins.begin()) - 1;
      violation.old_line = part_.program.blocks[runs_.sections[section].first_block].line;
    }
  }

  [[nodiscard]] gcode::Program read_text(const gcode::SourceText& written,
                                         gcode::Diagnostics& ignored) const {
    if (!part_.window) {
      const gcode::Reading reading{.language = part_.program.language,
                                   .decimals = part_.program.decimals,
                                   .units = read_options_.units,
                                   .keeps_expressions = options_.keep_expressions};
      return gcode::parse(written, reading, ignored);
    }
    gcode::TextCarry carry;
    carry.words_seen = part_.window->words_seen;
    carry.decimals = part_.window->decimals;
    return gcode::parse_part(written, {}, carry, ignored);
  }

  // The last rewritten run that begins up to a line of the input: a violation may be noticed late.
  RunState* rewritten_run_at(std::uint32_t line) {
    RunState* found = nullptr;
    for (RunState& work : runs_.works) {
      if (part_.program.blocks[runs_.sections[work.section].first_block].line > line) break;
      if (work.chosen() != nullptr) found = &work;
    }
    return found;
  }

  // Returns whether any run was rejected. Those with violations of their own first, since the
  // others may follow from them.
  bool take_back(ProvedText& round) {
    std::map<RunState*, const Rule*> blamed;
    std::set<RunState*> others;
    for (const Violation& violation : round.verification.violations) {
      RunState* work = rewritten_run_at(violation.old_line);
      const Rule* rule = std::ranges::find(kOfOneRun, violation.kind, &Rule::kind);
      const bool of_one_run = rule != std::end(kOfOneRun);
      if (part_.window && (work == nullptr || !of_one_run)) {
        round.stands_alone = false;
        return false;
      }
      if (work == nullptr) continue;
      if (!of_one_run) {
        others.insert(work);
        continue;
      }
      const Rule*& known = blamed.try_emplace(work, rule).first->second;
      known = std::min(known, rule);
    }
    for (const auto& [work, rule] : blamed) reject(*work, rule->reason);
    if (!blamed.empty()) return true;
    if (others.empty()) {
      // A violation that belongs to no run: believe none of them.
      for (RunState& work : runs_.works) {
        if (work.chosen() != nullptr) others.insert(&work);
      }
    }
    for (RunState* work : others) reject(*work, gcode::reason::kNotProved);
    return !others.empty();
  }

  // Of a long run that leaves the tolerance somewhere another candidate would do so elsewhere: it
  // is cut at once.
  void reject(RunState& work, std::string_view why) {
    const Run& run = std::get<Run>(runs_.sections[work.section].content);
    if (!work.cut_run && is_long(run) && why == gcode::reason::kNotProved) {
      work.give_up(why);
    } else {
      work.reject(why);
    }
    if (work.cut_run) cuts_to_time_.insert(*work.cut_run);
  }

  // Runs that nothing is left of are smoothed in pieces, so that only those are kept that cannot be
  // proved; where they cannot be cut, what the choice had left out is made. False: stopped.
  bool smooth_rejected() {
    const bool any = std::ranges::any_of(runs_.works, is_rejected_by_proof);
    if (any && !cut_rejected_runs(part_, options_, tell_, runs_)) return false;
    for (RunState& work : runs_.works) {
      if (!is_rejected_by_proof(work) || !work.smoothed.left_out) continue;
      const Run* whole = work.cut_run ? &runs_.cut_runs[*work.cut_run].run : nullptr;
      work.start_again(std::get<Run>(runs_.sections[work.section].content), options_, whole);
    }
    for (const std::size_t cut : std::exchange(cuts_to_time_, {})) {
      revert_costly_pieces(runs_.cut_runs[cut], runs_.works, options_);
    }
    return true;
  }

  const ProgramPart& part_;
  const SmoothOptions& options_;
  const gcode::ReadOptions& read_options_;
  const Additions& additions_;
  const ProgressCallback& tell_;
  PartRuns& runs_;
  std::set<std::size_t> cuts_to_time_;  // cut runs of which a piece was rejected
};

}  // namespace

std::optional<ProvedText> prove_text(const ProgramPart& part, const SmoothOptions& options,
                                     const gcode::ReadOptions& read_options,
                                     const Additions& additions, const ProgressCallback& tell,
                                     PartRuns& runs) {
  return Prover(part, options, read_options, additions, tell, runs).run();
}

}  // namespace batten::postproc
