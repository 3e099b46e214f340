#include "postproc/stream/part_proof.h"

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
#include "gcode/state/reason.h"
#include "postproc/stream/added_lines.h"

namespace batten::postproc {

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
    round.verification = verify_in_parallel(before, after, promise, options_.threads);
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
  // the line stands behind a run, for a breach may be noticed late.
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
      // A breach that belongs to no run: believe none of them.
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
  bool stands_alone_ = true;  // no breach has to do with other windows
};

}  // namespace

std::optional<ProvedText> prove_text(const ProgramPart& part, const SmoothOptions& options,
                                     const gcode::ReadOptions& read_options,
                                     const Additions& additions, const ProgressCallback& tell,
                                     PartRuns& runs) {
  return Prover(part, options, read_options, additions, tell, runs).run();
}

}  // namespace batten::postproc
