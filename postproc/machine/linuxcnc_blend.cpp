#include "postproc/machine/linuxcnc_blend.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace batten::postproc::linuxcnc {
namespace {

using geometry::Vector3;
using std::numbers::pi;

// Turns smaller than this, or nearer to a full reversal, have no blend arc.
constexpr double kLeastAngle = 1e-6;

// Arcs that meet at less than twice 15 degrees are not blended.
constexpr double kLeastArcAngle = pi / 12;

// The plane of the corner is the plane of an arc when their normals are this parallel.
constexpr double kParallel = 1e-6;

// What a corner takes of one of its moves.
struct Reach {
  double length = 0;   // mm at most
  double closing = 0;  // radians by which an arc bending into the corner closes the angle
};

// An arc whose centre lies inside the corner bends towards the other move.
bool bends_inward(const Segment& arc, const Vector3& binormal) {
  return arc.axis.dot(binormal) > 0;
}

Reach arc_reach(const Segment& arc, const Vector3& binormal, double half_angle, double share) {
  if (!bends_inward(arc, binormal)) {
    return {std::min(arc.sweep * share, pi / 2) * arc.radius, 0};
  }
  const double angle = std::min(arc.sweep * share, half_angle);
  return {std::sin(angle / 4) * arc.radius, angle / 4};
}

// The corner takes half of each line, and of arcs two thirds of the one before, one third
// of the one after.
Reach reach_before(const Segment& s, const Vector3& binormal, double half_angle) {
  if (s.shape == Shape::kArc) return arc_reach(s, binormal, half_angle, 2.0 / 3);
  return {std::min(s.length, s.nominal_length / 2), 0};
}

Reach reach_after(const Segment& s, const Vector3& binormal, double half_angle) {
  if (s.shape == Shape::kArc) return arc_reach(s, binormal, half_angle, 1.0 / 3);
  return {s.length / 2, 0};
}

bool in_plane(const Segment& s, const Vector3& binormal) {
  return s.shape != Shape::kArc || s.axis.cross(binormal).norm() < kParallel;
}

// The acceleration that every direction of the plane across `binormal` has.
double plane_limit(const Vector3& binormal, double axis_limit) {
  double most = 0;
  for (int i = 0; i < 3; ++i) most = std::max(most, std::sqrt(1 - std::pow(binormal[i], 2)));
  return axis_limit / most;
}

double blend_tolerance(const Segment& before, const Segment& after, double tolerance) {
  const double quarter = std::min(before.nominal_length, after.nominal_length) / 4;
  return tolerance > 0 ? std::min(tolerance, quarter) : quarter;
}

}  // namespace

// With theta half the angle between the moves, an arc of radius R touches both lines at
// R / tan(theta) from the corner and passes it at R (1 - sin(theta)) / sin(theta).
std::optional<BlendArc> blend_arc(const Segment& before, const Segment& after,
                                  const Machine& machine, double tolerance) {
  const Vector3 cross = before.end_direction.cross(after.start_direction);
  const double turn = std::atan2(cross.norm(), before.end_direction.dot(after.start_direction));
  if (turn < 2 * kLeastAngle || pi - turn < 2 * kLeastAngle) return std::nullopt;
  const Vector3 binormal = cross.normalized();
  if (!in_plane(before, binormal) || !in_plane(after, binormal)) return std::nullopt;

  const double half_angle = (pi - turn) / 2;
  const Reach reach1 = reach_before(before, binormal, half_angle);
  const Reach reach2 = reach_after(after, binormal, half_angle);
  const double theta = half_angle - std::max(reach1.closing, reach2.closing);
  const bool two_arcs = before.shape == Shape::kArc && after.shape == Shape::kArc;
  if (theta <= (two_arcs ? kLeastArcAngle : 0)) return std::nullopt;

  BlendArc arc;
  arc.turn = pi - 2 * theta;
  arc.acceleration = plane_limit(binormal, machine.max_acceleration);
  const double normal_acceleration = kNormalShare * arc.acceleration;
  const double allowed = blend_tolerance(before, after, tolerance);
  const double reach =
      std::min({reach1.length, reach2.length, std::cos(theta) * allowed / (1 - std::sin(theta))});
  const double radius = std::tan(theta) * reach;
  const double feed = std::min(std::max(before.feed, after.feed), machine.max_velocity);
  arc.velocity = std::min(std::sqrt(normal_acceleration * radius), feed);

  // The arc is as long as a parabolic blend of the same corner would be, so that long moves
  // lose little of their length.
  const double parabolic = arc.acceleration / 2;
  const double blend_time = std::min(std::sqrt(2 * parabolic * reach), arc.velocity) / parabolic;
  arc.radius = std::max(arc.velocity * arc.velocity / normal_acceleration,
                        std::min(blend_time * arc.velocity / arc.turn, radius));
  arc.trim = arc.radius / std::tan(theta);
  return arc;
}

}  // namespace batten::postproc::linuxcnc
