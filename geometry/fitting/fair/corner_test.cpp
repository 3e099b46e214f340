#include "geometry/fitting/fair/corner_test.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace batten::geometry {

namespace {

// One value per vertex of a window.
using WindowColumn = std::array<double, 2 * kMostBesideKink + 1>;

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

}  // namespace

// Least squares with the columns 1, t, t^2 .. and |t|: what is left of |t| when the others are
// taken out of it gives its coefficient alone.
std::optional<Kink> kink_at(std::span<const Point3> points, std::span<const double> parameters,
                            std::size_t vertex, double noise) {
  const std::size_t before = std::min(vertex, kMostBesideKink);
  const std::size_t behind = std::min(points.size() - 1 - vertex, kMostBesideKink);
  if (std::min(before, behind) == 0 || before + behind < kFewestAroundKink) return std::nullopt;
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

}  // namespace batten::geometry
