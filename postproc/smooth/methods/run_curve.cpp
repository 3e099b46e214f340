#include "postproc/smooth/methods/run_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/fitting/corners/guo_corner.h"
#include "geometry/fitting/corners/ozcan_corner.h"
#include "geometry/fitting/corners/time_optimal_corner.h"
#include "geometry/fitting/fair/fair_measure.h"
#include "geometry/fitting/fair/inner_path.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/joined_curve.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/smooth/methods/tube_curve.h"

namespace batten::postproc {

using geometry::Point3;
using geometry::SmoothCurve;
using geometry::Vector3;

namespace {

using geometry::BsplineCurve;
using geometry::NoBlend;

// --- methods that leave the lines and put a curve about each vertex: guo, ozcan, racing
// -----------

// Length along the polyline at each point of the run, as the stations of a blended path count it.
std::vector<double> stations_of(std::span<const Point3> run) {
  const geometry::DistinctVertices vertices = geometry::distinct_vertices(run);
  std::vector<double> stations;
  stations.reserve(run.size());
  double station = 0;
  std::size_t vertex = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (vertex + 1 < vertices.size() && vertices.indices[vertex + 1] == i) {
      ++vertex;
      station += (vertices.points[vertex] - vertices.points[vertex - 1]).norm();
    }
    stations.push_back(station);
  }
  return stations;
}

// `Path`: GuoPath, OzcanPath or TimeOptimalPath, `Blend` what their corners may hold.
template <typename Blend, typename Path>
std::optional<SmoothCurve> as_one_curve(std::span<const Point3> run, const Path& path,
                                        geometry::ToleranceKind kind) {
  if (path.pieces.empty()) return std::nullopt;
  SmoothCurve result{
      geometry::curve_of_pieces(path.pieces, path.stations), stations_of(run), 0, 0, 0, 0};
  result.vertex_parameters.back() = result.curve.last();
  if (path.seam) {
    result.deviation = geometry::deviation_of(path.seam->deviation, kind);
    result.rounds_seam = true;
  }
  for (const auto& corner : path.corners) {
    if (const auto* blend = std::get_if<Blend>(&corner.outcome)) {
      result.deviation =
          std::max(result.deviation, geometry::deviation_of(blend->blend.deviation, kind));
    } else if (std::get<NoBlend>(corner.outcome) != NoBlend::kStraight) {
      ++result.kept_corners;
    }
  }
  return result;
}

template <typename Options>
Options corner_options(const CurveRequest& request, Options options = {}) {
  options.tolerance = request.tolerance;
  options.kind = request.kind;
  options.keep_corner_angle = request.keep_corner_angle;
  options.strict_sharper_than = geometry::kSharpestCut;
  options.seam = request.seam;
  return options;
}

std::optional<SmoothCurve> guo_curve(std::span<const Point3> run, const CurveRequest& request,
                                     bool literal) {
  const auto options = corner_options(
      request, literal ? geometry::GuoOptions::literal(request.tolerance, request.guo_lambda)
                       : geometry::GuoOptions{});
  return as_one_curve<geometry::GuoBlend>(run, geometry::guo_path(run, options), request.kind);
}

std::optional<SmoothCurve> ozcan_curve(std::span<const Point3> run, const CurveRequest& request,
                                       bool searched) {
  auto options = corner_options<geometry::OzcanOptions>(request);
  constexpr double kNoTurn = 4;  // radians, more than any
  if (!searched) options.least_searched_turn = kNoTurn;
  options.limits = request.limits;
  return as_one_curve<geometry::OzcanBlend>(run, geometry::ozcan_path(run, options), request.kind);
}

std::optional<SmoothCurve> time_optimal_curve(std::span<const Point3> run,
                                              const CurveRequest& request) {
  if (!can_race(request.limits)) return std::nullopt;
  auto options = corner_options<geometry::TimeOptimalPathOptions>(request);
  options.limits = request.limits;
  return as_one_curve<geometry::TimeOptimalPathBlend>(
      run, geometry::time_optimal_path(run, options), request.kind);
}

// The parameter between `from` and `to`, of a straight span that leads away from a point, where the
// curve is so far (mm) from it.
double parameter_at(const BsplineCurve& curve, double from, double to, const Point3& point,
                    double distance) {
  constexpr int kHalvings = 60;  // all of a double
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (from + to);
    const bool is_before = (curve.point_at(middle) - point).norm() < distance;
    (is_before ? from : to) = middle;
  }
  return 0.5 * (from + to);
}

// The same curve over other parameters, from `first` to `last`.
BsplineCurve over(const BsplineCurve& curve, double first, double last) {
  std::vector<double> knots = curve.basis().knots();
  const double scale = (last - first) / (curve.last() - curve.first());
  const auto from = curve.first();
  const auto to = curve.last();
  for (double& knot : knots) {
    knot = knot <= from ? first : knot >= to ? last : first + scale * (knot - from);
  }
  return {geometry::BsplineBasis(curve.degree(), std::move(knots)), curve.control_points()};
}

