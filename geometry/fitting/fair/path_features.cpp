#include "geometry/fitting/fair/path_features.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace batten::geometry {

namespace {

// One value per vertex of a window.
using WindowColumn = std::array<double, 2 * kFeatureTuning.most_beside_kink + 1>;

double dot_of(const WindowColumn& a, const WindowColumn& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

void take_out(WindowColumn& from, const WindowColumn& other) {
  const double part = dot_of(from, other) / dot_of(other, other);
  for (std::size_t i = 0; i < from.size(); ++i) from[i] -= part * other[i];
}

// A bend that changes along the window must not count as a kink: the higher the degree, the less it
// does, and the less is a kink told from noise. Beyond a short side a bend is known least.
std::size_t degree_for(std::size_t before, std::size_t behind) {
  const std::size_t beside = std::min(before, behind);
  if (beside >= 6) return 4;
  if (beside >= 3) return 3;
  return std::min<std::size_t>(4, before + behind - 3);
}

double turn_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Median turn of the three vertices on either side.
double turn_around(const std::vector<double>& turns, std::size_t i) {
  std::array<double, 6> near{};
  std::size_t count = 0;
  for (std::size_t j = std::max<std::size_t>(i, 4) - 3; j <= i + 3 && j + 1 < turns.size(); ++j) {
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
    double noise = std::max(f.noise[i], std::min(usual, kFeatureTuning.known * f.noise[i]));
    if (noise > kFeatureTuning.noise_of_edge * std::min(before, after))
      noise = std::min(noise, options.tolerance);
    scatter[i] = std::max(noise, options.rounding);
  }
  return scatter;
}

// Whether the path turns on at vertex i as it does at the one before it, in the same sense and
// neither much more nor much less.
bool turns_on(std::span<const Point3> p, const PathFeatures& f, std::size_t i) {
  if (f.turns[i] > kFeatureTuning.gradual * f.turns[i - 1] ||
      f.turns[i - 1] > kFeatureTuning.gradual * f.turns[i])
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
  if (turn > std::min(options.keep_corner_angle, kFeatureTuning.reversal))
    return VertexKind::kKeptCorner;
  const double before = f.parameters[i] - f.parameters[i - 1];
  const double after = f.parameters[i + 1] - f.parameters[i];
  const double from_noise = kFeatureTuning.noise_turns * scatter * (1 / before + 1 / after);
  if (turn < std::max(kFeatureTuning.least_corner, from_noise)) return VertexKind::kSmooth;
  const bool too_coarse =
      turn * std::min(before, after) / 8 > kFeatureTuning.too_coarse * options.tolerance;
  const bool stands_out =
      turn > kFeatureTuning.sticks_out * turn_around(f.turns, i) && !is_bend(points, f, i);
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
    if (!(scatter[i] > kFeatureTuning.much_noise * tolerance)) continue;
    std::size_t end = i + 1;
    while (end <= i + kFeatureTuning.most_beside_kink && found[end] == VertexKind::kSmooth) ++end;
    const std::size_t count = end + 1 - first;
    const auto kink = kink_at(points.subspan(first, count),
                              std::span(f.parameters).subspan(first, count), i - first, scatter[i]);
    if (kink && kink->angle < kFeatureTuning.sure_kink * kink->deviation)
      f.kinds[i] = VertexKind::kSmooth;
  }
}

// Where sections of edges end that together are as good as one straight edge: indices of vertices,
// increasing, the first and the last included. `off`: mm, by which their vertices may be off it.
std::vector<std::size_t> straight_ends(std::span<const Point3> points, const PathFeatures& f,
                                       double off) {
  std::vector<std::size_t> ends = {0};
  Eigen::Matrix<double, 3, 2> across;  // of the section's first edge
  Eigen::Array2d least;                // slopes from it that pass all vertices so far
  Eigen::Array2d most;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Point3& start = points[ends.back()];
    const double along = f.parameters[i] - f.parameters[ends.back()];
    const double room = std::max(off / along, kFeatureTuning.no_turn);
    const bool is_first = i == ends.back() + 1;
    if (!is_first) {
      const Eigen::Array2d slope = across.transpose() * (points[i] - start) / along;
      const bool goes_on =
          f.kinds[i - 1] == VertexKind::kSmooth && (slope >= least).all() && (slope <= most).all();
      if (goes_on) {
        least = least.max(slope - room);
        most = most.min(slope + room);
        continue;
      }
      ends.push_back(i - 1);
      --i;
      continue;
    }
    const Vector3 direction = (points[i] - start).normalized();
    across.col(0) = direction.unitOrthogonal();
    across.col(1) = direction.cross(across.col(0));
    least.setConstant(-room);
    most.setConstant(room);
  }
  ends.push_back(points.size() - 1);
  return ends;
}

