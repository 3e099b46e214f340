#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "geometry/arcs/arc_fit.h"
#include "geometry/basic/rounding.h"
#include "geometry/fitting/fair/fair_measure.h"
#include "geometry/path/plane_curve.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/arc_moves.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {
namespace {

using gcode::PlaneAxes;
using geometry::BsplineCurve;
using geometry::Path;
using geometry::PathPiece;
using geometry::Point3;
using geometry::Vector3;

// The curve laid flat into the plane, when it lies in it to within half a printed step and its
// ends do so exactly.
std::optional<BsplineCurve> laid_flat(const Run& run, const BsplineCurve& curve, int normal,
                                      double step) {
  const double height = run.points.front()[normal];
  if (std::abs(run.points.back()[normal] - height) > geometry::kSamePlace) return std::nullopt;
  std::vector<Point3> points = curve.control_points();
  for (Point3& point : points) {
    if (std::abs(point[normal] - height) > step / 2) return std::nullopt;
    point[normal] = height;
  }
  return BsplineCurve(curve.basis(), std::move(points));
}

geometry::ArcFitOptions fit_options(const PlanOptions& options, const PlaneAxes& plane,
                                    bool helical) {
  geometry::ArcFitOptions fit;
  fit.max_deviation = arc_deviation(options);
  fit.outside = (1 - kPlans.arc_chords) * options.outside;
  fit.axis = Vector3::Unit(plane.normal);
  fit.helical = helical;
  fit.min_radius = options.target->min_radius;
  fit.max_radius = options.target->max_radius;
  fit.grid = arc_grid(options);
  fit.effort = options.arc_effort;
  return fit;
}

// Seen along the axis of the arcs, at some places of each edge.
std::vector<BesideCurve> beside_curve(const Run& run, const geometry::SmoothCurve& fair,
                                      const Vector3& axis) {
  constexpr int kParts = 4;
  const auto& at = fair.vertex_parameters;
  std::vector<BesideCurve> all(run.points.size() - 1);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (int k = 0; k <= kParts; ++k) {
      const double part = static_cast<double>(k) / kParts;
      const double u = at[i] + part * (at[i + 1] - at[i]);
      const Point3 place = run.points[i] + part * (run.points[i + 1] - run.points[i]);
      const Vector3 left = axis.cross(fair.curve.derivative_at(u, 1));
      const double size = left.norm();
      if (!(size > 0)) continue;  // along the axis
      const double off = (place - fair.curve.point_at(u)).dot(left) / size;
      all[i].left = std::max(all[i].left, off);
      all[i].right = std::max(all[i].right, -off);
    }
  }
  return all;
}

// Of arcs along the curve.
geometry::ArcRunning running_along(const Run& run, const geometry::SmoothCurve& fair,
                                   const Vector3& axis, const PlanOptions& options) {
  if (!takes_chords_off(options)) return {};
  FollowedPath path{fair.vertex_parameters, std::vector<std::size_t>(run.points.size()),
                    beside_curve(run, fair, axis), RunChords(run, options.target->chords),
                    options.tolerance};
  std::iota(path.vertices.begin(), path.vertices.end(), 0);
  return running_of(options, std::move(path));
}

// `whole`: all of the curve in its pieces, where these are known, and about how many chords it
// takes.
std::optional<OutputPlan> plan_in(const Run& run, const geometry::SmoothCurve& fair,
                                  const BsplineCurve& curve, const geometry::MarkedPieces* whole,
                                  double chords, const geometry::ArcFitOptions& fit,
                                  const PlanOptions& options) {
  OutputPlan plan;
  plan.form = Form::kArcs;
  for (const FeedSection& section : feed_sections(run, fair)) {
    const bool all = section.from == curve.first() && section.to == curve.last();
    const std::optional<Path> arcs = all && whole != nullptr
                                         ? geometry::fit_arcs(*whole, chords, fit)
                                         : geometry::fit_arcs(curve, section.from, section.to, fit);
    if (!arcs) return std::nullopt;
    Path taken;
    for (const PathPiece& piece : *arcs) {
      append_taken(piece, kPlans.arc_chords * options.max_deviation, options, taken);
    }
    // The parameter goes about with the length: each end is found from the one before it.
    geometry::SplineWalk walk(curve.basis().knots(), curve.control_points());
    double start = section.from;
    for (const PathPiece& piece : taken) {
      plan.moves.push_back({piece, section.feed, {}, start});
      const Point3 end = geometry::end_point(piece);
      double next = start + geometry::length_of(piece);
      for (int i = 0; i < kPlans.newton_steps; ++i) next = walk.nearer(next, end);
      start = std::clamp(next, start, section.to);
    }
  }
  put_own_chords(run, fair, options, plan);
  place_comments(run, fair, plan);
  return plan;
}

