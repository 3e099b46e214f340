// The path that was meant, as smooth as the machine needs it: our own smoother.
// Method: docs/algorithms/fair.md.
#pragma once

#include <cstddef>
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
};

// `points`: the vertices of the run, two or more, neighbours may coincide. When the first and
// the last are one place, the run is closed and the curve has no seam there (unless a kept
// corner stands there). The ends are met exactly.
//
// Returns nothing when no curve inside the band was found.
[[nodiscard]] std::optional<SmoothCurve> fair_path(std::span<const Point3> points,
                                                   const FairOptions& options);

// A closed path without a seam: it is faired with some of its vertices repeated before its start
// and after its end, and one period is cut out. Method: docs/algorithms/fair.md, section Closed
// runs.

// A curve along a chain of vertices.
struct Faired {
  BsplineCurve curve;
  std::vector<double> parameters;  // of each vertex, increasing
};

// Greatest distance between the curve and the polyline, by samples, near in order.
[[nodiscard]] double deviation_of(const Faired& faired, std::span<const Point3> points,
                                  double limit);

// The vertices of a closed run (the first is the last) with `wrap` more of them on either side.
// Requires wrap < points.size().
[[nodiscard]] std::vector<Point3> wrapped(std::span<const Point3> points, std::size_t wrap);

// The `count` vertices from `wrap` on of a curve along wrapped vertices.
[[nodiscard]] Faired one_period(const Faired& all, std::size_t wrap, std::size_t count);

// The period without a seam where the tolerance allows it; with one of the size of the fit's error,
// some thousandths of a radian, where joining would leave the band; nothing where neither holds.
[[nodiscard]] std::optional<Faired> closed_at_seam(const Faired& period,
                                                   std::span<const Point3> points,
                                                   double tolerance);

}  // namespace batten::geometry
