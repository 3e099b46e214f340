#include "geometry/fitting/fair/fair.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/fair/fair_band.h"
#include "geometry/fitting/fair/fair_closed.h"

namespace batten::geometry {

namespace {

// Vertices of a closed run that are added before its start and after its end: the influence of
// a vertex on the curve dies out over some ten vertices.
constexpr std::size_t kWrap = 200;

// The run without repeated places.
struct Vertices {
  std::vector<Point3> points;
  std::vector<std::size_t> of_input;  // index into points, per input point
};

Vertices distinct(std::span<const Point3> input) {
  Vertices v;
  v.points.reserve(input.size());
  v.of_input.reserve(input.size());
  v.points.push_back(input[0]);
  for (const Point3& p : input) {
    if ((p - v.points.back()).norm() > kSamePlace) v.points.push_back(p);
    v.of_input.push_back(v.points.size() - 1);
  }
  return v;
}

// Of the edges between distinct places: the least room of what is one of them.
std::vector<double> rooms_of(const Vertices& vertices, const FairOptions& options) {
  if (options.rooms.empty()) return {};
  std::vector<double> rooms(vertices.points.size() - 1, 1);
  for (std::size_t i = 0; i < options.rooms.size(); ++i) {
    double& room = rooms[std::min(vertices.of_input[i], rooms.size() - 1)];
    room = std::min(room, options.rooms[i]);
  }
  return rooms;
}

double deviation_of(const BandFit& fit) {
  return *std::max_element(fit.deviations().begin(), fit.deviations().end());
}

// rms of the vertices' distances from the curve.
double scatter_of(const Faired& faired, std::span<const Point3> points) {
  SplineWalk curve(faired.curve.basis().knots(), faired.curve.control_points());
  double squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    squares += (curve.point_at(faired.parameters[i]) - points[i]).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

// `offset`: the vertex of the fit at which `faired` starts.
SmoothCurve result_of(Faired faired, const Vertices& vertices, const PathFeatures& features,
                      std::size_t offset) {
  const double noise = scatter_of(faired, vertices.points);
  SmoothCurve path{std::move(faired.curve), {}, 0, noise, 0, 0};
  for (std::size_t i = 1; i + 1 < vertices.points.size(); ++i) {
    if (features.kinds[i + offset] == VertexKind::kKeptCorner) ++path.kept_corners;
  }
  path.vertex_parameters.reserve(vertices.of_input.size());
  for (const std::size_t i : vertices.of_input) {
    path.vertex_parameters.push_back(faired.parameters[i]);
  }
  return path;
}

// Nothing when the run starts at a corner, or when its ends do not join inside the band.
std::optional<SmoothCurve> fair_closed(const Vertices& vertices, const FairOptions& options) {
  const std::size_t n = vertices.points.size();
  const std::size_t wrap = std::min(kWrap, n - 1);
  std::vector<double> rooms = rooms_of(vertices, options);
  if (!rooms.empty()) {
    const std::vector<double> once = rooms;
    rooms.clear();
    for (std::size_t edge = 0; edge + 1 < n + 2 * wrap; ++edge) {
      rooms.push_back(once[(edge + once.size() - wrap) % once.size()]);
    }
  }
  BandFit fit(wrapped(vertices.points, wrap), options, {wrap, wrap + n - 1}, std::move(rooms));
  if (fit.features().kinds[wrap] != VertexKind::kSmooth) return std::nullopt;
  fit.hold();
  const int rounds = options.accurate ? 0 : widen_for_feed(fit, options);
  const Faired period = one_period({fit.curve(), fit.parameters()}, wrap, n);
  auto closed = closed_at_seam(period, vertices.points, options.tolerance);
  if (!closed) return std::nullopt;
  const double deviation = deviation_of(*closed, vertices.points, options.tolerance);
  SmoothCurve path = result_of(std::move(*closed), vertices, fit.features(), wrap);
  path.deviation = deviation;
  path.rounds = rounds;
  return path;
}

SmoothCurve fair_open(const Vertices& vertices, const FairOptions& options) {
  BandFit fit(vertices.points, options, {}, rooms_of(vertices, options));
  fit.hold();
  const int rounds = options.accurate ? 0 : widen_for_feed(fit, options);
  SmoothCurve path = result_of({fit.curve(), fit.parameters()}, vertices, fit.features(), 0);
  path.deviation = deviation_of(fit);
  path.rounds = rounds;
  return path;
}

void require(bool condition, const std::string& problem) {
  if (!condition) throw std::invalid_argument("fair_path: " + problem);
}

}  // namespace

std::optional<SmoothCurve> fair_path(std::span<const Point3> points, const FairOptions& options) {
  require(points.size() >= 2, std::to_string(points.size()) + " points, expected 2 or more");
  require(options.tolerance > 0,
          "tolerance " + std::to_string(options.tolerance) + " mm, expected more than 0");
  require(options.rooms.empty() || options.rooms.size() + 1 == points.size(),
          std::to_string(options.rooms.size()) + " rooms, expected one for each edge");
  const Vertices vertices = distinct(points);
  const std::size_t n = vertices.points.size();
  if (n < 2) return std::nullopt;

  const bool closed =
      n > 3 && (vertices.points.front() - vertices.points.back()).norm() <= kSamePlace;
  if (closed) {
    if (auto path = fair_closed(vertices, options)) return path;
  }
  return fair_open(vertices, options);
}

}  // namespace batten::geometry
