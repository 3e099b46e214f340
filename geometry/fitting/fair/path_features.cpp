#include "geometry/fitting/fair/path_features.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/fitting/fair/corner_test.h"

namespace batten::geometry {

namespace {

// Turns beyond this are reversals: rounding one inside the band would need a radius of a
// hundredth of the tolerance, and the machine stops there anyway.
constexpr double kReversal = 170 * std::numbers::pi / 180;

// A corner turns this many times more than the vertices around it. Samples of a smooth curve
// have turns that change slowly from one to the next.
constexpr double kStandsOut = 4;

// But vertices of a bend turn gradually, by no more than this many times what their neighbours do,
// however tight the bend is for the chords along it.
constexpr double kGradual = 6;

// A turn below this is no corner, whatever its neighbours: where a line meets an arc of chords
// the turn is that of half a chord.
constexpr double kLeastCorner = 2 * std::numbers::pi / 180;

// Noise of standard deviation s turns a vertex between edges a and b by about s (1/a + 1/b);
// a corner turns more than this many standard deviations.
constexpr double kNoiseTurns = 4;

// Noise is known to a third: where it seems less than it usually is on the path, it may be more by
// this factor.
constexpr double kKnown = 1.5;

// What scatters by more than the tolerance and more than this part of the edges is no noise, but
// stairs and teeth: noise of that size would turn every vertex by 35 degrees (rms).
constexpr double kNoiseOfEdge = 0.25;

// Noise above this part of the tolerance may make corners.
constexpr double kMuchNoise = 0.25;

// The sides of a corner among noise meet at so many standard deviations of what noise explains. A
// vertex that alone is 4.5 noises off makes 3.3 of it.
constexpr double kSureKink = 5;

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

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// What vertices may scatter by that are no corners, mm.
std::vector<double> cornerless_scatter(const PathFeatures& f, const FeatureOptions& options) {
  const double usual = median_of(f.noise);
  std::vector<double> scatter(f.noise.size(), options.rounding);
  for (std::size_t i = 1; i + 1 < scatter.size(); ++i) {
    const double before = f.parameters[i] - f.parameters[i - 1];
    const double after = f.parameters[i + 1] - f.parameters[i];
    double noise = std::max(f.noise[i], std::min(usual, kKnown * f.noise[i]));
    if (noise > kNoiseOfEdge * std::min(before, after)) noise = std::min(noise, options.tolerance);
    scatter[i] = std::max(noise, options.rounding);
  }
  return scatter;
}

// Whether the path turns on at vertex i as it does at the one before it, in the same sense and
// neither much more nor much less.
bool turns_on(std::span<const Point3> p, const PathFeatures& f, std::size_t i) {
  if (f.turns[i] > kGradual * f.turns[i - 1] || f.turns[i - 1] > kGradual * f.turns[i])
    return false;
  const Vector3 before = (p[i - 1] - p[i - 2]).cross(p[i] - p[i - 1]);
  const Vector3 here = (p[i] - p[i - 1]).cross(p[i + 1] - p[i]);
  return before.dot(here) > 0;
}

// Whether vertex i is the middle of a bend: two vertices on either side belong to it.
bool is_bend(std::span<const Point3> p, const PathFeatures& f, std::size_t i) {
  if (i < 3 || i + 3 >= p.size()) return false;
  for (std::size_t j = i - 1; j <= i + 2; ++j) {
    if (!turns_on(p, f, j)) return false;
  }
  return true;
}

VertexKind kind_of(std::span<const Point3> points, const PathFeatures& f, std::size_t i,
                   double scatter, const FeatureOptions& options) {
  const double turn = f.turns[i];
  if (turn > std::min(options.keep_corner_angle, kReversal)) return VertexKind::kKeptCorner;
  const double before = f.parameters[i] - f.parameters[i - 1];
  const double after = f.parameters[i + 1] - f.parameters[i];
  const double from_noise = kNoiseTurns * scatter * (1 / before + 1 / after);
  if (turn < std::max(kLeastCorner, from_noise)) return VertexKind::kSmooth;
  // Chords of a curve leave it by about (edge * turn / 8): if that is far more than the
  // tolerance, these edges are no chords that a CAM system would have written for it.
  const bool too_coarse = turn * std::min(before, after) / 8 > 2 * options.tolerance;
  const bool stands_out = turn > kStandsOut * turn_around(f.turns, i) && !is_bend(points, f, i);
  return too_coarse || stands_out ? VertexKind::kCorner : VertexKind::kSmooth;
}

// Noise makes a single vertex stand out now and then. A corner is there where the sides before and
// behind it say so, each as far as the next vertex that may be one.
void drop_corners_of_noise(std::span<const Point3> points, std::span<const double> scatter,
                           double tolerance, PathFeatures& f) {
  const std::vector<VertexKind> found = f.kinds;
  std::size_t last = 0;
  for (std::size_t i = 1; i + 1 < found.size(); ++i) {
    if (found[i] == VertexKind::kSmooth) continue;
    const std::size_t first = std::exchange(last, i);
    if (found[i] != VertexKind::kCorner) continue;
    if (!(scatter[i] > kMuchNoise * tolerance)) continue;
    std::size_t end = i + 1;
    while (end <= i + kMostBesideKink && found[end] == VertexKind::kSmooth) ++end;
    const std::size_t count = end + 1 - first;
    const auto kink = kink_at(points.subspan(first, count),
                              std::span(f.parameters).subspan(first, count), i - first, scatter[i]);
    if (kink && kink->angle < kSureKink * kink->deviation) f.kinds[i] = VertexKind::kSmooth;
  }
}

// Which edges were meant as lines: those longer than the first edge at either end that is not
// their straight continuation. A corner or an end of the path there counts as an edge of no length.
std::vector<bool> lines_of(const PathFeatures& f) {
  const std::size_t edges = f.parameters.size() - 1;
  const auto length = [&](std::size_t e) { return f.parameters[e + 1] - f.parameters[e]; };
  // The length beyond vertex v, seen along the path, where `next` is the edge behind it and
  // `further` what lies beyond that one.
  const auto beyond = [&](std::size_t v, std::size_t next, double further) {
    if (f.kinds[v] != VertexKind::kSmooth) return 0.0;
    return f.turns[v] > kNoTurn ? length(next) : further;
  };
  std::vector<double> after(edges, 0);
  for (std::size_t e = edges - 1; e-- > 0;) after[e] = beyond(e + 1, e + 1, after[e + 1]);
  std::vector<bool> lines(edges, false);
  double before = 0;
  for (std::size_t e = 0; e < edges; ++e) {
    if (e > 0) before = beyond(e, e - 1, before);
    lines[e] = length(e) > kLineIsLonger * before && length(e) > kLineIsLonger * after[e];
  }
  return lines;
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
  f.bows = sagittas(points, f.parameters, f.turns, f.noise);
  f.kinds.assign(n, VertexKind::kKeptCorner);
  const std::vector<double> scatter = cornerless_scatter(f, options);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    f.kinds[i] = kind_of(points, f, i, scatter[i], options);
  }
  drop_corners_of_noise(points, scatter, options.tolerance, f);
  f.lines = lines_of(f);
  return f;
}

namespace {

// A vertex turns more than by noise when it turns by so many noises over its edge: four standard
// deviations of a second difference, sqrt(6) noises.
constexpr double kSureTurn = 4 * 2.45;

// Whether the path turns to one side before an edge and to the other behind it.
bool turns_back(std::span<const Point3> points, std::size_t edge) {
  const Vector3 along = points[edge + 1] - points[edge];
  const Vector3 before = (points[edge] - points[edge - 1]).cross(along);
  const Vector3 behind = along.cross(points[edge + 2] - points[edge + 1]);
  return before.dot(behind) < 0;
}

}  // namespace

std::vector<double> sagittas(std::span<const Point3> points, std::span<const double> parameters,
                             std::span<const double> turns, std::span<const double> noise) {
  const std::size_t edges = points.size() - 1;
  std::vector<double> bows(edges);
  for (std::size_t edge = 0; edge < edges; ++edge) {
    const double length = parameters[edge + 1] - parameters[edge];
    const double start = 0.5 * turns[edge];
    const double end = 0.5 * turns[edge + 1];
    const double by_noise = kSureTurn * std::max(noise[edge], noise[edge + 1]) / length;
    const bool inside = edge > 0 && edge + 1 < edges;
    const bool surely = inside && std::min(turns[edge], turns[edge + 1]) > by_noise;
    if (!surely || !turns_back(points, edge)) {
      bows[edge] = length * (start + end) / 8;
      continue;
    }
    double height = 0;
    for (const double t : {0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9}) {
      height = std::max(height, std::abs(t * (1 - t) * (start * (1 - t) - end * t)));
    }
    bows[edge] = length * height;
  }
  return bows;
}

}  // namespace batten::geometry