// Which edges were meant as lines: those that with their straight continuation are longer than what
// is next to them, and those that are so alone where the continuation is nearly straight only. A
// corner or an end of the path next to one counts as nothing.
std::vector<bool> lines_of(std::span<const Point3> points, const PathFeatures& f,
                           const FeatureOptions& options) {
  std::vector<bool> lines(points.size() - 1, false);
  const auto length = [&](std::size_t from, std::size_t to) {
    return f.parameters[to] - f.parameters[from];
  };
  const auto find = [&](double off, bool alone) {
    const std::vector<std::size_t> ends = straight_ends(points, f, off);
    const double times = alone ? kFeatureTuning.edge_is_longer : kFeatureTuning.line_is_longer;
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      const auto beside = [&](std::size_t vertex, std::size_t section) {
        const bool meets = f.kinds[vertex] == VertexKind::kSmooth;
        return meets ? length(ends[section], ends[section + 1]) : 0.0;
      };
      const double next = std::max(beside(ends[k], k - 1), beside(ends[k + 1], k + 1));
      for (std::size_t edge = ends[k]; edge < ends[k + 1]; ++edge) {
        const double here = alone ? length(edge, edge + 1) : length(ends[k], ends[k + 1]);
        const bool is_longer = here > times * next && (next > 0 || !alone);
        lines[edge] = lines[edge] || is_longer;
      }
    }
  };
  find(0, false);
  const double both_ends = 2 * std::sqrt(3.0) * options.rounding;
  find(std::max(both_ends, kFeatureTuning.straight * options.tolerance), true);
  return lines;
}

// Whether the path turns to one side before an edge and to the other after it.
bool turns_back(std::span<const Point3> points, std::size_t edge) {
  const Vector3 along = points[edge + 1] - points[edge];
  const Vector3 before = (points[edge] - points[edge - 1]).cross(along);
  const Vector3 after = along.cross(points[edge + 2] - points[edge + 1]);
  return before.dot(after) < 0;
}

// The distance of vertex i from the cubic through its four neighbours, across the path, scaled
// so that noise of standard deviation s gives residuals of standard deviation s.
Vector3 residual(std::span<const Point3> p, std::span<const double> s, std::size_t i) {
  const std::array<std::size_t, 4> at = {i - 2, i - 1, i + 1, i + 2};
  Vector3 off = p[i];
  double squares = 1;
  for (const std::size_t j : at) {
    double weight = 1;
    for (const std::size_t k : at) {
      if (k != j) weight *= (s[i] - s[k]) / (s[j] - s[k]);
    }
    off -= weight * p[j];
    squares += weight * weight;
  }
  const Vector3 chord = p[i + 1] - p[i - 1];
  const double length = chord.norm();
  if (length > 0) off -= (off.dot(chord) / (length * length)) * chord;
  return off / std::sqrt(squares);
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
  f.sagittas = sagittas(points, f.parameters, f.turns, f.noise);
  f.kinds.assign(n, VertexKind::kKeptCorner);
  const std::vector<double> scatter = cornerless_scatter(f, options);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    f.kinds[i] = kind_of(points, f, i, scatter[i], options);
  }
  drop_corners_of_noise(points, scatter, options.tolerance, f);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const bool stays = f.kinds[i] == VertexKind::kCorner && f.turns[i] > options.keep_found_corner;
    if (stays) f.kinds[i] = VertexKind::kKeptCorner;
  }
  f.lines = lines_of(points, f, options);
  return f;
}

