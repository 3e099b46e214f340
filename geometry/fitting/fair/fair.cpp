#include "geometry/fitting/fair/fair.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/fair/fair_band.h"
#include "geometry/fitting/fair/fair_measure.h"

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

namespace {

// A knot that is nearer to a cut than this part of the spans beside it is put on the cut. Left
// where it is, it would make a span of next to no length, and what is done to the control points at
// the seam would bend the curve there as hard as that span is short.
constexpr double kOnCut = 0.1;

// The same control points, with a knot at u where one is as good as there: the curve slides along
// itself by a thirtieth of a span at the most.
BsplineCurve with_near_knot_at(const BsplineCurve& curve, double u) {
  std::vector<double> knots = curve.basis().knots();
  const auto above = std::lower_bound(knots.begin(), knots.end(), u);
  for (const auto knot : {above, above - 1}) {
    if (knot <= knots.begin() || knot + 1 >= knots.end()) continue;
    const double room = std::min(*knot - *(knot - 1), *(knot + 1) - *knot);
    if (std::abs(*knot - u) < kOnCut * room) *knot = u;
  }
  return {BsplineBasis(curve.degree(), std::move(knots)), curve.control_points()};
}

// The period moved at both ends so that it starts and ends at `seam`: three control points are
// shifted alike, so that tangent and curvature stay as they are there.
Faired shifted_to(const Faired& period, const Point3& seam) {
  std::vector<Point3> points = period.curve.control_points();
  const Vector3 at_start = seam - points.front();
  const Vector3 at_end = seam - points.back();
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < std::min<std::size_t>(3, n / 2); ++i) {
    points[i] += at_start;
    points[n - 1 - i] += at_end;
  }
  points.front() = seam;
  points.back() = seam;
  return {BsplineCurve(period.curve.basis(), std::move(points)), period.parameters};
}

// The period with both ends at `seam` and with the mean of the two first and second derivatives
// there: no seam at all. Requires six control points or more.
Faired joined_at(const Faired& period, const Point3& seam) {
  const BsplineCurve& curve = period.curve;
  std::vector<Point3> points = curve.control_points();
  const std::size_t n = points.size();
  const auto mean = [&](int order) {
    return Vector3(0.5 * (curve.derivative_at(curve.first(), order) +
                          curve.derivative_at(curve.last(), order)));
  };
  const Vector3 d1 = mean(1);
  const Vector3 d2 = mean(2);
  const auto& t = curve.basis().knots();
  const std::size_t m = t.size();
  const double h1 = t[4] - t[3];
  const double h2 = t[5] - t[3];
  const double g1 = t[m - 4] - t[m - 5];
  const double g2 = t[m - 4] - t[m - 6];
  points[0] = seam;
  points[1] = seam + h1 / 3 * d1;
  points[2] = points[1] + h2 / 3 * (d1 + h1 / 2 * d2);
  points[n - 1] = seam;
  points[n - 2] = seam - g1 / 3 * d1;
  points[n - 3] = points[n - 2] - g2 / 3 * (d1 - g1 / 2 * d2);
  return {BsplineCurve(curve.basis(), std::move(points)), period.parameters};
}

}  // namespace

double deviation_of(const Faired& faired, std::span<const Point3> points, double limit) {
  SplineWalk walk(faired.curve.basis().knots(), faired.curve.control_points());
  double worst = 0;
  for (std::size_t edge = 0; edge + 1 < points.size(); ++edge) {
    worst = std::max(worst, edge_deviation(walk, {points, faired.parameters}, edge, limit));
  }
  return worst;
}

std::vector<Point3> wrapped(std::span<const Point3> points, std::size_t wrap) {
  const std::size_t period = points.size() - 1;
  std::vector<Point3> out;
  out.reserve(points.size() + 2 * wrap);
  for (std::size_t i = 0; i < wrap; ++i) out.push_back(points[period - wrap + i]);
  out.insert(out.end(), points.begin(), points.end());
  for (std::size_t i = 1; i <= wrap; ++i) out.push_back(points[i]);
  return out;
}

Faired one_period(const Faired& all, std::size_t wrap, std::size_t count) {
  const auto begin = all.parameters.begin() + static_cast<std::ptrdiff_t>(wrap);
  std::vector<double> at(begin, begin + static_cast<std::ptrdiff_t>(count));
  const BsplineCurve cut = with_near_knot_at(with_near_knot_at(all.curve, at.front()), at.back());
  BsplineCurve part = cut.part(at.front(), at.back());
  return {std::move(part), std::move(at)};
}

std::optional<Faired> closed_at_seam(const Faired& period, std::span<const Point3> points,
                                     double tolerance) {
  constexpr std::size_t kRoomToJoin = 6;
  if (period.curve.control_points().size() >= kRoomToJoin) {
    Faired joined = joined_at(period, points.front());
    if (deviation_of(joined, points, tolerance) <= tolerance) return joined;
  }
  Faired shifted = shifted_to(period, points.front());
  if (deviation_of(shifted, points, tolerance) <= tolerance) return shifted;
  return std::nullopt;
}

}  // namespace batten::geometry
