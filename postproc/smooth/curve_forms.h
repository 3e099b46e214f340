// The forms in which one curve could stand in its run's place: curves of the target, few arcs and
// near ones, coarse lines and fine ones. Made are those that may be chosen.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gcode/state/modal_state.h"
#include "geometry/path/curve_pieces.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/methods/run_curve.h"
#include "postproc/smooth/selection/candidate.h"
#include "postproc/smooth/selection/candidate_bounds.h"
#include "postproc/smooth/selection/run_times.h"

namespace batten::postproc {

class CandidateMaker {
 public:
  // Both must live as long.
  CandidateMaker(const RunTask& task, const RunTimes& times) : task_(task), times_(times) {}

  // `old`: what the run takes. The candidate's method, error and curvature are left to who knows
  // them. Nothing where the target cannot say the plan, or there are not enough block numbers.
  [[nodiscard]] std::optional<Candidate> make(const OutputPlan& plan, const Times& old) const;

 private:
  [[nodiscard]] bool take_numbers(std::string& text) const;
  [[nodiscard]] gcode::ModalState state_before() const;

  const RunTask& task_;
  const RunTimes& times_;
};

// Whether curves of the target may be written.
[[nodiscard]] bool curves_wanted(const RunTask& task);

class CurveForms {
 public:
  // Of the tolerance `share` (mm) belongs to the form; `left` (mm) is what the curve leaves. All
  // but the numbers must live as long.
  CurveForms(const RunTask& task, const CandidateMaker& maker, const CandidateBounds& bounds,
             const RunCurve& curve, const CurvatureProfile& bends, double share, double left);

  // Adds candidates to `result`, and what it says of those that were not made.
  void add_to(SmoothedRun& result);

 private:
  // Lines that are no further from the curve than the plan says.
  struct LineForm {
    PlanOptions plan;
    std::optional<Candidate> made;
  };

  // Made before others, to know whether these could be chosen.
  struct Ahead {
    std::optional<Candidate> arcs;  // near to the curve
    std::vector<LineForm> lines;    // some of them made
    bool leaves_out_arcs = false;   // those further away
    bool leaves_out_lines = false;  // all of them
  };

  [[nodiscard]] PlanOptions plan_with(double multiple) const;
  [[nodiscard]] LinesAhead lines_ahead(double deviation) const { return {bends_, deviation}; }
  [[nodiscard]] std::optional<Candidate> made(const std::optional<OutputPlan>& plan,
                                              double error) const;
  [[nodiscard]] std::optional<Candidate> made_arcs(const PlanOptions& options) const;
  [[nodiscard]] std::optional<Candidate> near_arcs() const;
  [[nodiscard]] std::vector<LineForm> line_forms(SmoothedRun& result) const;
  void make(LineForm& form) const;

  void add_curves(SmoothedRun& result) const;
  void add_arc_splines(SmoothedRun& result) const;
  void add_lines(std::vector<LineForm>& forms, SmoothedRun& result) const;
  [[nodiscard]] bool are_beaten(const LineForm& finer, std::optional<std::size_t> last,
                                double deviation, const SmoothedRun& result) const;
  [[nodiscard]] Ahead look_ahead(std::optional<Candidate> arcs, SmoothedRun& result) const;
  [[nodiscard]] bool is_hopeless(const PlanOptions& lines, SmoothedRun& result) const;
  [[nodiscard]] bool may_leave_out() const;
  [[nodiscard]] bool has_quick_curves(const SmoothedRun& result) const;

  const RunTask& task_;
  const CandidateMaker& maker_;
  const CandidateBounds& bounds_;
  const RunCurve& curve_;
  const CurvatureProfile& bends_;
  double share_;
  double left_;
  bool few_wanted_;
  bool
      one_sided_;  // the run must not be cut on one side: what is written follows the curve closely
  geometry::MarkedPieces pieces_;
};

}  // namespace batten::postproc
