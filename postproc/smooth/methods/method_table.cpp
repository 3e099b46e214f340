#include "postproc/smooth/methods/method_table.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>
#include <variant>

#include "geometry/chords/ilca.h"
#include "geometry/chords/linearize.h"
#include "geometry/chords/min_link.h"
#include "geometry/distance/band_comparison.h"
#include "geometry/distance/path_distance.h"
#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/fitting/naseath/naseath.h"
#include "geometry/fitting/tube/tube_smoothing.h"
#include "geometry/path/joined_curve.h"
#include "geometry/path/parameter_samples.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/options/options.h"
#include "postproc/smooth/methods/run_curve.h"

namespace batten::postproc {

using geometry::BsplineCurve;
using geometry::Path;
using geometry::Point3;
using geometry::ToleranceKind;

KinematicPathLimits TableSettings::ozcan_limits() {
  KinematicPathLimits limits{geometry::KinematicLimits{}};
  limits.tangential_acceleration = 1e4;
  limits.tangential_jerk = 1e5;
  return limits;
}

namespace {

constexpr double kRoundings = 16;  // of the coordinates, that a line may have

// Where the first point of a ring is in the middle of its longest side, every vertex is an inner
// one. The points of a ring begin and end in the same place.
std::vector<Point3> from_longest_side(const std::vector<Point3>& ring) {
  std::size_t longest = 0;
  const auto length = [&](std::size_t i) { return (ring[i + 1] - ring[i]).norm(); };
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    if (length(i) > length(longest)) longest = i;
  }
  std::vector<Point3> points = {0.5 * (ring[longest] + ring[longest + 1])};
  points.insert(points.end(), ring.begin() + static_cast<std::ptrdiff_t>(longest) + 1, ring.end());
  points.insert(points.end(), ring.begin() + 1,
                ring.begin() + static_cast<std::ptrdiff_t>(longest) + 1);
  points.push_back(points.front());
  return points;
}

// The pieces of a curve, lines as lines: a line of a millionth of a millimetre, as they are left
// between two blends, has a curvature of rounding alone where it is a cubic.
Path pieces_of(const BsplineCurve& curve) {
  Path path = geometry::beziers_of(curve);
  for (geometry::PathPiece& piece : path) {
    const auto& p = std::get<geometry::CubicBezier>(piece).control;
    const geometry::Vector3 along = (p[3] - p[0]).normalized();
    const double rounding =
        kRoundings * std::numeric_limits<double>::epsilon() * (1 + p[0].cwiseAbs().maxCoeff());
    const auto is_on_line = [&](const Point3& q) {
      const geometry::Vector3 from = q - p[0];
      return (from - from.dot(along) * along).norm() <= rounding;
    };
    if (is_on_line(p[1]) && is_on_line(p[2])) piece = geometry::Line{p[0], p[3]};
  }
  return path;
}

// 1/mm, looked at in some points of each piece.
double greatest_curvature_of(const Path& path) {
  constexpr int kParts = 16;
  double greatest = 0;
  for (const geometry::PathPiece& piece : path) {
    if (std::holds_alternative<geometry::Line>(piece)) continue;
    for (int i = 0; i <= kParts; ++i) {
      const double t = static_cast<double>(i) / kParts;
      greatest = std::max(greatest, derivatives_by_length(piece, t).second.norm());
    }
  }
  return greatest;
}

// Some methods use the tolerance up to its last digit, and the proof needs room.
std::optional<double> proved_deviation(const Path& old_path, const Path& new_path,
                                       ToleranceKind kind, double tolerance) {
  constexpr double kRoom = 1.03;
  const auto found = kind == ToleranceKind::kPath
                         ? geometry::compare_paths(old_path, new_path, kRoom * tolerance)
                         : geometry::compare_in_band(old_path, new_path, kRoom * tolerance).paths;
  if (found.verdict != geometry::Verdict::kProved) return std::nullopt;
  return found.bounds.at_most;
}

}  // namespace

