// A move in the queue of LinuxCNC's planner, and the rules that need one move or two.
#pragma once

#include <cstdint>
#include <optional>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc::linuxcnc {

// Shares of the acceleration across and along a bend: 1 = (sqrt(3)/2)^2 + (1/2)^2.
inline constexpr double kNormalShare = 0.8660254037844386;
inline constexpr double kTangentialShare = 0.5;

// Share of the acceleration that the kink of a joint may take ([TRAJ]ARC_BLEND_KINK_RATIO).
inline constexpr double kKinkShare = 0.1;

enum class Shape { kLine, kArc, kBlendArc };

// How a move ends.
enum class Joint {
  kStop,
  kExactPath,  // stops unless it is found tangent
  kParabolic,  // overlaps the next move; also the last move before its follower is known
  kTangent,
};

struct Segment {
  Shape shape = Shape::kLine;
  double length = 0;          // mm; shrinks when corners are blended
  double nominal_length = 0;  // mm, as programmed
  double feed = 0;            // mm/s, as programmed
  double max_velocity = 0;    // mm/s
  double acceleration = 0;    // mm/s^2
  geometry::Vector3 start_direction = geometry::Vector3::Zero();
  geometry::Vector3 end_direction = geometry::Vector3::Zero();

  // Arcs only.
  double radius = 0;        // mm, seen along the axis
  double speed_radius = 0;  // mm: the radius by which the control judges the speed
  double sweep = 0;         // radians, above 0
  geometry::Vector3 axis = geometry::Vector3::Zero();  // unit length; zero: not plane
  double tangential_share = kTangentialShare;

  Joint end = Joint::kStop;
  bool after_parabolic = false;
  double kink_velocity = kNoLimit;  // mm/s at the end
  double kink_share_at_start = 0;   // of the acceleration, taken by the joint
  double kink_share_at_end = 0;

  // Of its path the ends are cut off (mm of the nominal length).
  double cut_at_start = 0;
  double cut_at_end = 0;
  std::uint32_t first_piece = 0;  // of the program's chain
  std::uint32_t last_piece = 0;
};

// What the machine allows on X, Y and Z.
struct SpaceLimits {
  geometry::Vector3 velocity;        // mm/s, while cutting
  geometry::Vector3 rapid_velocity;  // mm/s
  geometry::Vector3 acceleration;    // mm/s^2
  double path_feed;                  // mm/s, in any move
  double period;                     // s: no move is shorter
};

[[nodiscard]] SpaceLimits space_limits(const Machine& machine);

// A line or an arc as it comes from the program. Bends that are not arcs count as arcs of
// their greatest curvature.
[[nodiscard]] Segment segment_of(const TimedPiece& timed, const SpaceLimits& limits, Joint end);

// What kinks and parabolic blends leave of the acceleration.
[[nodiscard]] double usable_acceleration(const Segment& s);
// The part of it that speeds up and slows down.
[[nodiscard]] double tangential_acceleration(const Segment& s);

// The speed that is asked for, as far as the move allows it.
[[nodiscard]] double target_velocity(const Segment& s);

// Called when the length no longer changes: sets the limits that depend on it.
void finish_segment(Segment& s, double period);

// The kink at the joint as a share of the least axis acceleration, at full speed. `acceleration`:
// of the axes; `period`: of the servo, s.
[[nodiscard]] double kink_at_full_speed(const Segment& before, const Segment& after,
                                        const geometry::Vector3& acceleration, double period);

// The speed at which one move hands over to the next in a parabolic blend (mm/s).
[[nodiscard]] double parabolic_velocity(const Segment& before, const Segment& after,
                                        double tolerance);

// The arc that LinuxCNC puts into a corner under G64.

struct BlendArc {
  double radius = 0;        // mm
  double turn = 0;          // radians
  double trim_before = 0;   // mm that it takes from the end of the move before
  double trim_after = 0;    // mm that it takes from the start of the move after
  double velocity = 0;      // mm/s
  double acceleration = 0;  // mm/s^2
};

// Nothing where the two moves have no blend arc: they do not lie in one plane, turn
// back, or bend so much that no arc fits within the tolerance.
// `tolerance` (mm) is P; 0 stands for a quarter of the shorter move.
[[nodiscard]] std::optional<BlendArc> blend_arc(const Segment& before, const Segment& after,
                                                const Machine& machine, double tolerance);

}  // namespace batten::postproc::linuxcnc
