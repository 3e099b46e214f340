#include "geometry/distance/band_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "geometry/fitting/corners/guo_corner.h"
#include "tests/support/corners.h"
#include "tests/support/method_cases.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

std::vector<Point3> legs(double half_angle_degrees, double length = 10) {
  const Corner corner = corner_of(half_angle_degrees, length, length);
  return {corner.before, corner.vertex, corner.after};
}

Path blended(const std::vector<Point3>& points, double tolerance) {
  GuoOptions options;
  options.tolerance = tolerance;
  options.kind = ToleranceKind::kBand;
  return guo_path(points, options).pieces;
}

// Guo's blend uses all of the band: sin(half) times the way from corner to apex is the tolerance.
TEST(CompareInBand, ProvesABlendThatUsesAllOfTheBand) {
  for (const double half : {11.0, 18.0, 30.0, 45.0, 60.0, 80.0}) {
    SCOPED_TRACE(testing::Message() << half << " degrees");
    const std::vector<Point3> points = legs(half);
    const Path old_path = path_through(points);
    const Path new_path = blended(points, 0.1);
    const BandComparison found = compare_in_band(old_path, new_path, 0.101);
    EXPECT_EQ(found.paths.verdict, Verdict::kProved);
    EXPECT_LE(found.paths.bounds.at_most, 0.101);
    EXPECT_EQ(found.cut_corners, 1u);
    EXPECT_NEAR(found.corner_at_most, 0.1 / std::sin(half * kDegrees), 1e-6);
    if (half < 75) {
      EXPECT_EQ(compare_paths(old_path, new_path, 0.101).verdict, Verdict::kBroken);
    }
    EXPECT_NE(compare_in_band(old_path, new_path, 0.099).paths.verdict, Verdict::kProved)
        << "the blend leaves the band by a percent";
  }
}

TEST(CompareInBand, ProvesWholePathsOfCutCorners) {
  for (const auto& points : {star_path(), guo_hexagon(), guo_butterfly(), staircase_path(40, 1)}) {
    const Path old_path = path_through(points);
    const BandComparison found = compare_in_band(old_path, blended(points, 0.05), 0.051);
    EXPECT_EQ(found.paths.verdict, Verdict::kProved) << found.paths.bounds.at_most;
    EXPECT_GT(found.cut_corners, 3u);
    EXPECT_LE(found.corner_at_most, 0.051 / std::sin(10 * kDegrees));
  }
}

// Where no corner is cut it is the strict comparison, to the last digit.
TEST(CompareInBand, IsTheStrictComparisonWhereNoCornerIsCut) {
  const std::vector<Point3> points = staircase_path(20, 1);
  std::vector<Point3> shifted;
  for (const Point3& p : points) shifted.push_back(p + Vector3(0.01, 0, 0));
  const Path old_path = path_through(points);
  const Path new_path = path_through(shifted);
  EXPECT_EQ(compare_in_band(old_path, new_path, 0.01).paths.verdict, Verdict::kProved);
  EXPECT_EQ(compare_in_band(old_path, new_path, 0.01).cut_corners, 0u);
  EXPECT_EQ(compare_in_band(old_path, old_path, 0.01).paths.bounds.at_most, 0);
}

// A straight chord across a square corner, so far inside that its middle is at the given distance
// from both legs.
std::vector<Point3> chord_across(double from_legs) {
  const double along = 2 * from_legs;
  return {{-10, 0, 0}, {-along, 0, 0}, {0, along, 0}, {0, 10, 0}};
}

TEST(CompareInBand, RefusesACornerCutTooDeep) {
  const Path old_path = path_through(std::vector<Point3>{{-10, 0, 0}, {0, 0, 0}, {0, 10, 0}});
  EXPECT_EQ(compare_in_band(old_path, path_through(chord_across(0.099)), 0.1).paths.verdict,
            Verdict::kProved);
  EXPECT_NE(compare_in_band(old_path, path_through(chord_across(0.101)), 0.1).paths.verdict,
            Verdict::kProved);
  // Beyond the miter it is certain: 0.1 sqrt(2) from the vertex, 0.15 sqrt(2) is met.
  const auto deep = compare_in_band(old_path, path_through(chord_across(0.15)), 0.1);
  EXPECT_EQ(deep.paths.verdict, Verdict::kBroken);
  EXPECT_GT(deep.paths.bounds.at_least, 0.1);
}

