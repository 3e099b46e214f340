#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/distance/band_comparison.h"
#include "geometry/distance/path_distance.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

double greatest_distance(const PathMatching& matching) {
  double greatest = 0;
  for (const PlacePair& pair : matching.pairs) {
    greatest = std::max(greatest, (pair.a - pair.b).norm());
  }
  return greatest;
}

bool passes(const std::vector<PlacePair>& pairs, Point3 PlacePair::*side, const Point3& place) {
  return std::ranges::any_of(
      pairs, [&](const PlacePair& pair) { return (pair.*side - place).norm() < 1e-12; });
}

TEST(PathMatching, IsTheCertificateOfTheComparison) {
  const Path noisy = path_through(noisy_half_circle(10, 300, 0.004));
  const Path smooth = {Arc{Point3(10, 0, 0), Point3(-10, 0, 0), Point3(0, 0, 0), Vector3(0, 0, 1),
                           std::numbers::pi}};
  const double tolerance = 0.01;
  const PathMatching matching = match_paths(noisy, smooth, tolerance);
  const PathComparison compared = compare_paths(noisy, smooth, tolerance);
  ASSERT_EQ(compared.verdict, Verdict::kProved);
  EXPECT_EQ(matching.comparison.bounds.at_most, compared.bounds.at_most);
  EXPECT_EQ(matching.pairs.size(), compared.certificate_size);
  EXPECT_LE(greatest_distance(matching), compared.bounds.at_most);
  // The chords of the arc are within 0.5 % of the tolerance, and count once for each side.
  EXPECT_GE(greatest_distance(matching), compared.bounds.at_most - 0.01 * tolerance);
}

TEST(PathMatching, PassesEveryEndOfAPieceOnBothPaths) {
  const std::vector<Point3> vertices = zigzag_line(10, 0.5, 0.004);
  const Path zigzag = path_through(vertices);
  const std::vector<Point3> ends = {Point3(0, 0, 0), Point3(3.3, 0, 0), Point3(10, 0, 0)};
  const PathMatching matching = match_paths(zigzag, path_through(ends), 0.01);
  for (const Point3& vertex : vertices) EXPECT_TRUE(passes(matching.pairs, &PlacePair::a, vertex));
  for (const Point3& end : ends) EXPECT_TRUE(passes(matching.pairs, &PlacePair::b, end));
}

TEST(PathMatching, GoesForwardOnBothPaths) {
  const Path before = path_through(zigzag_line(10, 0.5, 0.004));
  const Path after = path_through(zigzag_line(10, 0.7, 0.003));
  const auto pairs = match_paths(before, after, 0.01).pairs;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    EXPECT_GE(pairs[i].piece_a, pairs[i - 1].piece_a);
    EXPECT_GE(pairs[i].piece_b, pairs[i - 1].piece_b);
    EXPECT_GE(pairs[i].a.x(), pairs[i - 1].a.x());  // both go along x
    EXPECT_GE(pairs[i].b.x(), pairs[i - 1].b.x());
  }
}

TEST(PathMatching, HasNoPairsWithoutPaths) { EXPECT_TRUE(match_paths({}, {}, 0.01).pairs.empty()); }

TEST(PathMatching, OfAPathThatWaitsIsWhereItWaits) {
  const Path line = {Line{Point3(0, 0, 0), Point3(0.001, 0, 0)}};
  const PathMatching matching = match_paths(line, {}, 0.01);
  ASSERT_FALSE(matching.pairs.empty());
  for (const PlacePair& pair : matching.pairs) EXPECT_EQ(pair.b, Point3(0, 0, 0));
}

// A right angle that is cut by a line at 45 degrees, 0.9 tolerances from the legs' band border: the
// corner is sqrt(2) * 0.9 tolerances from the middle of the cut.
TEST(BandMatching, GoesRoundACornerThatIsCut) {
  const double tolerance = 0.1;
  const double off = 0.9 * tolerance;  // of the middle of the cut, from both legs
  const Path corner =
      path_through(std::vector<Point3>{Point3(-5, 0, 0), Point3(0, 0, 0), Point3(0, 5, 0)});
  const Path cut = path_through(std::vector<Point3>{Point3(-5, 0, 0), Point3(-2 * off, 0, 0),
                                                    Point3(0, 2 * off, 0), Point3(0, 5, 0)});
  const BandComparison compared = compare_in_band(corner, cut, tolerance);
  ASSERT_EQ(compared.paths.verdict, Verdict::kProved);
  ASSERT_EQ(compared.cut_corners, 1U);
  const PathMatching matching = match_in_band(corner, cut, tolerance);
  EXPECT_EQ(matching.comparison.bounds.at_most, compared.paths.bounds.at_most);
  EXPECT_TRUE(passes(matching.pairs, &PlacePair::a, Point3(0, 0, 0)));
  EXPECT_NEAR(greatest_distance(matching), std::sqrt(2.0) * off, 1e-6);
}

TEST(BandMatching, IsTheStrictOneWhereNoCornerIsCut) {
  const Path before = path_through(zigzag_line(10, 0.5, 0.004));
  const Path after = path_through(std::vector<Point3>{Point3(0, 0, 0), Point3(10, 0, 0)});
  EXPECT_EQ(match_in_band(before, after, 0.01).pairs.size(),
            match_paths(before, after, 0.01).pairs.size());
}

}  // namespace
}  // namespace batten::geometry
