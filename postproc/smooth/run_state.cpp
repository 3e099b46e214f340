#include "postproc/smooth/run_state.h"

#include <algorithm>
#include <span>

#include "gcode/state/reason.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/runs/run_path.h"

namespace batten::postproc {

namespace {

std::span<RunState> pieces_of(const CutRun& cut, std::vector<RunState>& works) {
  return std::span(works).subspan(cut.first_work, cut.pieces);
}

std::vector<TimedPiece> chain_with(const CutRun& cut, std::span<const RunState> pieces) {
  std::vector<TimedPiece> chain;
  chain.reserve(cut.run.points.size());
  for (const RunState& piece : pieces) {
    const Candidate* chosen = piece.chosen();
    if (chosen != nullptr) {
      chain.insert(chain.end(), chosen->moves.begin(), chosen->moves.end());
    } else {
      const std::vector<TimedPiece> moves = timed_pieces(cut.run, piece.first, piece.last);
      chain.insert(chain.end(), moves.begin(), moves.end());
    }
  }
  return chain;
}

// The times of the whole with its pieces as they stand, as far as they must be known: once it is
// slower in one way, the other ways are those of `cut.before`.
Times times_with(const CutRun& cut, std::span<const RunState> pieces, const Machine& machine,
                 bool wanted) {
  const std::vector<TimedPiece> moves = chain_with(cut, pieces);
  TimedChain chain(moves, machine);
  Machine unmerged = machine;
  unmerged.naive_cam_tolerance = 0;
  Times times = cut.before;
  times.as_set = chain.time(machine, cut.path);
  if (wanted || slower(times, cut.before, false, wanted)) return times;
  times.without_merging =
      machine.naive_cam_tolerance > 0 ? chain.time(unmerged, cut.path) : times.as_set;
  if (slower(times, cut.before, false, wanted)) return times;
  chain.lift_feeds(machine);
  times.flat_out = chain.time(machine, cut.path);
  return times;
}

// Seconds that a rewritten piece costs, summed over the settings of the control.
double cost_of(const RunState& piece) {
  Times cost = piece.chosen()->times;
  cost -= piece.smoothed.facts.times;
  return cost.as_set + cost.without_merging + cost.flat_out;
}

}  // namespace

const Candidate* RunState::chosen() const {
  if (tried >= selection.order.size()) return nullptr;
  return &smoothed.candidates[selection.order[tried]];
}

void RunState::reject(std::string_view why) {
  ++tried;
  if (chosen() == nullptr) reject_reason = why;
}

void RunState::start_again(const Run& run, const SmoothOptions& options) {
  smoothed = smooth_run(run, context, options, CandidateScope::kAll);
  selection = choose(smoothed, context, options);
  drop_what_is_not_written();
  tried = 0;
  reject_reason = {};
}

void RunState::drop_what_is_not_written() {
  for (std::size_t i = 0; i < smoothed.candidates.size(); ++i) {
    if (std::ranges::find(selection.order, i) != selection.order.end()) continue;
    smoothed.candidates[i].text.text = {};
    smoothed.candidates[i].moves = {};
  }
}

void revert_costly_pieces(CutRun& cut, std::vector<RunState>& works, const SmoothOptions& options) {
  // So many pieces give way at once that a long run is timed a few times only.
  constexpr std::size_t kShare = 4;
  const std::span<RunState> pieces = pieces_of(cut, works);
  const bool wanted = options.output != Form::kAuto;
  std::vector<RunState*> rewritten;
  for (RunState& piece : pieces) {
    if (piece.chosen() != nullptr) rewritten.push_back(&piece);
  }
  if (cut.before.as_set == 0) {
    cut.before =
        times_of(timed_pieces(cut.run, 0, cut.run.points.size() - 1), *options.machine, cut.path);
  }
  cut.after = cut.before;
  const auto by_cost = [](const RunState* a, const RunState* b) {
    const double cost_a = cost_of(*a);
    const double cost_b = cost_of(*b);
    return cost_a != cost_b ? cost_a < cost_b : a->section < b->section;
  };
  std::sort(rewritten.begin(), rewritten.end(), by_cost);
  while (!rewritten.empty()) {
    cut.after = times_with(cut, pieces, *options.machine, wanted);
    if (!slower(cut.after, cut.before, false, wanted)) return;
    const std::size_t giving = std::max<std::size_t>(1, rewritten.size() / kShare);
    for (std::size_t i = 0; i < giving; ++i) {
      RunState& piece = *rewritten.back();
      rewritten.pop_back();
      while (piece.chosen() != nullptr) piece.reject(gcode::reason::kSlower);
    }
    cut.after = cut.before;
  }
}

}  // namespace batten::postproc