std::vector<PolylineRow> method_rows(const PolylineCase& given, double tolerance,
                                     const TableSettings& settings) {
  if (given.points.size() < 2) throw std::invalid_argument("fewer than two points");
  geometry::require_positive_tolerance(tolerance, "method_rows");
  const Path input = geometry::path_through(given.points);
  std::vector<PolylineRow> rows = {{"as it is", ToleranceKind::kPath,
                                    PolylineRow::Figures{plan_feed(input, settings.limits).time,
                                                         std::nullopt, 0.0, input.size()}}};
  const std::vector<Point3> turned =
      given.ring ? from_longest_side(given.points) : std::vector<Point3>();
  for (const ToleranceKind kind : {ToleranceKind::kPath, ToleranceKind::kBand}) {
    for (const auto& choice : methods()) {
      if (choice.value == Method::kBest || choice.value == Method::kNone) continue;
      // The others, and those literal ones, give the same curve in both readings.
      const bool differs = choice.value == Method::kGuo || choice.value == Method::kOzcan ||
                           choice.value == Method::kOzcanUsual ||
                           choice.value == Method::kTimeOptimal;
      if (kind == ToleranceKind::kBand && !differs) continue;
      CurveRequest request;
      request.tolerance = tolerance;
      request.kind = kind;
      request.guo_lambda = settings.guo_lambda;
      request.limits = {settings.limits.feed, settings.limits.speed, settings.limits.acceleration,
                        settings.limits.jerk};
      const bool turn = given.ring && is_of_corners(choice.value);
      const std::vector<Point3>& points = turn ? turned : given.points;
      PolylineRow row{std::string(choice.name), kind, std::nullopt};
      if (const auto made = curve_of(choice.value, points, request)) {
        const Path path = pieces_of(made->path.curve);
        row.figures = PolylineRow::Figures{
            plan_feed(path, settings.limits).time, greatest_curvature_of(path),
            proved_deviation(turn ? geometry::path_through(points) : input, path, kind, tolerance),
            path.size()};
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::vector<LinesRow> line_rows(const BsplineCurve& curve, double tolerance, double first_step) {
  // The least number of links is found where they are held against the curve this often.
  constexpr int kFineGates = 96;
  geometry::require_positive_tolerance(tolerance, "line_rows");
  const double from = curve.first();
  const double to = curve.last();
  const Path beziers = geometry::beziers_of(curve);
  const auto on_curve = [&](std::span<const double> parameters) {
    std::vector<Point3> points;
    points.reserve(parameters.size());
    for (const double u : parameters) points.push_back(curve.point_at(u));
    return points;
  };
  const auto row = [&](std::string method, std::span<const Point3> points) {
    const Path lines = geometry::path_through(points);
    double length = 0;
    for (const geometry::PathPiece& line : lines) length += geometry::length_of(line);
    constexpr double kRoom = 1.03;
    const auto found = geometry::compare_paths(beziers, lines, kRoom * tolerance);
    return LinesRow{std::move(method), lines.size(), length, found.bounds.at_most};
  };
  std::vector<LinesRow> rows;
  const auto equal = geometry::ilca(curve, from, to, {tolerance, first_step});
  rows.push_back(equal ? row("ilca", on_curve(equal->parameters)) : LinesRow{"ilca"});
  rows.push_back(row("blca", on_curve(geometry::blca(curve, from, to, tolerance).parameters)));
  rows.push_back(row(
      "chord", on_curve(geometry::chord_vertices(curve, from, to, {.max_deviation = tolerance}))));
  std::vector<Point3> links;
  for (const geometry::LinkVertex& vertex : geometry::min_link_vertices(
           curve, from, to, {.tolerance = tolerance, .gates_per_link = kFineGates})) {
    links.push_back(vertex.place);
  }
  rows.push_back(row("minlink", links));
  return rows;
}

std::vector<CurveRow> tube_rows(const BsplineCurve& curve, double radius,
                                const TableSettings& settings) {
  const auto row = [&](std::string method, const BsplineCurve& made) {
    const auto samples = geometry::parameter_samples(made, geometry::kNaseathSteps);
    return CurveRow{std::move(method), geometry::mean_curvature(samples),
                    geometry::max_curvature(samples), geometry::sampled_length(samples),
                    s_curve_time(samples, settings.s_curve)};
  };
  geometry::NaseathOptions literal;
  literal.radius = radius;
  literal.repairs = geometry::NaseathRepairs::none();
  geometry::NaseathOptions repaired;
  repaired.radius = radius;
  geometry::TubeOptions tube;
  tube.radius = radius;
  tube.feed = settings.s_curve.velocity;
  tube.acceleration = settings.s_curve.acceleration;
  const auto seconds = [&](const BsplineCurve& made) { return row("", made).time; };
  return {row("as it is", curve),
          row("naseath-literal", geometry::smooth_naseath(curve, literal).curve),
          row("naseath", geometry::smooth_naseath(curve, repaired).curve),
          row("best in tube", geometry::best_in_tube(curve, tube, seconds).best.curve)};
}

}  // namespace batten::postproc
