// What the vertices and edges of a cutting path are: samples of a smooth curve, corners, or
// lines that were meant as lines. Method: docs/algorithms/fair.md, section Features.
#pragma once

#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

enum class VertexKind {
  kSmooth,      // a sample of a smooth curve
  kCorner,      // a corner to be rounded inside the band
  kKeptCorner,  // a corner that stays: turns more than the caller allows, or a reversal
};

struct FeatureOptions {
  double tolerance = 0.01;         // mm
  double keep_corner_angle = 3.2;  // radians: greater turns are kept corners
  double rounding = 0;             // mm, greatest error of one printed coordinate
};

struct PathFeatures {
  std::vector<double> parameters;  // length along the path at each vertex, mm
  std::vector<double> turns;       // radians in [0, pi] at each vertex; 0 at the ends
  std::vector<double> noise;       // mm, see vertex_noise
  std::vector<double> bows;        // mm, per edge, see sagittas
  std::vector<VertexKind> kinds;   // the ends are kKeptCorner
  std::vector<bool> lines;         // edge i, from vertex i to i + 1, was meant as a line
};

// Requires two points or more, neighbours apart.
[[nodiscard]] PathFeatures find_features(std::span<const Point3> points,
                                         const FeatureOptions& options);

// How far a smooth curve through the vertices of a polyline would leave its edges.
// Method: docs/algorithms/fair.md, section Noise.

// Per edge, mm: the height of the cubic that meets both of its ends at half of their turns.
// `parameters`: length along the path at each vertex; `turns` (radians) and `noise` (mm) of each
// vertex. Where the path turns to different sides at the two ends, by more than its noise, the
// cubic crosses the edge: the greater of its two bows counts.
[[nodiscard]] std::vector<double> sagittas(std::span<const Point3> points,
                                           std::span<const double> parameters,
                                           std::span<const double> turns,
                                           std::span<const double> noise);

}  // namespace batten::geometry
