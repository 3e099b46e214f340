// Methods that leave the lines and put a curve in the place of each vertex: guo, ozcan, racing.
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/fitting/corners/blended_path.h"
#include "geometry/fitting/corners/guo_path.h"
#include "geometry/fitting/corners/ozcan_path.h"
#include "geometry/fitting/corners/time_optimal_path.h"
#include "geometry/path/joined_curve.h"
#include "postproc/smooth/methods/run_curve.h"

namespace batten::postproc {
namespace {

using geometry::NoBlend;
using geometry::Point3;
using geometry::SmoothCurve;

// Length along the polyline at each point of the run, as the stations of a blended path count it.
std::vector<double> stations_of(std::span<const Point3> run) {
  const geometry::DistinctVertices vertices = geometry::distinct_vertices(run, false);
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

// What time_optimal_corner needs to know.
bool can_race(const geometry::KinematicLimits& limits) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(limits.acceleration[axis]) && !std::isfinite(limits.jerk[axis]))
      return false;
  }
  return std::isfinite(limits.feed) && limits.feed > 0;
}

}  // namespace

std::optional<SmoothCurve> guo_curve(std::span<const Point3> run, const CurveRequest& request,
                                     bool literal) {
  geometry::GuoOptions options;
  if (literal) options = geometry::GuoOptions::literal(request.tolerance, 0);
  options.rule.tolerance = request.tolerance;
  options.rule.kind = request.kind;
  options.keep_corner_angle = request.keep_corner_angle;
  options.strict_sharper_than = geometry::kSharpestCut;
  return as_one_curve<geometry::GuoBlend>(run, geometry::guo_path(run, options), request.kind);
}

std::optional<SmoothCurve> ozcan_curve(std::span<const Point3> run, const CurveRequest& request) {
  geometry::OzcanOptions options;
  options.tolerance = request.tolerance;
  options.kind = request.kind;
  options.limits = request.limits;
  options.keep_corner_angle = request.keep_corner_angle;
  options.strict_sharper_than = geometry::kSharpestCut;
  return as_one_curve<geometry::OzcanBlend>(run, geometry::ozcan_path(run, options), request.kind);
}

std::optional<SmoothCurve> time_optimal_curve(std::span<const Point3> run,
                                              const CurveRequest& request) {
  if (!can_race(request.limits)) return std::nullopt;
  geometry::TimeOptimalPathOptions options;
  options.tolerance = request.tolerance;
  options.kind = request.kind;
  options.limits = request.limits;
  options.keep_corner_angle = request.keep_corner_angle;
  options.strict_sharper_than = geometry::kSharpestCut;
  return as_one_curve<geometry::TimeOptimalPathBlend>(
      run, geometry::time_optimal_path(run, options), request.kind);
}

}  // namespace batten::postproc
