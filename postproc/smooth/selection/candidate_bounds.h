// What is known of a run's forms before they are made: what they cost at least.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/basic/point.h"
#include "postproc/machine/machine.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

struct BoundTuning {
  double coarse =
      0.5;  // part of the vertices: of a run with so many coarse ones only corners are left
  // Of their scatter: the fair curve of scattered vertices is no better known, so that a form that
  // is nearer to it is not nearer to the path that was meant.
  double known = 0.5;
  // Of the greatest rounding error of the vertices, what the fair curve leaves of it at the least.
  double rounding_left = 0.4;  // [> CurveForms.OfADenseCircleAreArcs]
  double fewer = 0.8;          // of the blocks that are expected there may be so few
  double least_bytes = 8;      // of a block
  double shorter = 0.9;  // of the bytes of a block in the same form, which it may be shorter than
  double sharp_corner = 30 * geometry::kPi / 180;  // radians: what turns more is meant as a corner
  double corners = 0.5;        // part of the vertices that makes a run one of corners
  double worth_trying = 0.02;  // part of the time: the least that there must be left to win
  // Of the time: what a search for each corner wins at most on the quick rounding of corners.
  double search_wins = 0.1;
  double search_costs = 0.02;  // s for each vertex: less machine time is not worth a search
  // The tube takes some ten milliseconds, and up to one for each point: so many seconds of the
  // machine are worth it, with so many more for each point. Of what is left to win it wins up to a
  // half where that is much, and a tenth where it is less than such a part of the time.
  double tube_wins = 0.1;
  double tube_starts = 0.25;
  double tube_costs = 0.0005;
  std::size_t most_searched = 50;  // points: time-optimal and eight-point corners are searches each
};
inline constexpr BoundTuning kBounds;

// Whether limits of the machine are those along the edges of a run, or the widest.
enum class LimitsOf { kDirections, kAnyDirection };

class CandidateBounds {
 public:
  // All must live as long. `so_far`: the run's times and blocks at least.
  CandidateBounds(const RunTask& task, const SmoothedRun& so_far);

  // s, as the function of that name below.
  [[nodiscard]] double least_time() const { return least_time_; }

  // Whether the program's own chords are coarser than the tolerance nearly everywhere and no time
  // is left to win: a curve could only round their corners, in more blocks than there are.
  [[nodiscard]] bool is_hopeless() const;

  // Whether any such form in about so many blocks, no nearer than this (mm) to the path that was
  // meant, costs more than what there is already, or would not be written anyhow.
  [[nodiscard]] bool is_beaten(Form form, double blocks, double distance) const;

  // In how many blocks such a form may come, at most, for not to be beaten: more than any run has
  // where their number does not matter.
  [[nodiscard]] std::size_t most_blocks(Form form, double distance) const;

 private:
  [[nodiscard]] double least_time_of(LimitsOf of) const;
  [[nodiscard]] double least_bytes(Form form) const;
  [[nodiscard]] Figures least(Form form, double blocks, double distance) const;

  RunTask task_;
  const SmoothedRun& so_far_;
  double least_time_;
};

// s: the length of the run at its feeds, when there were no accelerations to mind.
[[nodiscard]] double time_at_feeds(const Run& run, const Machine& machine);

// Seconds below which no form of the run comes that stays within `tolerance`: from rest to rest
// over its length, less what can be saved at its vertices, at its feeds and within the limits of
// the machine along each edge, or over all directions. Nothing brakes between the ends but sharp
// corners, which no path passes faster than the widest circle within the tolerance and what the
// control rounds by itself under `path` (docs/algorithms/cycle_time.md, What is left to win).
[[nodiscard]] double least_time(const Run& run, double tolerance, const Machine& machine,
                                const gcode::PathControl& path = {},
                                geometry::ToleranceKind kind = geometry::ToleranceKind::kPath,
                                LimitsOf of = LimitsOf::kDirections);

// The part of the run's vertices whose chords would leave a curve through them by more than
// `tolerance`: a run of a coarser one, of which only the corners could be rounded.
[[nodiscard]] double coarse_part(const Run& run, double tolerance);

// mm: the height of the run's chords below a curve through their ends that has its sharp corners,
// rms along the run, as far as it is more than `within`: what a path so near to the run leaves.
[[nodiscard]] double chord_height_beyond(const Run& run, double within);

// Whether another curve may win enough for its work, where the fastest form so far takes `time`
// (s).
[[nodiscard]] bool rounding_is_worth_trying(double least_time, double time);

// The same of the curve of least time in a tube.
[[nodiscard]] bool tube_is_worth_trying(std::size_t points, double least_time, double time);

// Whether half of its vertices or more are corners for what is allowed to the user (mm):
// coarse_part.
[[nodiscard]] bool is_run_of_corners(const Run& run, double user_mm);

// For Method::kBest: whether a method of corners may win on a run. `corners` is coarse_part of it,
// `time` (s) what its fastest form so far takes on the machine.
[[nodiscard]] bool corners_are_worth_trying(double corners, double least_time, double time);

// The same of the methods that search for each corner by itself, which takes milliseconds: where
// rounding has won no time, from `before` to `now`, a better rounding wins none, and of a short run
// not enough.
[[nodiscard]] bool searches_are_worth_trying(std::size_t points, double least_time, double before,
                                             double now);

}  // namespace batten::postproc
