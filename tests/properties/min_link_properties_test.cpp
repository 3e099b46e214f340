#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "geometry/chords/linearize.h"
#include "geometry/chords/min_link.h"
#include "geometry/distance/path_distance.h"
#include "tests/support/paths.h"
#include "tests/support/processor_time.h"

namespace batten::geometry {
namespace {

// The proof of path_distance may be this part of the tolerance too great.
constexpr double kProofLooseness = 1.021;

// Control points a few units apart whose direction turns to both sides, in the plane or in space;
// every fourth curve has a straight part in its middle.
BsplineCurve random_min_link_curve(int seed, int spans, bool in_plane, double size) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> breakpoints = {0};
  for (int i = 0; i < spans; ++i) breakpoints.push_back(breakpoints.back() + 1.5 + uniform(random));
  std::vector<Point3> points = {Point3(uniform(random), uniform(random), 0)};
  double heading = 3 * uniform(random);
  double turning = 0;
  double climb = 0;
  for (int i = 0; i < spans + 2; ++i) {
    const bool straight = seed % 4 == 0 && 3 * i > spans && 3 * i < 2 * spans;
    if (!straight) {
      turning = 0.7 * turning + 0.35 * uniform(random);
      heading += turning;
      climb += in_plane ? 0 : 0.4 * uniform(random);
    }
    const double step = 2 + uniform(random);
    points.push_back(points.back() + step * Vector3(std::cos(heading), std::sin(heading), climb));
  }
  for (Point3& p : points) p *= size;
  return {BsplineBasis::clamped(3, breakpoints), points};
}

Path as_path(const std::vector<LinkVertex>& vertices) {
  Path path;
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    path.push_back(Line{vertices[i - 1].place, vertices[i].place});
  }
  return path;
}

std::size_t greedy_count(const BsplineCurve& curve, double tolerance) {
  const ChordOptions options{.max_deviation = tolerance};
  return chord_vertices(curve, curve.first(), curve.last(), options).size() - 1;
}

TEST(MinLinkVertices, KeepTheToleranceBothWaysInOrderOnRandomCurves) {
  constexpr int kCurves = 70;
  std::size_t links = 0;
  std::size_t chords = 0;
  for (int seed = 0; seed < kCurves; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const double size = std::pow(10.0, seed % 7 - 3);
    const BsplineCurve curve = random_min_link_curve(seed, 14, seed % 2 == 0, size);
    const double tolerance = size * std::pow(10.0, -1 - seed % 3);
    const MinLinkOptions options{.tolerance = tolerance, .balanced = seed % 5 != 0};
    const auto vertices = min_link_vertices(curve, curve.first(), curve.last(), options);
    EXPECT_EQ(vertices.front().place, curve.point_at(curve.first()));
    EXPECT_EQ(vertices.back().place, curve.point_at(curve.last()));
    EXPECT_TRUE(std::ranges::is_sorted(vertices, {}, &LinkVertex::parameter));
    const PathComparison compared =
        compare_paths(beziers_of(curve), as_path(vertices), kProofLooseness * tolerance);
    EXPECT_EQ(compared.verdict, Verdict::kProved);
    EXPECT_LE(compared.bounds.at_least, tolerance * (1 + 1e-9));
    const std::size_t greedy = greedy_count(curve, tolerance);
    EXPECT_LE(vertices.size() - 1, greedy);
    links += vertices.size() - 1;
    chords += greedy;
  }
  // 1 / sqrt(2) where links are many; corners of bends and ends cost a little.
  EXPECT_LE(static_cast<double>(links), 0.76 * static_cast<double>(chords));
}

// Control points in any direction, hairpins and all: most bends are closer than the tolerance, and
// gates would cross each other.
TEST(MinLinkVertices, KeepTheToleranceWhereItIsAboveTheRadius) {
  constexpr int kCurves = 20;
  for (int seed = 0; seed < kCurves; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<double> breakpoints = {0};
    std::vector<Point3> points;
    for (int i = 0; i < 25; ++i) {
      const double height = seed % 2 == 0 ? 0 : uniform(random);
      points.emplace_back(0.2 * i + uniform(random), uniform(random), height);
    }
    for (std::size_t i = 0; i + 3 < points.size(); ++i)
      breakpoints.push_back(breakpoints.back() + 1);
    const BsplineCurve curve(BsplineBasis::clamped(3, breakpoints), points);
    for (const double tolerance : {0.5, 0.1, 0.02}) {
      const auto vertices =
          min_link_vertices(curve, curve.first(), curve.last(), {.tolerance = tolerance});
      const PathComparison compared =
          compare_paths(beziers_of(curve), as_path(vertices), kProofLooseness * tolerance);
      EXPECT_NE(compared.verdict, Verdict::kBroken);
      EXPECT_LE(compared.bounds.at_least, tolerance * (1 + 1e-9));
      EXPECT_LE(vertices.size() - 1, greedy_count(curve, tolerance));
    }
  }
}

TEST(MinLinkVertices, AreFewerAlsoInPlaceOfAPart) {
  for (int seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = random_min_link_curve(seed, 12, seed % 2 == 0, 1);
    const double from = 0.7;
    const double to = curve.last() - 0.9;
    const auto vertices = min_link_vertices(curve, from, to, {.tolerance = 1e-3});
    EXPECT_EQ(vertices.front().parameter, from);
    EXPECT_EQ(vertices.back().parameter, to);
    const PathComparison compared =
        compare_paths(beziers_of(curve.part(from, to)), as_path(vertices), kProofLooseness * 1e-3);
    EXPECT_EQ(compared.verdict, Verdict::kProved);
  }
}

TEST(MinLinkVertices, GrowInNumberWithTheSquareRootOfTheFineness) {
  for (int seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = random_min_link_curve(4 * seed + 1, 14, seed % 2 == 0, 10);
    const auto count = [&](double tolerance) {
      const MinLinkOptions options{.tolerance = tolerance, .balanced = false};
      return static_cast<double>(
          min_link_vertices(curve, curve.first(), curve.last(), options).size() - 1);
    };
    EXPECT_NEAR(count(1e-4) / count(1e-2), 10, 0.5);
  }
}

double seconds_of_min_link(const BsplineCurve& curve) {
  return least_processor_seconds(3, [&] {
    EXPECT_GT(min_link_vertices(curve, curve.first(), curve.last(), {.tolerance = 0.01}).size(),
              1U);
  });
}

// Four times the spans cost four times the work when it is linear, sixteen times when quadratic.
TEST(MinLinkVertices, CostAboutLinearInTheSpans) {
  for (const bool in_plane : {true, false}) {
    const double of_few = seconds_of_min_link(random_min_link_curve(1, 100, in_plane, 1));
    const double of_many = seconds_of_min_link(random_min_link_curve(1, 400, in_plane, 1));
    EXPECT_LT(of_many, 8 * of_few) << of_few << " s, " << of_many << " s";
  }
}

}  // namespace
}  // namespace batten::geometry
