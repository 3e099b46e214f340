// Parts of a plan on which the control loses more time than on the run itself, and the run in
// their place: tight arcs, joints that are not quite tangent, chords that it brakes along, arcs
// that begin or end at rest. So a form that is slower in a few places is none that is slower.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {

struct SlowPartTuning {
  double slow = 0.005;           // of a move's time at its feed: so much more lost is slow
  std::size_t wider_by = 2;      // moves on each side that may go with the slow ones
  double short_arc = 4;          // behind the run at an end, of the way that the run goes there
  double of_arc = 0.5;           // that the run may take; of what is left, the short arc
  std::size_t timed_beside = 8;  // moves on each side that a part is timed with
};
inline constexpr SlowPartTuning kSlowParts;

// Moves of a plan, from one to another.
struct SlowPart {
  std::size_t first = 0;
  std::size_t last = 0;
  double won = 0;  // s, by the run in place of them; above 0
};

// Of the plans of lines or arcs of one curve; the run has no arcs itself. All must live as long.
class SlowParts {
 public:
  // `path`: of the run.
  SlowParts(const Run& run, const geometry::SmoothCurve& fair, const Machine& machine,
            const gcode::PathControl& path);

  // s, of each move: what the control loses against its feed, less what it loses on the run there,
  // both from rest to rest.
  [[nodiscard]] std::vector<double> lost(const OutputPlan& plan) const;

  // Where the run is faster; in order, apart from each other. `lost`: of the plan.
  [[nodiscard]] std::vector<SlowPart> find(const OutputPlan& plan,
                                           std::span<const double> lost) const;

  // The plan with the run where it begins and ends by arcs, for the way from rest to the feed, and
  // a short arc between that and the rest of each: what the control makes of the joint slows a
  // whole move. Nothing where the plan has no such arc, or none that is long enough.
  [[nodiscard]] std::optional<OutputPlan> with_run_at_ends(const OutputPlan& plan) const;

  // The plan with the run in place of those parts. Nothing where there are none, or no arc is left
  // of a plan of arcs.
  [[nodiscard]] std::optional<OutputPlan> with_run(const OutputPlan& plan,
                                                   std::span<const SlowPart> parts) const;

 private:
  class Search;

  [[nodiscard]] double way_to_feed(double feed) const;
  [[nodiscard]] bool begins_with_run(OutputPlan& plan) const;
  [[nodiscard]] bool ends_with_run(OutputPlan& plan) const;
  void append_run(const OutputPlan& plan, const SlowPart& part,
                  std::vector<PlannedMove>& moves) const;

  const Run& run_;
  const geometry::SmoothCurve& fair_;
  const Machine& machine_;
  gcode::PathControl path_;
  std::vector<double> lost_before_;  // s, on the run, up to each of its points
};

// Those that win the most, as many as win so many seconds; in order.
[[nodiscard]] std::vector<SlowPart> enough_of(std::vector<SlowPart> parts, double seconds);

// A plan, and the run in its slow parts: what of it is slow is found once.
class MendedPlan {
 public:
  // `parts` must live as long.
  MendedPlan(const SlowParts& parts, OutputPlan plan) : parts_(parts), plan_(std::move(plan)) {}

  // s: what the run may win in all, where it is faster.
  [[nodiscard]] double lost();

  // With the run there. `slower_by`: s, what it is to win where it is needed. Nothing where it can
  // have the run nowhere.
  [[nodiscard]] std::optional<OutputPlan> with_run(RunInPlace where, double slower_by);

 private:
  [[nodiscard]] const std::vector<double>& lost_by_moves();

  const SlowParts& parts_;
  OutputPlan plan_;
  std::optional<std::vector<double>> lost_;
  std::optional<std::vector<SlowPart>> slow_;
};

}  // namespace batten::postproc
