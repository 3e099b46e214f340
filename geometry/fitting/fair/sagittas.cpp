#include "geometry/fitting/fair/sagittas.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace batten::geometry {

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
