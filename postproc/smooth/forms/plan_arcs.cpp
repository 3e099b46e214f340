#include <algorithm>
#include <cmath>
#include <utility>

#include "gcode/state/plane_axes.h"
#include "geometry/arcs/arc_fit.h"
#include "geometry/basic/rounding.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/arc_moves.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/forms/piece_plans.h"
#include "postproc/smooth/forms/plan_stretches.h"

namespace batten::postproc {
namespace {

using gcode::PlaneAxes;
using geometry::BsplineCurve;
using geometry::Path;
using geometry::PathPiece;

// The part of the deviation that is kept for chords in place of arcs that the target refuses:
// too tight, too short. There are few of them.
constexpr double kPartForArcChords = 0.1;

// With Prefer::kAccuracy arcs are this much nearer to the curve. An arc's deviation falls with
// the third power of its length, so it costs little more than twice the arcs.
constexpr double kAccuratePart = 0.1;

// The curve laid flat into the plane, when it lies in it to within half a printed step and its
// ends do so exactly.
std::optional<BsplineCurve> laid_flat(const Run& run, const BsplineCurve& curve, int normal,
                                      double step) {
  const double height = run.points.front()[normal];
  if (std::abs(run.points.back()[normal] - height) > geometry::kSamePlace) return std::nullopt;
  std::vector<geometry::Point3> points = curve.control_points();
  for (geometry::Point3& point : points) {
    if (std::abs(point[normal] - height) > step / 2) return std::nullopt;
    point[normal] = height;
  }
  return BsplineCurve(curve.basis(), std::move(points));
}

double fit_deviation(const PlanOptions& options) {
  const double limit = options.max_deviation;
  if (options.prefer != Prefer::kAccuracy) return limit * (1 - kPartForArcChords);
  const double worth_it = arc_grid(options);  // finer than that is lost in print
  return std::min(std::max(kAccuratePart * limit, worth_it), limit * (1 - kPartForArcChords));
}

geometry::ArcFitOptions fit_options(const PlanOptions& options, const PlaneAxes& plane,
                                    bool helical) {
  geometry::ArcFitOptions fit;
  fit.max_deviation = fit_deviation(options);
  fit.axis = geometry::Vector3::Unit(plane.normal);
  fit.helical = helical;
  fit.min_radius = options.target->min_arc_radius();
  fit.max_radius = options.target->max_arc_radius();
  fit.grid = arc_grid(options);
  fit.effort = options.arc_effort;
  return fit;
}

// Adds the pieces of one stretch to the plan, and the parameters at which they start to `starts`:
// the curve's parameter goes about with the length along it.
void append_stretch(const Path& path, const FeedStretch& stretch, OutputPlan& plan,
                    std::vector<double>& starts) {
  const double length = geometry::length_of(path);
  double done = 0;
  for (const PathPiece& piece : path) {
    const double part = length > 0 ? done / length : 0;
    starts.push_back(stretch.from + (stretch.to - stretch.from) * part);
    plan.moves.push_back({piece, stretch.feed, {}});
    done += geometry::length_of(piece);
  }
}

// The run's curve in its pieces, and about how many chords it takes.
struct WholeCurve {
  const geometry::MarkedPieces& pieces;
  double chords;
};

// `whole`: of that curve, or none.
std::optional<OutputPlan> plan_in(const Run& run, const geometry::SmoothCurve& fair,
                                  const BsplineCurve& curve, const WholeCurve* whole,
                                  const geometry::ArcFitOptions& fit, const PlanOptions& options) {
  OutputPlan plan;
  plan.form = OutputForm::kArcs;
  std::vector<double> starts;
  for (const FeedStretch& stretch : feed_stretches(run, fair)) {
    const bool all = stretch.from == curve.first() && stretch.to == curve.last();
    const std::optional<Path> arcs = all && whole != nullptr
                                         ? geometry::fit_arcs(whole->pieces, whole->chords, fit)
                                         : geometry::fit_arcs(curve, stretch.from, stretch.to, fit);
    if (!arcs) return std::nullopt;
    Path taken;
    for (const PathPiece& piece : *arcs) {
      append_taken(piece, kPartForArcChords * options.max_deviation, options, taken);
    }
    append_stretch(taken, stretch, plan, starts);
  }
  place_comments(run, fair, starts, plan);
  return plan;
}

// By how far the run reaches across the plane.
std::vector<PlaneAxes> flattest_first(const Run& run, std::vector<PlaneAxes> planes) {
  geometry::Point3 low = run.points.front();
  geometry::Point3 high = low;
  for (const geometry::Point3& point : run.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  std::ranges::stable_sort(
      planes, {}, [&](const PlaneAxes& plane) { return high[plane.normal] - low[plane.normal]; });
  return planes;
}

}  // namespace

std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::SmoothCurve& fair,
                                    const PlanOptions& options) {
  return plan_arcs(run, fair, {fair.curve, fair.curve.first(), fair.curve.last()},
                   CurvatureProfile(fair.curve), options);
}

std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::SmoothCurve& fair,
                                    const geometry::MarkedPieces& pieces,
                                    const CurvatureProfile& bends, const PlanOptions& options) {
  const std::vector<PlaneAxes> planes = arc_planes(options);
  bool flat_somewhere = false;
  for (const PlaneAxes& plane : planes) {
    const auto flat = laid_flat(run, fair.curve, plane.normal, arc_grid(options));
    if (!flat) continue;
    flat_somewhere = true;
    auto plan = plan_in(run, fair, *flat, nullptr, fit_options(options, plane, false), options);
    if (plan) return plan;
  }
  if (flat_somewhere || !options.target->takes_helices()) return std::nullopt;
  // In space the planes differ much: the rows of a raster along X are arcs in G18, and in G17 they
  // are lines and steep little helices. The fewest moves win; the plane in which the run is
  // flattest comes first, so that the others are soon given up. More moves than the run has motions
  // are chords in all but name, and plan_lines does those better.
  const WholeCurve whole{pieces, bends.chords(fit_deviation(options), 0)};
  std::optional<OutputPlan> best;
  std::size_t most = motion_count(run);
  for (const PlaneAxes& plane : flattest_first(run, planes)) {
    geometry::ArcFitOptions fit = fit_options(options, plane, true);
    fit.at_most = most;
    auto plan = plan_in(run, fair, fair.curve, &whole, fit, options);
    if (!plan || plan->moves.size() >= most) continue;
    most = plan->moves.size();
    best = std::move(plan);
  }
  return best;
}

}  // namespace batten::postproc
