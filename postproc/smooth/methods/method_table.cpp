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
constexpr double kRoom = 1.03;

std::optional<double> proved_deviation(const Path& old_path, const Path& new_path,
                                       ToleranceKind kind, double tolerance) {
  const auto found = kind == ToleranceKind::kPath
                         ? geometry::compare_paths(old_path, new_path, kRoom * tolerance)
                         : geometry::compare_in_band(old_path, new_path, kRoom * tolerance).paths;
  if (found.verdict != geometry::Verdict::kProved) return std::nullopt;
  return found.bounds.at_most;
}

void widen(geometry::BesideCurve& beside, const geometry::BesideCurve& also) {
  beside.left = std::max(beside.left, also.left);
  beside.right = std::max(beside.right, also.right);
}

}  // namespace

std::vector<PolylineRow> method_rows(const PolylineCase& given, double tolerance,
                                     const TableSettings& settings) {
  if (given.points.size() < 2) throw std::invalid_argument("fewer than two points");
  geometry::require_positive_tolerance(tolerance, "method_rows");
  const std::vector<Point3> points = given.ring ? from_longest_side(given.points) : given.points;
  const Path input = geometry::path_through(points);
  std::vector<PolylineRow> rows = {{"as it is", ToleranceKind::kPath,
                                    PolylineRow::Figures{plan_feed(input, settings.limits).time,
                                                         std::nullopt, 0.0, input.size()}}};
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
      PolylineRow row{std::string(choice.name), kind, std::nullopt};
      if (const auto made = curve_of(choice.value, points, request)) {
        const Path path = pieces_of(made->path.curve);
        row.figures =
            PolylineRow::Figures{plan_feed(path, settings.limits).time, greatest_curvature_of(path),
                                 proved_deviation(input, path, kind, tolerance), path.size()};
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
  const geometry::CurvePieces pieces(curve, from, to);
  const auto along = [&](std::string method, const Path& path) {
    LinesRow row{std::move(method)};
    row.lines = path.size();
    for (const geometry::PathPiece& piece : path) row.length += geometry::length_of(piece);
    row.deviation = geometry::compare_paths(beziers, path, kRoom * tolerance).bounds.at_most;
    return row;
  };
  // `points` stand for the curve's points at `parameters`, as many.
  const auto through = [&](std::string method, std::span<const Point3> points,
                           std::span<const double> parameters) {
    LinesRow row = along(std::move(method), geometry::path_through(points));
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      if (!(parameters[i] < parameters[i + 1])) continue;
      widen(row.beside, geometry::line_beside(pieces, parameters[i], parameters[i + 1],
                                              {points[i], points[i + 1]}));
    }
    return row;
  };
  const auto with_jumps = [&](std::string method, const geometry::TangentLines& lines) {
    LinesRow row = along(std::move(method), lines.path);
    row.lines -= lines.jumps;
    row.jumps = lines.jumps;
    row.jumped = lines.jumped;
    row.beside = lines.beside;
    return row;
  };
  std::vector<LinesRow> rows;
  const auto equal = geometry::ilca(curve, from, to, {tolerance, first_step});
  rows.push_back(equal ? through("ilca", on_curve(equal->parameters), equal->parameters)
                       : LinesRow{"ilca"});
  const std::vector<double> steps = geometry::blca(curve, from, to, tolerance).parameters;
  rows.push_back(through("blca", on_curve(steps), steps));
  rows.push_back(with_jumps("blca-tangents", geometry::tangent_lines(curve, steps, 0)));
  rows.push_back(with_jumps("blca-jumps", geometry::tangent_lines(curve, steps, tolerance)));
  const std::vector<double> chords =
      geometry::chord_vertices(curve, from, to, {.max_deviation = tolerance});
  rows.push_back(through("chord", on_curve(chords), chords));
  std::vector<Point3> links;
  std::vector<double> passed;
  for (const geometry::LinkVertex& vertex : geometry::min_link_vertices(
           curve, from, to, {.tolerance = tolerance, .gates_per_link = kFineGates})) {
    links.push_back(vertex.place);
    passed.push_back(vertex.parameter);
  }
  rows.push_back(through("minlink", links, passed));
  return rows;
}

std::vector<CurveRow> tube_rows(const CurveCase& given, double radius,
                                const TableSettings& settings) {
  constexpr int kHoldCurvature = 3;
  const BsplineCurve& curve = given.curve;
  const auto row = [&](std::string method, const BsplineCurve& made, double displacement) {
    const auto samples = geometry::parameter_samples(made, geometry::kNaseathSteps);
    return CurveRow{std::move(method),
                    geometry::mean_curvature(samples),
                    geometry::max_curvature(samples),
                    geometry::sampled_length(samples),
                    s_curve_time(samples, settings.s_curve),
                    s_curve_sampled_feed(samples, settings.s_curve),
                    geometry::bends_of(samples, kSeenBend),
                    displacement};
  };
  geometry::NaseathOptions literal;
  literal.radius = radius;
  literal.repairs = geometry::NaseathRepairs::none();
  literal.held_points = given.ring ? kHoldCurvature : 0;
  geometry::NaseathOptions repaired;
  repaired.radius = radius;
  repaired.held_points = literal.held_points;
  geometry::TubeOptions tube;
  tube.radius = radius;
  tube.held_points = literal.held_points;
  tube.feed = settings.s_curve.velocity;
  tube.acceleration = settings.s_curve.acceleration;
  const auto seconds = [&](const BsplineCurve& made) { return row("", made, 0).time; };
  const auto smoothed = [&](std::string method, const geometry::NaseathOptions& options) {
    const geometry::NaseathResult result = geometry::smooth_naseath(curve, options);
    return row(std::move(method), result.curve, result.displacement);
  };
  const geometry::TubeCandidate best = geometry::best_in_tube(curve, tube, seconds).best;
  return {row("as it is", curve, 0), smoothed("naseath-literal", literal),
          smoothed("naseath", repaired), row("best in tube", best.curve, best.displacement)};
}

}  // namespace batten::postproc
