#include "geometry/chords/balanced_chords.h"

#include <algorithm>
#include <cstddef>

namespace batten::geometry {

namespace {

constexpr double kOutwards = 2.0 / 3;

bool is_corner(const BsplineCurve& curve, double u) {
  const auto& knots = curve.basis().knots();
  const auto [first, end] = std::equal_range(knots.begin(), knots.end(), u);
  return end - first >= curve.basis().degree();
}

// From the chord between two places of the curve to its middle place, across the chord: the height
// of a bend, nothing where the curve crosses its chord.
Vector3 bow(const BsplineCurve& curve, double from, double to) {
  const Point3 start = curve.point_at(from);
  const Vector3 chord = curve.point_at(to) - start;
  const Vector3 off = curve.point_at(0.5 * (from + to)) - start;
  const double squared = chord.squaredNorm();
  if (squared == 0) return Vector3::Zero();
  return off - off.dot(chord) / squared * chord;
}

}  // namespace

std::vector<LinkVertex> balanced_chords(const BsplineCurve& curve,
                                        std::span<const double> parameters) {
  std::vector<LinkVertex> vertices;
  vertices.reserve(parameters.size());
  for (const double u : parameters) vertices.push_back({curve.point_at(u), u});
  Vector3 before = Vector3::Zero();
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const double u = vertices[i].parameter;
    const Vector3 after = bow(curve, u, vertices[i + 1].parameter);
    if (i > 0 && !is_corner(curve, u)) vertices[i].place += kOutwards * 0.5 * (before + after);
    before = after;
  }
  return vertices;
}

}  // namespace batten::geometry