// Least squares with the columns 1, t, t^2 .. and |t|: what is left of |t| when the others are
// taken out of it gives its coefficient alone.
std::optional<Kink> kink_at(std::span<const Point3> points, std::span<const double> parameters,
                            std::size_t vertex, double noise) {
  const std::size_t before = std::min(vertex, kFeatureTuning.most_beside_kink);
  const std::size_t behind = std::min(points.size() - 1 - vertex, kFeatureTuning.most_beside_kink);
  if (std::min(before, behind) == 0 || before + behind < kFeatureTuning.fewest_around_kink)
    return std::nullopt;
  const std::size_t first = vertex - before;
  const std::size_t count = before + behind + 1;
  const double scale = parameters[first + count - 1] - parameters[first];

  WindowColumn place{};  // t; entries beyond the window stay 0
  WindowColumn broken{};
  for (std::size_t i = 0; i < count; ++i) {
    place[i] = (parameters[first + i] - parameters[vertex]) / scale;
    broken[i] = std::abs(place[i]);
  }
  std::array<WindowColumn, 5> powers{};
  const std::size_t degree = degree_for(before, behind);
  for (std::size_t i = 0; i < count; ++i) powers[0][i] = 1;
  for (std::size_t k = 1; k <= degree; ++k) {
    for (std::size_t i = 0; i < count; ++i) powers[k][i] = powers[k - 1][i] * place[i];
  }
  for (std::size_t k = 0; k <= degree; ++k) {
    for (std::size_t j = 0; j < k; ++j) take_out(powers[k], powers[j]);
    take_out(broken, powers[k]);
  }

  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < count; ++i) sum += broken[i] * (points[first + i] - points[vertex]);
  const double square = dot_of(broken, broken);
  // The directions of the two sides are of unit length, and this is their difference.
  const double jump = 2 / (square * scale) * sum.norm();
  return Kink{2 * std::asin(std::min(1.0, 0.5 * jump)), 2 * noise / (std::sqrt(square) * scale)};
}

std::vector<double> vertex_noise(std::span<const Point3> points,
                                 std::span<const double> parameters) {
  constexpr std::size_t kWindow = kFeatureTuning.noise_window;
  const std::size_t n = points.size();
  std::vector<double> noise(n, 0);
  if (n < 6) return noise;
  // products[i] belongs to vertices i + 2 and i + 3.
  std::vector<double> products;
  products.reserve(n - 5);
  Vector3 before = residual(points, parameters, 2);
  for (std::size_t i = 3; i + 2 < n; ++i) {
    const Vector3 here = residual(points, parameters, i);
    products.push_back(-before.dot(here));
    before = here;
  }
  // For white noise the residuals of neighbours have correlation -1.556 / 1.944 = -0.8, and the
  // median of the negative product of two such normal variables of unit variance is 0.36
  // (0.9 chi^2 - 0.1 chi^2).
  constexpr double kMedianOfProducts = 0.36;
  std::vector<double> window;  // in order of size
  std::size_t begin = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t center = std::clamp<std::size_t>(i, 2, n - 4) - 2;
    for (; begin + kWindow < center; ++begin) {
      window.erase(std::ranges::lower_bound(window, products[begin]));
    }
    for (; end < products.size() && end <= center + kWindow; ++end) {
      window.insert(std::ranges::upper_bound(window, products[end]), products[end]);
    }
    noise[i] = std::sqrt(std::max(0.0, window[window.size() / 2]) / kMedianOfProducts);
  }
  return noise;
}

std::vector<double> sagittas(std::span<const Point3> points, std::span<const double> parameters,
                             std::span<const double> turns, std::span<const double> noise) {
  const std::size_t edges = points.size() - 1;
  std::vector<double> heights(edges);
  for (std::size_t edge = 0; edge < edges; ++edge) {
    const double length = parameters[edge + 1] - parameters[edge];
    const double start = 0.5 * turns[edge];
    const double end = 0.5 * turns[edge + 1];
    const double by_noise =
        kFeatureTuning.sure_turn * std::max(noise[edge], noise[edge + 1]) / length;
    const bool inside = edge > 0 && edge + 1 < edges;
    const bool surely = inside && std::min(turns[edge], turns[edge + 1]) > by_noise;
    if (!surely || !turns_back(points, edge)) {
      heights[edge] = length * (start + end) / 8;
      continue;
    }
    double height = 0;
    for (const double t : {0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9}) {
      height = std::max(height, std::abs(t * (1 - t) * (start * (1 - t) - end * t)));
    }
    heights[edge] = length * height;
  }
  return heights;
}

}  // namespace batten::geometry