// Rounds the corner where a closed curve begins and ends, in the room that the straight spans
// beside it leave. Where there is none, or that corner is to stay, the curve stays as it is.
void round_seam(SmoothCurve& path, const CurveRequest& request) {
  const BsplineCurve& curve = path.curve;
  const Point3 begin = curve.point_at(curve.first());
  if ((curve.point_at(curve.last()) - begin).norm() > geometry::kSamePlace) return;
  const auto lines = geometry::CurvePieces(curve, curve.first(), curve.last()).straight_runs();
  if (lines.size() < 2 || lines.front().from > curve.first() || lines.back().to < curve.last()) {
    return;
  }
  const Point3 after = curve.point_at(lines.front().to);
  const Point3 before = curve.point_at(lines.back().from);
  auto options = corner_options<geometry::CornerPathOptions>(request);
  options.keep_corner_angle = std::min(request.keep_corner_angle, request.keep_found_corner);
  auto seam = geometry::shared_seam(std::vector<Point3>{begin, after, before, begin}, options);
  if (!seam) return;
  // No corner's blend reaches into the straight spans.
  seam->share_before = (begin - before).norm();
  seam->share_after = (after - begin).norm();
  const auto blend = geometry::seam_blend(*seam, options.tolerance);
  if (!blend) return;
  const BsplineCurve& round = blend->curve;
  const double middle = 0.5 * (round.first() + round.last());
  const double reach = (round.point_at(round.last()) - begin).norm();
  const double from = parameter_at(curve, curve.first(), lines.front().to, begin, reach);
  const double to = parameter_at(curve, curve.last(), lines.back().from, begin, reach);
  if (!(from < to)) return;
  const BsplineCurve parts[] = {over(round.part(middle, round.last()), curve.first(), from),
                                curve.part(from, to),
                                over(round.part(round.first(), middle), to, curve.last())};
  const double deviation = geometry::deviation_of(blend->deviation, seam->kind);
  path.curve = geometry::joined(parts);
  path.deviation = std::max(path.deviation, deviation);
  path.rounds_seam = true;
  if (path.edge_deviations.empty()) return;
  for (double* edge : {&path.edge_deviations.front(), &path.edge_deviations.back()}) {
    *edge = std::max(*edge, deviation);
  }
}

}  // namespace

std::optional<RunCurve> curve_of(Method method, std::span<const Point3> run,
                                 const CurveRequest& request) {
  if (request.side != geometry::Side::kBoth && method != Method::kFair) return std::nullopt;
  auto found = [&]() -> std::optional<SmoothCurve> {
    switch (method) {
      case Method::kFair:
        return fair_curve(run, request);
      case Method::kTimeOptimal:
        return time_optimal_curve(run, request);
      case Method::kTube: {
        auto tube = tube_curve(run, request);
        if (!tube) return std::nullopt;
        return std::move(tube->path);
      }
      case Method::kNaseath:
        return naseath_curve(run, request, false);
      case Method::kNaseathLiteral:
        return naseath_curve(run, request, true);
      case Method::kGuo:
        return guo_curve(run, request, false);
      case Method::kGuoLiteral:
        return guo_curve(run, request, true);
      case Method::kOzcan:
        return ozcan_curve(run, request, true);
      case Method::kOzcanUsual:
        return ozcan_curve(run, request, false);
      case Method::kBest:
      case Method::kNone:
        break;
    }
    throw std::invalid_argument("curve_of: method " + std::string(name_of(method)) +
                                ", expected one that makes a curve");
  }();
  if (!found) return std::nullopt;
  // The methods of corners share the sides of a ring between its seam and the other corners.
  if (request.seam == geometry::Seam::kSmooth && !is_of_corners(method)) {
    round_seam(*found, request);
  }
  return RunCurve{method, *std::move(found)};
}

std::optional<RunCurve> inside_curve(const RunCurve& meant, std::span<const Point3> run,
                                     CurveRequest request) {
  const double whole = request.tolerance;
  // A third of the height of chords, which are no higher than the tolerance beside such a curve.
  const std::vector<Point3> moved = geometry::drawn_inwards(run, meant.path, whole / 3);
  double most = 0;
  for (std::size_t i = 0; i < run.size(); ++i) most = std::max(most, (moved[i] - run[i]).norm());
  request.tolerance -= most;
  auto path = fair_curve(moved, request);
  if (!path) return std::nullopt;
  path->edge_deviations.clear();
  path->deviation =
      geometry::greatest_deviation(path->curve, {run, path->vertex_parameters}, whole);
  return RunCurve{Method::kFair, *std::move(path)};
}

double straight_time(const BsplineCurve& curve, const CurveRequest& request) {
  const double length = geometry::length_of(curve);
  const geometry::Path line = {geometry::Line{Point3::Zero(), Point3(length, 0, 0)}};
  return plan_feed(line, plan_limits(request)).time;
}

double greatest_curvature(std::span<const Point3> p) {
  double most = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Vector3 a = p[i] - p[i - 1];
    const Vector3 b = p[i + 1] - p[i];
    const double sides = a.norm() * b.norm() * (p[i + 1] - p[i - 1]).norm();
    if (sides > 0) most = std::max(most, 2 * a.cross(b).norm() / sides);
  }
  return most;
}

CurvatureProfile::CurvatureProfile(const geometry::BsplineCurve& curve) {
  constexpr int kParts = 8;
  geometry::SplineWalk walk(curve.basis().knots(), curve.control_points());
  const std::vector<double> knots = curve.breakpoints();
  steps_.reserve(kParts / 2 * knots.size());
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const double span = knots[i + 1] - knots[i];
    for (int k = 0; k < kParts; ++k) {
      const double curvature = walk.curvature_at(knots[i] + span * k / kParts);
      greatest_ = std::max(greatest_, curvature);
      // The odd ones are in the middle of a quarter. The parameter is about the length.
      if (k % 2 == 1) steps_.push_back({2 * span / kParts, std::sqrt(curvature)});
    }
  }
  greatest_ = std::max(greatest_, walk.curvature_at(curve.last()));
}

double CurvatureProfile::chords(double deviation, double min_length) const {
  const double per_bend = 1 / std::sqrt(8 * deviation);
  double chords = 0;
  for (const Step& step : steps_) {
    const double per_mm = per_bend * step.bend;
    chords += step.length * (per_mm * min_length > 1 ? std::sqrt(0.5) * per_mm : per_mm);
  }
  return chords;
}

}  // namespace batten::postproc
