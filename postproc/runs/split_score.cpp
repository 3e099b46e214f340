#include "postproc/runs/split_score.h"

#include <cmath>
#include <numbers>

namespace batten::postproc {

namespace {

// The machine stops at a reversal anyway.
constexpr double kTurnsBack = 170 * std::numbers::pi / 180;

// At a corner like this the machine slows down whether it is rounded or not; raster rows end so.
constexpr double kSharp = 60 * std::numbers::pi / 180;

// A line that was cut into blocks does not turn between them, but for rounding.
constexpr double kNoTurn = 1e-6;

}  // namespace

Fitness split_score_at(const geometry::Point3& before, const geometry::Point3& at,
                       const geometry::Point3& after) {
  const geometry::Vector3 a = at - before;
  const geometry::Vector3 b = after - at;
  const double turn = std::atan2(a.cross(b).norm(), a.dot(b));
  if (turn > kTurnsBack) return {3, 0};
  if (turn > kSharp) return {2, turn};
  if (turn <= kNoTurn) return {1, 0};
  return {0, -turn};
}

}  // namespace batten::postproc
