// A plan for a run as what could stand in its place: the text, its times, how near it is known to
// be.
#pragma once

#include <optional>
#include <string>

#include "gcode/state/modal_state.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/selection/candidate.h"
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

}  // namespace batten::postproc
