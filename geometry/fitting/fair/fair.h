// The path that was meant, as smooth as the machine needs it: our own smoother.
// Method: docs/algorithms/fair.md.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/fair/fair_problem.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

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
  // The same of each edge, from each input point to the next; or none where it is not known.
  std::vector<double> edge_deviations = {};
  // Whether it rounds the corner of the polyline in which both of them begin and end (Seam).
  bool rounds_seam = false;
};

// `points`: the vertices of the run, two or more, neighbours may coincide. When the first and
// the last are one point, the run is closed and the curve has no seam there (unless there is a kept
// corner). The ends are met exactly.
//
// Returns nothing when no curve inside the band was found.
[[nodiscard]] std::optional<SmoothCurve> fair_path(std::span<const Point3> points,
                                                   const FairOptions& options);

}  // namespace batten::geometry
