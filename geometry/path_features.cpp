#include "geometry/path_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/vertex_noise.h"

namespace batten::geometry {

namespace {

// Turns beyond this are reversals: rounding one inside the band would need a radius of a
// hundredth of the tolerance, and the machine stops there anyway.
constexpr double kReversal = 170 * std::numbers::pi / 180;

// A corner turns this many times more than the vertices around it. Samples of a smooth curve
// have turns that change slowly from one to the next.
constexpr double kStandsOut = 4;

// A turn below this is no corner, whatever its neighbours: where a line meets an arc of chords
// the turn is that of half a chord.
constexpr double kLeastCorner = 2 * std::numbers::pi / 180;

// Noise of standard deviation s turns a vertex between edges a and b by about s (1/a + 1/b);
// a corner turns more than this many standard deviations.
constexpr double kNoiseTurns = 4;

// A line that was cut into blocks does not turn between them, but for rounding.
constexpr double kNoTurn = 1e-6;

// A line is this many times longer than the edges beside it. Chords of a curve whose
// curvature changes smoothly differ less from their neighbours.
constexpr double kLineIsLonger = 6;

double turn_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Median turn of the three vertices on either side.
double turn_around(const std::vector<double>& turns, std::size_t i) {
  std::array<double, 6> near{};
  std::size_t count = 0;
  const std::size_t begin = i < 3 ? 1 : i - 3;
  for (std::size_t j = std::max<std::size_t>(begin, 1); j <= i + 3 && j + 1 < turns.size(); ++j) {
    if (j != i) near[count++] = turns[j];
  }
  if (count == 0) return 0;
  std::nth_element(near.begin(), near.begin() + count / 2, near.begin() + count);
  return near[count / 2];
}

VertexKind kind_of(const PathFeatures& f, std::size_t i, const FeatureOptions& options) {
  const double turn = f.turns[i];
  if (turn > std::min(options.keep_corner_angle, kReversal)) return VertexKind::kKeptCorner;
  const double before = f.parameters[i] - f.parameters[i - 1];
  const double after = f.parameters[i + 1] - f.parameters[i];
  // What is more than the tolerance is no noise that could be smoothed: stairs and teeth.
  const double scatter = std::max(std::min(f.noise[i], options.tolerance), options.rounding);
  const double from_noise = kNoiseTurns * scatter * (1 / before + 1 / after);
  if (turn < std::max(kLeastCorner, from_noise)) return VertexKind::kSmooth;
  // Chords of a curve leave it by about (edge * turn / 8): if that is far more than the
  // tolerance, these edges are no chords that a CAM system would have written for it.
  const bool too_coarse = turn * std::min(before, after) / 8 > 2 * options.tolerance;
  const bool stands_out = turn > kStandsOut * turn_around(f.turns, i);
  return too_coarse || stands_out ? VertexKind::kCorner : VertexKind::kSmooth;
}

// The length of the first edge beyond `edge` on one side that is not its straight continuation;
// 0 where a corner or an end stands first.
double length_beyond(const PathFeatures& f, std::size_t edge, bool forward) {
  std::size_t e = edge;
  while (true) {
    const std::size_t vertex = forward ? e + 1 : e;
    if (f.kinds[vertex] != VertexKind::kSmooth) return 0;
    e = forward ? e + 1 : e - 1;
    if (f.turns[vertex] > kNoTurn) return f.parameters[e + 1] - f.parameters[e];
  }
}

bool is_line(const PathFeatures& f, std::size_t edge) {
  const double length = f.parameters[edge + 1] - f.parameters[edge];
  return length > kLineIsLonger * length_beyond(f, edge, false) &&
         length > kLineIsLonger * length_beyond(f, edge, true);
}

}  // namespace

PathFeatures find_features(std::span<const Point3> points, const FeatureOptions& options) {
  const std::size_t n = points.size();
  PathFeatures f;
  f.parameters.assign(n, 0);
  for (std::size_t i = 1; i < n; ++i) {
    f.parameters[i] = f.parameters[i - 1] + (points[i] - points[i - 1]).norm();
  }
  f.turns.assign(n, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    f.turns[i] = turn_between(points[i] - points[i - 1], points[i + 1] - points[i]);
  }
  f.noise = vertex_noise(points, f.parameters);
  f.kinds.assign(n, VertexKind::kKeptCorner);
  for (std::size_t i = 1; i + 1 < n; ++i) f.kinds[i] = kind_of(f, i, options);
  f.lines.assign(n - 1, false);
  for (std::size_t e = 0; e + 1 < n; ++e) f.lines[e] = is_line(f, e);
  return f;
}

}  // namespace batten::geometry