// By how far the run reaches across the plane.
std::vector<PlaneAxes> flattest_first(const Run& run, std::vector<PlaneAxes> planes) {
  const auto reach = [&](const PlaneAxes& plane) {
    const auto [low, high] = std::ranges::minmax(
        run.points, {}, [&](const Point3& point) { return point[plane.normal]; });
    return high[plane.normal] - low[plane.normal];
  };
  std::ranges::stable_sort(planes, {}, reach);
  return planes;
}

constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max() / 2;

std::size_t most_pieces(const PlanOptions& options) {
  return std::min(options.most_arcs, kAnyNumber);
}

bool has_helix(const OutputPlan& plan) {
  return std::ranges::any_of(plan.moves, [](const auto& move) {
    const auto* arc = std::get_if<geometry::Arc>(&move.piece);
    return arc != nullptr && std::abs((arc->end - arc->start).dot(arc->axis)) > 0;
  });
}

}  // namespace

std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::SmoothCurve& fair,
                                    const geometry::MarkedPieces& pieces,
                                    const CurvatureProfile& bends, const PlanOptions& options) {
  const std::vector<PlaneAxes> planes = arc_planes(options);
  bool flat_somewhere = false;
  for (const PlaneAxes& plane : planes) {
    const auto flat = laid_flat(run, fair.curve, plane.normal, arc_grid(options));
    if (!flat) continue;
    flat_somewhere = true;
    geometry::ArcFitOptions fit = fit_options(options, plane, false);
    fit.running = running_along(run, fair, fit.axis, options);
    fit.at_most = most_pieces(options);
    if (auto plan = plan_in(run, fair, *flat, nullptr, 0, fit, options)) return plan;
  }
  if (flat_somewhere) return std::nullopt;
  // In space the planes differ much: the rows of a raster along X are arcs in G18, and in G17 they
  // are lines and steep little helices. The fewest moves win; the plane in which the run is
  // flattest comes first, so that the others are soon given up. More moves than the run has motions
  // are chords in all but name, and plan_lines does those better.
  const double chords = bends.chords(arc_deviation(options), 0);
  std::optional<OutputPlan> best;
  std::size_t most = std::min(motion_count(run), std::min(options.most_arcs, kAnyNumber) + 1);
  for (const PlaneAxes& plane : flattest_first(run, planes)) {
    geometry::ArcFitOptions fit = fit_options(options, plane, true);
    fit.running = running_along(run, fair, fit.axis, options);
    fit.at_most = most;
    auto plan = plan_in(run, fair, fair.curve, &pieces, chords, fit, options);
    if (!plan || plan->moves.size() >= most) continue;
    if (!options.target->helices && has_helix(*plan)) continue;  // a plunge may be all that rises
    most = plan->moves.size();
    best = std::move(plan);
  }
  return best;
}

double arcs_expected(const Run& run, const geometry::ArcCount& count, const PlanOptions& options) {
  const std::vector<PlaneAxes> planes = arc_planes(options);
  const bool flat = std::ranges::any_of(
      planes, [&](const PlaneAxes& plane) { return lies_across(run, plane.normal); });
  double fewest = std::numeric_limits<double>::infinity();
  for (const PlaneAxes& plane : planes) {
    if (flat && !lies_across(run, plane.normal)) continue;
    fewest =
        std::min(fewest, count.within(arc_deviation(options), arc_grid(options), plane.normal));
  }
  return fewest;
}

}  // namespace batten::postproc
