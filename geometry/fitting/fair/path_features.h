// What the vertices and edges of a cutting path are: samples of a smooth curve, corners, or
// lines that were meant as lines. Method: docs/algorithms/fair.md, section Features.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

struct FeatureTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  // Turns beyond this are reversals: rounding one inside the band would need a radius of a
  // hundredth of the tolerance, and the machine stops there anyway.
  double reversal = 170 * kPi / 180;  // [SmoothCurve.KeepsAReversal]
  // A corner turns this many times more than the vertices around it. Samples of a smooth curve have
  // turns that change slowly from one to the next.
  double sticks_out = 4;
  // But vertices of a bend turn gradually, by no more than this many times what their neighbours
  // do, however tight the bend is for the chords along it.
  double gradual = 6;  // [PathFeatures.AHairpinInFewChordsIsNoCorner]
  // A turn below this is no corner, whatever its neighbours: where a line meets an arc of chords
  // the turn is that of half a chord.
  double least_corner = 2 * kPi / 180;
  // Chords of a curve leave it by about (edge * turn / 8): with so many times more than the
  // tolerance, these edges are no chords that a CAM system would have written for it.
  double too_coarse = 2;
  // Noise of standard deviation s turns a vertex between edges a and b by about s (1/a + 1/b); a
  // corner turns more than this many standard deviations.
  double noise_turns = 4;
  // Noise is known to a third: where it seems less than it usually is on the path, it may be more
  // by this factor.
  double known = 1.5;
  // What scatters by more than the tolerance and more than this part of the edges is no noise, but
  // stairs and teeth: noise of that size would turn every vertex by 35 degrees (rms).
  double noise_of_edge = 0.25;  // [at 4: PathFeatures.StairsAreNoNoise]
  double much_noise = 0.25;     // above this part of the tolerance it may make corners
  // The sides of a corner among noise meet at so many standard deviations of what noise explains. A
  // vertex that alone is 4.5 noises off makes 3.3 of it.
  double sure_kink = 5;
  // Vertices that a kink is judged by: on either side at the most, and on both together at least.
  std::size_t most_beside_kink = 6;
  std::size_t fewest_around_kink = 5;  // [Kink.IsTheAngleOfTwoLinesWhereverTheirEndsAre]
  // A line cut into blocks turns by less [> SmoothCurve.AddsNothingToALineWithoutNoise], or its
  // vertices are off it by no more than the greatest rounding errors of both ends explain (across,
  // 2 sqrt(3) of a coordinate's), or by this part of the tolerance: where it meets a curve, a CAM
  // system ends its last edge beyond the joint, and noise moves its vertices.
  double no_turn = 1e-6;
  // [at 1e-4: SmoothCurve.StaysOnLinesThatAreCutIntoBlocksBesideARounding]
  double straight = 0.5;  // [PathFeatures.ALineAmongNoiseIsOneBesideShorterEdges]
  // A line is this many times longer than the edges beside it: with its straight continuation,
  // which rounding makes of some edges, too; or each of its edges by itself. Chords of a curve
  // whose curvature changes smoothly differ less from their neighbours.
  double line_is_longer = 6;  // [>]
  double edge_is_longer = 3;
  // A vertex turns more than by noise when it turns by so many noises over its edge: four standard
  // deviations of a second difference, sqrt(6) noises.
  double sure_turn = 4 * 2.45;
  // Neighbours on either side whose median decides on noise: enough to outvote corners and to know
  // it to a fifth (with 15, it came out at half its size here and there, and the curve followed
  // it), few enough to follow a change of noise along the path.
  std::size_t noise_window = 40;
};
inline constexpr FeatureTuning kFeatureTuning;

enum class VertexKind {
  kSmooth,      // a sample of a smooth curve
  kCorner,      // a corner to be rounded inside the band
  kKeptCorner,  // a corner that stays: turns more than the caller allows, or a reversal
};

struct FeatureOptions {
  double tolerance = 0.01;         // mm
  double keep_corner_angle = 3.2;  // radians: greater turns are kept corners
  double rounding = 0;             // mm, greatest error of one printed coordinate
  double keep_found_corner = 3.2;  // radians: corners, which noise does not explain, that turn more
};

struct PathFeatures {
  std::vector<double> parameters;  // length along the path at each vertex, mm
  std::vector<double> turns;       // radians in [0, pi] at each vertex; 0 at the ends
  std::vector<double> noise;       // mm, see vertex_noise
  std::vector<double> sagittas;    // mm, per edge, see sagittas
  std::vector<VertexKind> kinds;   // the ends are kKeptCorner
  std::vector<bool> lines;         // edge i, from vertex i to i + 1, was meant as a line
};

// Requires two points or more, neighbours apart.
[[nodiscard]] PathFeatures find_features(std::span<const Point3> points,
                                         const FeatureOptions& options);

// --- what they are found by ---------------------------------------------------------------------

// Whether a vertex among noisy ones is a corner: its two sides are judged, not the vertex alone.
// Method: docs/algorithms/fair.md, section Corners among noise.
struct Kink {
  double angle = 0;      // radians, at which the two sides meet
  double deviation = 0;  // radians: what noise makes of no kink at all, as a standard deviation
};

// The kink at `vertex` of the polynomial that fits `points` best (least squares) and may be broken
// there. Its degree is 4, or less where there are few points.
//
// `parameters`: length along the path, one per point, increasing. `noise`: mm, standard deviation
// of the points across the path. Returns nothing at an end, and where there are too few vertices.
[[nodiscard]] std::optional<Kink> kink_at(std::span<const Point3> points,
                                          std::span<const double> parameters, std::size_t vertex,
                                          double noise);

// How far the vertices of a path scatter about a smooth curve, and how far that would leave the
// edges. Method: docs/algorithms/fair.md, section Noise.

// One value per vertex: the estimated standard deviation (mm) of its distance from the smooth
// path, local over some 80 vertices; 0 where the neighbourhood shows none. Corners that stand
// alone do not count as noise, nor does the curvature of a coarsely sampled curve: noise is
// what changes its sign from vertex to vertex.
//
// `parameters`: length along the path at each vertex, strictly increasing, same size.
[[nodiscard]] std::vector<double> vertex_noise(std::span<const Point3> points,
                                               std::span<const double> parameters);

// Per edge, mm: the height of the cubic that meets both of its ends at half of their turns.
// `parameters`: length along the path at each vertex; `turns` (radians) and `noise` (mm) of each
// vertex. Where the path turns to different sides at the two ends, by more than its noise, the
// cubic crosses the edge: the greater of its two bows counts.
[[nodiscard]] std::vector<double> sagittas(std::span<const Point3> points,
                                           std::span<const double> parameters,
                                           std::span<const double> turns,
                                           std::span<const double> noise);

}  // namespace batten::geometry