// The tip is 0.1 / sin(5 deg) = 1.15 away: within what the formula would allow, but such corners
// are held to the strict reading.
TEST(CompareInBand, HoldsVerySharpCornersToTheStrictReading) {
  const std::vector<Point3> points = legs(5);
  EXPECT_NE(compare_in_band(path_through(points), blended(points, 0.1), 0.101).paths.verdict,
            Verdict::kProved);
  const std::vector<Point3> wider = legs(10.5);
  EXPECT_EQ(compare_in_band(path_through(wider), blended(wider, 0.1), 0.101).paths.verdict,
            Verdict::kProved);
}

// Two rows 0.05 apart that meet at a point: leaving out both would stay in the band of either.
TEST(CompareInBand, DoesNotLetTwoRowsVanish) {
  const Path old_path =
      path_through(std::vector<Point3>{{0, 0, 0}, {10, 0.025, 0}, {0, 0.05, 0}, {0, 10, 0}});
  const Path new_path = path_through(std::vector<Point3>{{0, 0, 0}, {0, 10, 0}});
  EXPECT_EQ(compare_in_band(old_path, new_path, 0.1).paths.verdict, Verdict::kBroken);
}

// Everything that is wrong with a path must show, whatever is allowed at its corners.
TEST(CompareInBand, FindsWhatIsWrong) {
  const std::vector<Point3> points = star_path();
  const Path old_path = path_through(points);
  const Path good = blended(points, 0.05);
  ASSERT_EQ(compare_in_band(old_path, good, 0.051).paths.verdict, Verdict::kProved);
  const auto refused = [&](const Path& path) {
    return compare_in_band(old_path, path, 0.051).paths.verdict != Verdict::kProved;
  };
  std::vector<Point3> moved = points;
  for (Point3& p : moved) p += Vector3(0.056, 0, 0);
  EXPECT_TRUE(refused(path_through(moved))) << "shifted by 1.1 tolerances";
  std::vector<Point3> missing = points;
  missing.erase(missing.begin() + 4);
  EXPECT_TRUE(refused(path_through(missing))) << "a corner left out";
  std::vector<Point3> swapped = points;
  std::swap(swapped[3], swapped[5]);
  EXPECT_TRUE(refused(path_through(swapped))) << "two corners in the wrong order";
  const Path half(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2));
  EXPECT_TRUE(refused(half)) << "half of it left out";
  Path twice = good;
  twice.insert(twice.end(), good.begin(), good.end());
  EXPECT_TRUE(refused(twice)) << "run twice";
  const std::vector<Point3> back(points.rbegin(), points.rend());
  EXPECT_TRUE(refused(path_through(back))) << "run backwards";
  EXPECT_TRUE(refused({})) << "nothing";
}

// A random path in space, blended within the band and then moved about by `noise`: proved when
// both together are within the tolerance, and never when the noise alone is above it.
TEST(CompareInBand, ProvesWhatIsInsideAndNeverWhatIsOutside) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> length(0.5, 5);
    std::vector<Point3> points = {Point3::Zero()};
    Vector3 direction(1, 0, 0);
    for (int i = 0; i < 20; ++i) {
      direction =
          (direction + 0.8 * Vector3(normal(random), normal(random), normal(random))).normalized();
      points.push_back(points.back() + length(random) * direction);
    }
    GuoOptions options;
    options.tolerance = 0.03;
    options.kind = ToleranceKind::kBand;
    options.strict_sharper_than = kSharpestCut;
    const Path blends = guo_path(points, options).pieces;
    const auto moved = [&](double noise) {
      const Vector3 off =
          noise * Vector3(normal(random), normal(random), normal(random)).normalized();
      Path path;
      for (const PathPiece& piece : blends) {
        if (const auto* line = std::get_if<Line>(&piece)) {
          path.push_back(Line{line->start + off, line->end + off});
        } else {
          CubicBezier bezier = std::get<CubicBezier>(piece);
          for (Point3& p : bezier.control) p += off;
          path.push_back(bezier);
        }
      }
      return path;
    };
    const Path old_path = path_through(points);
    EXPECT_EQ(compare_in_band(old_path, moved(0.005), 0.0365).paths.verdict, Verdict::kProved);
    EXPECT_NE(compare_in_band(old_path, moved(0.0366), 0.0365).paths.verdict, Verdict::kProved);
  }
}

TEST(CompareInBand, RefusesAToleranceThatIsNone) {
  const Path path = path_through(legs(45));
  EXPECT_THROW((void)compare_in_band(path, path, 0), std::invalid_argument);
  EXPECT_THROW((void)compare_in_band(path, path, -1), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
