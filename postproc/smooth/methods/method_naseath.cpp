// Naseath's tube about a spline, for a run of lines.
#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/naseath/naseath.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/joined_curve.h"
#include "postproc/smooth/methods/run_curve.h"

namespace batten::postproc {
namespace {

using geometry::BsplineCurve;
using geometry::Point3;
using geometry::SmoothCurve;

// The fit may use this part of the tolerance: enough to follow the vertices' rounding and to
// round corners a little, since the method itself refuses corners; the tube gets the rest.
constexpr double kFitPart = 0.25;

// Passes over a part. Repaired, the method ends by itself after 10 to 120; literally it need not.
constexpr int kPasses = 300;

// Control points that stay at both ends of a part: 1 its ends, 3 tangents and curvatures too.
constexpr int kHoldPlace = 1;
constexpr int kHoldCurvature = 3;

// A part of the fit between two cuts.
struct NaseathStretch {
  double from;
  double to;
  bool straight;        // a line of the program: it stays
  bool meets_smoothly;  // its neighbours go on with its tangent and curvature
};

// Inner knots at which the curve may have a corner.
std::vector<double> corners_of(const BsplineCurve& curve) {
  std::vector<double> corners;
  const auto& t = curve.basis().knots();
  for (std::size_t i = 4; i + 5 < t.size(); ++i) {
    const bool known = !corners.empty() && corners.back() == t[i];
    if (t[i] == t[i + 1] && !known && t[i] > curve.first() && t[i] < curve.last()) {
      corners.push_back(t[i]);
    }
  }
  return corners;
}

std::vector<NaseathStretch> stretches_of(const BsplineCurve& curve, bool closed) {
  const auto lines = geometry::CurvePieces(curve, curve.first(), curve.last()).straight_runs();
  const std::vector<double> corners = corners_of(curve);
  std::vector<double> cuts = {curve.first(), curve.last()};
  cuts.insert(cuts.end(), corners.begin(), corners.end());
  for (const geometry::StraightRun& line : lines) {
    cuts.push_back(line.from);
    cuts.push_back(line.to);
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  const auto is_smooth = [&](double u) {
    if (u == curve.first() || u == curve.last()) return closed;
    return !std::binary_search(corners.begin(), corners.end(), u);
  };
  std::vector<NaseathStretch> stretches;
  std::size_t line = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    while (line < lines.size() && lines[line].to <= cuts[i]) ++line;
    const bool straight = line < lines.size() && lines[line].from <= cuts[i];
    stretches.push_back(
        {cuts[i], cuts[i + 1], straight, is_smooth(cuts[i]) || is_smooth(cuts[i + 1])});
  }
  return stretches;
}

}  // namespace

std::optional<SmoothCurve> naseath_curve(std::span<const Point3> run, const CurveRequest& request,
                                         bool literal) {
  CurveRequest fit = request;
  fit.tolerance = kFitPart * request.tolerance;
  fit.scatter = 0;
  fit.accurate = true;
  std::optional<SmoothCurve> path = fair_curve(run, fit);
  if (!path || !(path->deviation < request.tolerance)) return std::nullopt;

  geometry::NaseathOptions options;
  options.radius = request.tolerance - path->deviation;
  options.max_passes = kPasses;
  if (literal) options.repairs = geometry::NaseathRepairs::none();
  const bool closed = (run.front() - run.back()).norm() <= geometry::kSamePlace;
  double moved = 0;
  std::vector<BsplineCurve> parts;
  for (const NaseathStretch& stretch : stretches_of(path->curve, closed)) {
    BsplineCurve part = path->curve.part(stretch.from, stretch.to);
    if (!stretch.straight) {
      options.held_points = stretch.meets_smoothly ? kHoldCurvature : kHoldPlace;
      geometry::NaseathResult smoothed = geometry::smooth_naseath(part, options);
      moved = std::max(moved, smoothed.displacement);
      part = std::move(smoothed.curve);
    }
    parts.push_back(std::move(part));
  }
  path->curve = geometry::joined(parts);
  path->deviation += moved;
  path->noise = 0;
  path->rounds = 0;
  return path;
}

}  // namespace batten::postproc
