// One run, smoothed: what could be written instead of it, and what each candidate costs.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "gcode/modal_state.h"
#include "gcode/program.h"
#include "postproc/machine/cycle_time.h"
#include "postproc/options.h"
#include "postproc/plan/output_plan.h"
#include "postproc/runs/section.h"
#include "postproc/writing/block_numbers.h"
#include "postproc/writing/program_writer.h"

namespace batten::postproc {

// Seconds on the machine under each way in which its control may be set. A program rarely says
// how, and what is faster under one setting must not be slower under another.
struct Times {
  double as_set = 0;           // as the machine's model says
  double without_merging = 0;  // LinuxCNC: G64 P with Q0, lines are not joined before planning
  double flat_out = 0;         // whatever the F words say, as with the feed override turned up
  double exact_path = 0;       // G61: kinks cost stops

  Times& operator+=(const Times& other);
  Times& operator-=(const Times& other);
};

// Where a run stands.
struct RunContext {
  const gcode::Program& program;
  const gcode::ModalState& before;  // state after the block before the run
  const gcode::ModalState& after;   // state in which the block after the run must find the control
  std::string_view line_end;
  std::size_t blocks = 0;  // of the run, as they were
  std::size_t bytes = 0;
  NumberRoom numbers = {};  // for the blocks that take their place
  // What is cut right before and after it, where it is a piece of a longer run: a piece is not
  // run from rest to rest.
  std::vector<TimedPiece> lead = {};
  std::vector<TimedPiece> tail = {};
  // Of a run for itself that was cut from a longer one: what of the time with lead and tail belongs
  // to its neighbours. Nothing of a piece: what it adds to the times of both alone is asked.
  std::optional<Times> of_neighbours = {};

  [[nodiscard]] bool is_piece() const { return !of_neighbours && (!lead.empty() || !tail.empty()); }
};

// Of a chain that starts and ends at rest. `path`: as the program says.
[[nodiscard]] Times times_of(const std::vector<TimedPiece>& chain, const Machine& machine,
                             gcode::PathMode path);

// The motions of a run between two of its vertices.
[[nodiscard]] std::vector<TimedPiece> timed_pieces(const Run& run, std::size_t first,
                                                   std::size_t last);

struct Candidate {
  std::string_view method;  // name_of(Method): "fair", "guo" ..
  OutputForm form = OutputForm::kLines;
  RunText text;
  double error = 0;  // mm, the written form from the path that was meant, as far as it is known
  double max_curvature = 0;  // 1/mm, greatest of the curve that it was made of
  double kink = 0;           // radians, see greatest_kink; 0 where the run is one of lines
  Times times;
  std::vector<TimedPiece> moves;  // of a piece of a run; empty otherwise
};

// What is known of a run, whether it is rewritten or not.
struct RunFacts {
  Times times;
  double max_curvature = 0;   // 1/mm, circle through three neighbouring vertices
  double noise = 0;           // mm, rms distance of the vertices from the fair curve
  double error = 0;           // mm, how far the old path is from the one that was meant
  double fair_curvature = 0;  // 1/mm, greatest of the fair curve
  double kink = 0;            // radians, greatest between motions of a run with arcs, or 0
};

struct SmoothedRun {
  RunFacts facts;
  std::vector<Candidate> candidates;  // none where `reason` says why
  std::string_view reason;
};

[[nodiscard]] SmoothedRun smooth_run(const Run& run, const RunContext& context,
                                     const SmoothOptions& options);

}  // namespace batten::postproc
