#include "geometry/chords/balanced_chords.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/chords/linearize.h"
#include "tests/support/parabolas.h"

namespace batten::geometry {
namespace {

// Signed distances of a flat curve y(x) from chords, upwards, at even steps.
struct Offsets {
  double mean = 0;
  double rms = 0;
  double greatest = 0;
};

Offsets offsets_of(const Parabola& parabola, const std::vector<LinkVertex>& vertices) {
  Offsets found;
  int count = 0;
  // The first and the last chord have an end that stays.
  for (std::size_t i = 2; i + 1 < vertices.size(); ++i) {
    const Point3& a = vertices[i - 1].place;
    const Point3& b = vertices[i].place;
    for (int k = 0; k < 500; ++k) {
      const Point3 p = a + (k + 0.5) / 500 * (b - a);
      const double off = (p.y() - parabola.y(p.x())) / std::hypot(1, parabola.slope(p.x()));
      found.mean += off;
      found.rms += off * off;
      found.greatest = std::max(found.greatest, std::abs(off));
      ++count;
    }
  }
  found.mean /= count;
  found.rms = std::sqrt(found.rms / count);
  return found;
}

TEST(BalancedChords, LieAsMuchOutsideAsInside) {
  const BsplineCurve curve = kFlatParabola.curve();
  constexpr double kHeight = 0.0005;
  const std::vector<double> x = chord_vertices(curve, 2, 11, {.max_deviation = kHeight});
  std::vector<LinkVertex> on_curve;
  for (const double u : x) on_curve.push_back({curve.point_at(u), u});
  const Offsets plain = offsets_of(kFlatParabola, on_curve);
  const Offsets balanced = offsets_of(kFlatParabola, balanced_chords(curve, x));
  EXPECT_NEAR(plain.rms / plain.greatest, kChordError, 0.02);
  EXPECT_NEAR(balanced.rms / plain.rms, kBalancedError / kChordError, 0.02);
  EXPECT_LT(std::abs(balanced.mean), 0.02 * plain.rms);
  EXPECT_NEAR(balanced.greatest / plain.greatest, 2.0 / 3, 0.02);
}

TEST(BalancedChords, EndsAndCornersStayOnTheCurve) {
  // A corner at u = 1 between two bends.
  const BsplineBasis basis(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2});
  const BsplineCurve curve(
      basis, {{0, 0, 0}, {1, 1, 0}, {2, 1, 0}, {3, 0, 0}, {4, 1, 0}, {5, 1, 0}, {6, 0, 0}});
  const std::vector<double> u = {0, 0.4, 1, 1.6, 2};
  const auto vertices = balanced_chords(curve, u);
  ASSERT_EQ(vertices.size(), u.size());
  for (const std::size_t i : {0u, 2u, 4u}) EXPECT_EQ(vertices[i].place, curve.point_at(u[i]));
  for (const std::size_t i : {1u, 3u}) {
    EXPECT_GT(vertices[i].place.y(), curve.point_at(u[i]).y()) << "outwards";
    EXPECT_EQ(vertices[i].parameter, u[i]);
  }
}

}  // namespace
}  // namespace batten::geometry
