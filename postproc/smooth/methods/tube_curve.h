// The methods that smooth a fit of a run inside a tube about it: Naseath's, and the least energies.
// Method: docs/algorithms/methods.md, docs/algorithms/band_curve.md.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "geometry/basic/point.h"
#include "geometry/fitting/fair/fair.h"
#include "geometry/fitting/tube/tube_smoothing.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/smooth/methods/curve_request.h"

namespace batten::postproc {

struct TubeTuning {
  // Of the tolerance, for the fit: enough to follow the vertices' rounding and to round corners a
  // little, since the method itself refuses corners; the tube gets the rest.
  double fit_part = 0.25;
  int passes = 300;  // repaired, the method ends by itself after 10 to 120; literally it need not
  // Control points that stay at both ends of a part: its ends, or tangents and curvatures, too.
  int hold_position = 1;
  int hold_curvature = 3;
  double density = kQuickPlanDensity;  // of the plans that times are compared by
  // About so many nodes are planned of each curve, in so many samples of it where it has more.
  double planned = 2500;
  double samples = 10;
  // Times of the fastest other form: where the first of geometry::kFewMethods is so slow, the
  // others are not tried. It is nearly as fast as the
  // best of them.
  double behind = 1.1;
  double operations = 5000;  // of the plans of all curves, about, for each of their nodes
};
inline constexpr TubeTuning kTube;

// `literal`: as the thesis has it. Nothing where no fit of the run leaves room for a tube.
[[nodiscard]] std::optional<geometry::SmoothCurve> naseath_curve(
    std::span<const geometry::Point3> run, const CurveRequest& request, bool literal);

struct TubeCurve {
  geometry::SmoothCurve path;
  geometry::TubeMethod method = geometry::TubeMethod::kOriginal;
  std::size_t visits = 0;   // geometry::FewInTube, of all parts
  std::size_t planned = 0;  // nodes of all plans
};

// Of the curves by geometry::kFewMethods, each for all parts of the fit, the one that takes the
// least time on the machine by plans from rest to rest. Those of a long run are compared by
// samples, evenly along it: the work for the plans does not grow with the run, and only the parts
// that a sample is of are solved by all methods. Linear cost.
//
// Nothing as with naseath_curve, and where the machine limits neither acceleration nor jerk; and of
// a run that is planned as a whole where it is far behind `request.rival` (s from rest to rest).
[[nodiscard]] std::optional<TubeCurve> tube_curve(std::span<const geometry::Point3> run,
                                                  const CurveRequest& request);

// About how many operations (geometry/basic/operations.h) its plans take for a run along `fair`.
[[nodiscard]] double tube_operations(const geometry::BsplineCurve& fair,
                                     const CurveRequest& request);

}  // namespace batten::postproc
