// A run that is smoothed, in its program, and what could be written instead of it with what each
// candidate costs. Values that the methods, the forms and the selection hand on.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "gcode/state/modal_state.h"
#include "gcode/text/program.h"
#include "gcode/writer/block_numbers.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/packed_moves.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/forms/program_writer.h"
#include "postproc/smooth/methods/run_curve.h"
#include "postproc/smooth/selection/cost.h"
#include "postproc/smooth/selection/form_record.h"

namespace batten::postproc {

struct RunContext {
  const gcode::Program& program;
  const gcode::ModalState& before;  // state after the block before the run
  const gcode::ModalState& after;   // state in which the block after the run must find the control
  std::string_view line_end;
  std::size_t blocks = 0;  // of the run, as they were
  std::size_t bytes = 0;
  LineNumberRange numbers = {};  // for the blocks that replace them
  // What is cut right before and after it: the machine does not come to rest between them.
  std::vector<TimedPiece> lead = {};
  std::vector<TimedPiece> tail = {};
  // Of a run for itself: what of the time with lead and tail is not the run's. Between moves that
  // stay as they are that is all but its time from rest to rest; of a run that was cut from a
  // longer one it is its neighbours' share. Nothing of a piece: what it adds to the times of both
  // alone is asked.
  std::optional<Times> of_neighbours = {};
  double may_win = 0;  // s: by going on from lead or into tail faster than the run does
  std::size_t moves_of_program = 0;  // see RunBudget; 0: there is no other run

  [[nodiscard]] bool is_piece() const { return !of_neighbours && (!lead.empty() || !tail.empty()); }
};

struct Candidate {
  std::string_view method;  // name_of(Method): "fair", "guo" ..
  Form form = Form::kLines;
  RunText text;
  Figures figures;
  double max_curvature = 0;       // 1/mm, greatest of the curve that it was made of
  bool chords_for_steps = false;  // see OutputPlan
  bool arcs_as_chords = false;
  bool has_run_in_place = false;        // in parts where its form alone would be slower
  bool has_vertices = false;            // the run's own, moved: see plan_vertices
  bool rounds_seam = false;             // see geometry::SmoothCurve
  PackedMoves moves;                    // of a piece of a run, and in a RunMemo; empty otherwise
  FormKey key = {};                     // the offer that it was made of
  std::optional<OutputPlan> plan = {};  // where it is asked for (CandidateScope)
};

struct RunFacts {             // whether it is rewritten or not
  CostScale scale;            // with the figures of the blocks as they are
  Form form = Form::kLines;   // of these: arcs where one of them is one
  double length = 0;          // mm
  double off = 0;             // mm, rms distance of its vertices' path from the one that was meant
  double max_curvature = 0;   // 1/mm, circle through three neighbouring vertices
  double noise = 0;           // mm, rms distance of the vertices from the fair curve
  double scattered = 0;       // mm, rms: what its vertices' scatter leaves unknown of that path
  double coarse = 0;          // part of its vertices (coarse_part)
  double fair_curvature = 0;  // 1/mm, greatest of the fair curve
};

struct SmoothedRun {
  RunFacts facts;
  std::vector<Candidate> candidates;  // none where `reason` says why
  std::string_view reason;
  bool left_out = false;  // there are more that the choice would not prefer to the best of these
  bool is_cut_short = false;          // its budget (RunBudget) was spent before all was tried
  std::vector<TriedForm> tried = {};  // each key once
};

// Which candidates are made. Others are of use where the proof of the chosen one fails. Of a run
// that is repeated in other places the plans are kept.
enum class CandidateScope { kToChoose, kToRepeat, kAll };

// What was made of a run already, for options that differ in form, preference and effort only: they
// ask for the same curves and plans over and over. The texts of its candidates are empty.
struct RunMemo {
  template <typename Key, typename Value>
  class Made {
   public:
    // `make` is called where there is none; it is told how many there are.
    template <typename Make>
    const Value& get(const Key& key, const Make& make) {
      const auto known = std::ranges::find(all_, key, &std::pair<Key, Value>::first);
      if (known != all_.end()) return known->second;
      return all_.emplace_back(key, make(all_.size())).second;
    }

   private:
    std::deque<std::pair<Key, Value>> all_;
  };

  // What differs between the requests of one run.
  using CurveKey = std::tuple<Method, CurveRole, double, double, double, double, bool, bool>;
  Made<CurveKey, std::optional<RunCurve>> curves;
  // Of which curve, in which form, along what, and how.
  using PlanKey = std::tuple<std::size_t, Form, Along, PlanOptions>;
  Made<PlanKey, std::optional<Candidate>> candidates;
};

struct RunTask {  // all must live as long
  const Run& run;
  const RunContext& context;
  const SmoothOptions& options;
  CandidateScope scope = CandidateScope::kToChoose;
  RunMemo* memo = nullptr;
  const FormRecord* record = nullptr;  // of like runs; none: nothing is left out by it
};

// Whether its work is bounded (RunBudget): not of who asks for all that there is, or for a method
// by name.
[[nodiscard]] inline bool is_bounded(const RunTask& task) {
  return task.scope != CandidateScope::kAll && task.options.method == Method::kBest;
}

}  // namespace batten::postproc
