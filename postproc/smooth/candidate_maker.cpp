#include "postproc/smooth/candidate_maker.h"

#include <utility>
#include <vector>

#include "postproc/runs/run_path.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

namespace {

std::vector<TimedPiece> timed_pieces(const OutputPlan& plan) {
  std::vector<TimedPiece> pieces;
  pieces.reserve(plan.moves.size());
  for (const PlannedMove& move : plan.moves) pieces.push_back({move.piece, move.feed});
  return pieces;
}

}  // namespace

std::optional<Candidate> CandidateMaker::make(const OutputPlan& plan, const Times& old) const {
  const auto& [run, context, options, scope] = task_;
  auto text = write_run(plan, run, context.program, *options.target, state_before(), context.after,
                        context.line_end);
  if (!text || !take_numbers(text->text)) return std::nullopt;
  Candidate candidate;
  candidate.form = plan.form;
  candidate.chords_for_steps = plan.chords_for_steps;
  candidate.moves = timed_pieces(plan);
  if (!run.arcs.empty()) candidate.kink = greatest_kink(candidate.moves);
  candidate.times = times_.of_candidate(candidate.moves, text->blocks, old, compares_kinks(options),
                                        options.output != Form::kAuto);
  candidate.text = std::move(*text);
  return candidate;
}

// False where there are not enough of them. The comment that says what was done takes one too.
bool CandidateMaker::take_numbers(std::string& text) const {
  const LineNumberRange& numbers = task_.context.numbers;
  if (!numbers.first) return true;
  if (numbered_lines(text) + 1 > numbers.blocks) return false;
  text = with_numbers(text, *numbers.first);
  return true;
}

// Behind words of a profile the run says its motion and its feed itself.
gcode::ModalState CandidateMaker::state_before() const {
  gcode::ModalState before = task_.context.before;
  if (!task_.options.words.before_run.empty()) {
    before.motion = gcode::MotionMode::kUnknown;
    before.feed.reset();
  }
  return before;
}

}  // namespace batten::postproc
