// A path cut for planning: into sections between its slow positions, and these into intervals that
// are dense where the machine changes its speed within a short way and sparse where it runs on.
//
// From rest with jerk J, v^3 = 4.5 J s^2: in the potential w = v^1.5 this is the straight line
// w = sqrt(4.5 J) s, and from any speed w grows no faster unless the machine already accelerates.
// So the slow positions of a path make w a chain of straight slopes, its envelope, and sqrt(J) / w
// is the number of times per mm that the machine could change its speed altogether. Without a jerk
// limit the same holds for w = v^2, its slope 2 A, and A / w.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_plan_straight.h"
#include "postproc/machine/planner/feed_search.h"

namespace batten::postproc {

// A part of a piece that bends so little that the derivatives in its middle hold for all of it.
struct FeedPart {
  std::size_t piece = 0;
  double t0 = 0;
  double t1 = 1;
  double length = 0;  // mm
  double cap = 0;     // of the potential: what the bend allows if it were held
  double slope = 0;   // of the potential by mm, the greatest
  double top = 0;     // of the potential, where feed or acceleration end the first phase from rest
  double bend = 0;    // how much the shares of the limits that steady motion takes change over it
  // mm/s, what the joint at its end allows; where the limits change, the lesser feed at the most
  double end_bound = KinematicPathLimits::kNone;
  bool straight = true;
};

// Free: at most at `speed`, with any acceleration. Else at `speed` without acceleration; 0: rest.
struct SectionEnd {
  double speed = 0;  // mm/s
  bool is_free = false;

  [[nodiscard]] bool is_rest() const { return speed == 0; }
};

struct PlannedSection {
  std::span<const FeedPart> parts;
  std::span<const double> w;  // the envelope at the ends of the parts, one more than parts
  SectionEnd start;
  SectionEnd end;

  // One line without a bound on its way, between two slow ends.
  [[nodiscard]] bool is_straight() const;
};

// Of a straight section.
[[nodiscard]] StraightRun straight_run(const PlannedSection& section,
                                       std::span<const geometry::PathPiece> path,
                                       LimitsOfPieces limits);

struct PassedJoints {
  int stops = 0;
  int jumps = 0;  // passed with a bound on the speed
};

// Calls `use` for each section of the path. It ends where the path has to stop, and at joints that
// are 160 times slower than the envelope before and after them: they are passed without
// acceleration. An acceleration there wins on one side and loses on the other, at most 0.15 times
// the square of the ratio of the speeds, as part of the time of a ramp; the envelope is 1.65 times
// what jerk allows between two rests.
//
// Throws std::invalid_argument for limits that are not sound (require_sound), another number of
// them than one or that of the pieces, or negative end speeds.
PassedJoints for_each_section(std::span<const geometry::PathPiece> path, LimitsOfPieces limits,
                              const PlanEnds& ends,
                              const std::function<void(const PlannedSection&)>& use);

struct FeedInterval {
  std::size_t piece = 0;  // where it is
  double t0 = 0;
  double t1 = 1;
  double length = 0;                              // mm
  double end_speed = 0;                           // mm/s, a rough bound at its end
  double end_bound = KinematicPathLimits::kNone;  // mm/s, of the joint at its end
};

struct GridRule {
  double density = 0;         // nodes in the time sqrt(v / jerk), half of what a change by v takes
  double nodes_per_bend = 0;  // for a share of a limit that goes from nothing to all
  double rest_share = 0;      // the interval from rest goes up to this part of the first rise of w
};

// Where a section ends at rest, its outer interval is the motion from rest: constant jerk, or
// constant acceleration where the jerk has no limit.
[[nodiscard]] std::vector<FeedInterval> intervals_of(const PlannedSection& section,
                                                     std::span<const geometry::PathPiece> path,
                                                     LimitsOfPieces limits, const GridRule& rule);

// The motion over an interval `length` mm long from rest, or to rest: speed grows with a power of
// the way (2/3 where the jerk is limited, else 1/2), which constant jerk (or acceleration) gives.
// So p = 2 power q / length at its far end, and the time is length / ((1 - power) v).
struct RestMotion {
  double length = 0;  // mm; 0: there is none
  double power = 2.0 / 3;
  double speed = 0;  // mm/s, the greatest at its far end

  [[nodiscard]] bool is_there() const { return length > 0; }
  [[nodiscard]] double slope() const { return is_there() ? 2 * power / length : 0; }
  [[nodiscard]] double time() const { return length / (1 - power); }  // times 1 / v

  // mm/s^2, for q at the far end: half of dq/ds, where the power leaves one.
  [[nodiscard]] double acceleration_at_rest(double q) const {
    return power > 0.5 ? 0 : 0.5 * q / length;
  }
};

[[nodiscard]] RestMotion rest_motion(const geometry::PathPiece& piece, const FeedInterval& interval,
                                     const KinematicPathLimits& limits);

// States one end of a section, where q is the unknown of number `q`, p the next one, and the limits
// of `place` hold. `slope`: p by q after rest.
void set_end(const SectionEnd& end, const RestMotion& rest, std::size_t q, double slope,
             SearchPlace& place, SearchProblem& problem);

}  // namespace batten::postproc
