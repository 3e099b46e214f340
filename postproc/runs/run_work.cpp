#include "postproc/runs/run_work.h"

#include <algorithm>
#include <span>

#include "gcode/reason.h"

namespace batten::postproc {

namespace {

std::span<RunWork> pieces_of(const CutRun& cut, std::vector<RunWork>& works) {
  return std::span(works).subspan(cut.first_work, cut.pieces);
}

Times times_with(const CutRun& cut, std::span<const RunWork> pieces, const Machine& machine) {
  std::vector<TimedPiece> chain;
  for (const RunWork& piece : pieces) {
    const Candidate* chosen = piece.chosen();
    const std::vector<TimedPiece> moves =
        chosen != nullptr ? chosen->moves : timed_pieces(cut.run, piece.first, piece.last);
    chain.insert(chain.end(), moves.begin(), moves.end());
  }
  return times_of(chain, machine, cut.path);
}

// Seconds that a rewritten piece costs, summed over the settings of the control.
double cost_of(const RunWork& piece) {
  Times cost = piece.chosen()->times;
  cost -= piece.smoothed.facts.times;
  return cost.as_set + cost.without_merging + cost.flat_out;
}

}  // namespace

const Candidate* RunWork::chosen() const {
  if (tried >= choosing.order.size()) return nullptr;
  return &smoothed.candidates[choosing.order[tried]];
}

void RunWork::give_way(std::string_view why) {
  ++tried;
  if (chosen() == nullptr) went_back = why;
}

void RunWork::drop_what_is_not_written() {
  for (std::size_t i = 0; i < smoothed.candidates.size(); ++i) {
    if (std::ranges::find(choosing.order, i) != choosing.order.end()) continue;
    smoothed.candidates[i].text.text = {};
    smoothed.candidates[i].moves = {};
  }
}

void settle(CutRun& cut, std::vector<RunWork>& works, const SmoothOptions& options) {
  // So many pieces give way at once that a long run is timed a few times only.
  constexpr std::size_t kShare = 4;
  const std::span<RunWork> pieces = pieces_of(cut, works);
  const bool wanted = options.output != Form::kAuto;
  std::vector<RunWork*> rewritten;
  for (RunWork& piece : pieces) {
    if (piece.chosen() != nullptr) rewritten.push_back(&piece);
  }
  if (cut.before.as_set == 0) {
    cut.before =
        times_of(timed_pieces(cut.run, 0, cut.run.points.size() - 1), *options.machine, cut.path);
  }
  cut.after = cut.before;
  const auto by_cost = [](const RunWork* a, const RunWork* b) {
    const double cost_a = cost_of(*a);
    const double cost_b = cost_of(*b);
    return cost_a != cost_b ? cost_a < cost_b : a->section < b->section;
  };
  std::sort(rewritten.begin(), rewritten.end(), by_cost);
  while (!rewritten.empty()) {
    cut.after = times_with(cut, pieces, *options.machine);
    if (!slower(cut.after, cut.before, false, wanted)) return;
    const std::size_t giving = std::max<std::size_t>(1, rewritten.size() / kShare);
    for (std::size_t i = 0; i < giving; ++i) {
      RunWork& piece = *rewritten.back();
      rewritten.pop_back();
      while (piece.chosen() != nullptr) piece.give_way(gcode::reason::kSlower);
    }
    cut.after = cut.before;
  }
}

}  // namespace batten::postproc
