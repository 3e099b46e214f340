// One run, smoothed: what could be written instead of it, and what each candidate costs.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "postproc/options/options.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/selection/candidate.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

[[nodiscard]] SmoothedRun smooth_run(const Run& run, const RunContext& context,
                                     const SmoothOptions& options,
                                     CandidateScope scope = CandidateScope::kToChoose,
                                     RunMemo* memo = nullptr, const FormRecord* record = nullptr);

// The same for a repeat of a run that was smoothed with CandidateScope::kToRepeat, `offset` (mm)
// away (postproc/smooth/repeated_runs.h). Nothing where a candidate of that cannot be said there.
[[nodiscard]] std::optional<SmoothedRun> smooth_repeat(const Run& run, const RunContext& context,
                                                       const SmoothOptions& options,
                                                       const SmoothedRun& first,
                                                       const geometry::Vector3& offset);

// A section that may be rewritten, and what became of it.
struct RunState {
  std::size_t section = 0;
  RunContext context;
  SmoothedRun smoothed = {};
  Selection selection = {};
  Outlook outlook = {};
  std::size_t tried = 0;                    // candidates that were given up
  std::string_view reject_reason = {};      // why none of them is left
  std::optional<std::size_t> cut_run = {};  // set for a piece: the run it belongs to
  std::size_t first = 0;                    // vertices of that run
  std::size_t last = 0;

  [[nodiscard]] const Candidate* chosen() const;
  void reject(std::string_view why);   // to its next candidate
  void give_up(std::string_view why);  // all of them
  // Of a piece of `whole`: what is cut around it.
  void surround(const Run& whole);
  // Once it is smoothed: texts, moves and plans of candidates that will not be written take room
  // for nothing. Of a piece, whose moves are held, so do those behind the second best one, and what
  // is around it.
  void drop_what_is_not_written();
  // Makes all candidates anew, also those that were left out or dropped, but for those that were
  // refused: where none is left of the others. For short runs, and pieces of `whole`.
  void start_again(const Run& run, const SmoothOptions& options, const Run* whole = nullptr);

 private:
  void drop_all_but(std::size_t best);
};

// Whether the proof left no candidate of it.
[[nodiscard]] bool is_rejected_by_proof(const RunState& work);

struct CutRun {  // into pieces, which follow each other in the list of works
  Run run;       // the whole
  gcode::PathControl path;
  std::optional<RunFacts> facts = {};  // where the whole was smoothed first
  std::string_view reason = {};        // why the whole was kept then
  Outlook outlook = {};
  std::size_t first_work = 0;
  std::size_t pieces = 0;
  Times before = {};  // of the whole
  Times after = {};   // with the pieces that are rewritten
};

// Pieces were chosen one by one, each beside unchanged neighbours. Gives back the original blocks
// of those that cost most, are larger or are farther off, until nothing speaks against the run as a
// whole (postproc/smooth/selection/cost.h).
void revert_costly_pieces(CutRun& cut, std::vector<RunState>& works, const SmoothOptions& options);

}  // namespace batten::postproc
