// The path that was meant, as smooth as the machine needs it: our own smoother.
// Method: docs/algorithms/fair.md.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct FairOptions {
  double tolerance = 0.01;         // mm, curve to polyline and back, in order; > 0
  double rounding = 0.0005;        // mm, greatest error of one printed coordinate of the input
  double keep_corner_angle = 3.2;  // radians: vertices that turn more stay as they are (> pi: none)
  double feed = 1000;              // mm/min that the machine should hold (the greatest of the run)
  double acceleration = 1000;      // mm/s^2 across the path that the machine can give
  double jerk = std::numeric_limits<double>::infinity();  // mm/s^3, the same
  double scatter = 0;     // mm that vertices may scatter about the curve, beyond their noise:
                          // a simpler curve, further from the path that was meant
  bool accurate = false;  // spend the tolerance on noise only, never on feed
  // Pass vertices as near as their decimals tell their places, which takes more control points;
  // else as near as their rounding lets them scatter.
  bool near = true;
  // Per edge, from each point to the next: the part of the tolerance that the curve may use there,
  // above 0 and 1 at most. Empty: all of it everywhere. Has to outlive the call.
  std::span<const double> rooms;
};

struct SmoothCurve {
  // A cubic, C2 but at kept corners (triple knots). Parameter: about the length along the
  // polyline in mm. Long lines of the input are exactly straight spans of it.
  BsplineCurve curve;
  // Parameter of each input point, not decreasing; front() == curve.first(), back() ==
  // curve.last().
  std::vector<double> vertex_parameters;
  // mm, estimated by samples; the proof is the verifier's. Above the tolerance where the band
  // could not be held: the caller has to look.
  double deviation = 0;
  double noise = 0;  // mm, estimated scatter of the vertices about the curve (rms)
  int kept_corners = 0;
  int rounds = 0;  // how often the band was widened for the machine's need
};

// `points`: the vertices of the run, two or more, neighbours may coincide. When the first and
// the last are one place, the run is closed and the curve has no seam there (unless a kept
// corner stands there). The ends are met exactly.
//
// Returns nothing when no curve inside the band was found.
[[nodiscard]] std::optional<SmoothCurve> fair_path(std::span<const Point3> points,
                                                   const FairOptions& options);

}  // namespace batten::geometry
