#include "geometry/fitting/fair/path_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/surface_programs.h"

namespace batten::geometry {
namespace {

constexpr double kDegreeOfFeature = std::numbers::pi / 180;

// The inner vertices: s smooth, c corner, k kept.
std::string kinds_of(const PathFeatures& features) {
  std::string text;
  for (std::size_t i = 1; i + 1 < features.kinds.size(); ++i) {
    text += "sck"[static_cast<int>(features.kinds[i])];
  }
  return text;
}

std::string lines_of(const PathFeatures& features) {
  std::string text;
  for (const bool line : features.lines) text += line ? '-' : '.';
  return text;
}

// Vertices after turns (degrees) and lengths in turn, in the plane.
std::vector<Point3> turtle(const std::vector<std::pair<double, double>>& steps) {
  std::vector<Point3> points = {Point3::Zero()};
  double heading = 0;
  for (const auto& [turn, length] : steps) {
    heading += turn * kDegreeOfFeature;
    points.push_back(points.back() + length * Vector3(std::cos(heading), std::sin(heading), 0));
  }
  return points;
}

TEST(PathFeatures, MeasureLengthsAndTurns) {
  const auto f = find_features(turtle({{0, 3}, {90, 4}, {-30, 5}}), {});
  const std::vector<double> lengths = {0, 3, 7, 12};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(f.parameters[i], lengths[i], 1e-12);
  EXPECT_NEAR(f.turns[1], 90 * kDegreeOfFeature, 1e-12);
  EXPECT_NEAR(f.turns[2], 30 * kDegreeOfFeature, 1e-12);
  EXPECT_EQ(f.turns[0], 0);
  EXPECT_EQ(f.turns[3], 0);
  EXPECT_EQ(f.kinds.front(), VertexKind::kKeptCorner);
  EXPECT_EQ(f.kinds.back(), VertexKind::kKeptCorner);
}

struct FeatureCase {
  const char* name;
  std::vector<Point3> points;
  FeatureOptions options;
  const char* kinds;
  const char* lines;
};

void PrintTo(const FeatureCase& test, std::ostream* out) { *out << test.name; }

class Features : public testing::TestWithParam<FeatureCase> {};

TEST_P(Features, AreSeenAsADraughtsmanWould) {
  const FeatureCase& test = GetParam();
  const auto f = find_features(test.points, test.options);
  EXPECT_EQ(kinds_of(f), test.kinds);
  EXPECT_EQ(lines_of(f), test.lines);
}

INSTANTIATE_TEST_SUITE_P(
    Path, Features,
    testing::Values(
        FeatureCase{"OneLine", turtle({{0, 10}}), {}, "", "-"},
        FeatureCase{"ACorner", turtle({{0, 10}, {90, 10}}), {}, "c", "--"},
        FeatureCase{"AReversalIsKept", turtle({{0, 10}, {175, 10}}), {}, "k", "--"},
        FeatureCase{"AKeptTurn",
                    turtle({{0, 10}, {50, 10}, {40, 10}}),
                    {0.01, 45 * kDegreeOfFeature},
                    "kc",
                    "---"},
        FeatureCase{
            "AGentleTurnIsNoCorner", turtle({{0, 1}, {1, 1}, {1, 1}, {1, 1}}), {}, "sss", "...."},
        // Chords of 10 degrees and 1 mm leave the arc by 1 * 10 deg / 8 = 0.022: a CAM system that
        // wrote them at 0.02 meant the arc, one that works to 0.001 did not.
        FeatureCase{"CoarseChordsOfAWideTolerance",
                    turtle({{0, 1}, {10, 1}, {10, 1}, {10, 1}}),
                    {0.02, 3.2},
                    "sss",
                    "...."},
        FeatureCase{"CoarseChordsOfATightTolerance",
                    turtle({{0, 1}, {10, 1}, {10, 1}, {10, 1}}),
                    {0.001, 3.2},
                    "ccc",
                    "----"},
        // A line that ends in an arc of chords a seventh as long.
        FeatureCase{"ALineIntoAnArc",
                    turtle({{0, 7}, {1.5, 1}, {3, 1}, {3, 1}, {3, 1}}),
                    {},
                    "ssss",
                    "-...."}),
    [](const auto& test) { return test.param.name; });

TEST(PathFeatures, ACircleIsSmoothThroughout) {
  const auto f = find_features(circle_path(20, 200), {});
  EXPECT_EQ(kinds_of(f), std::string(199, 's'));
  EXPECT_EQ(lines_of(f), std::string(200, '.'));
}

// A corner among chords of an arc turns more than four times as much as they.
TEST(PathFeatures, ACornerInAnArcStandsOut) {
  std::vector<std::pair<double, double>> steps(25, {3, 1});
  steps[12].first = 30;
  const auto f = find_features(turtle(steps), {0.02, 3.2});
  EXPECT_EQ(kinds_of(f), std::string(11, 's') + "c" + std::string(12, 's'));
}

// Chords of 0.2 mm round a hairpin of radius 0.28 mm: nearly all of its turn is in two vertices,
// but it comes and goes gradually. Where it comes at once it is a corner.
TEST(PathFeatures, AHairpinInFewChordsIsNoCorner) {
  const auto kinds = [](const std::vector<double>& turns) {
    std::vector<std::pair<double, double>> steps;
    for (const double turn : turns) steps.emplace_back(turn, 0.2);
    FeatureOptions options;
    options.tolerance = 0.025;
    return kinds_of(find_features(turtle(steps), options));
  };
  EXPECT_EQ(kinds({0, 1, 1, 2, 2, 5, 11, 39, 45, 18, 5, 2, 2, 1, 1}), "ssssssssssssss");
  EXPECT_EQ(kinds({0, 1, 1, 2, 2, 2, 2, 5, 45, 5, 2, 2, 2, 1, 1}), "ssssssscssssss");
  EXPECT_EQ(kinds({0, 1, 1, 2, 2, -5, -11, 39, 45, 18, 5, 2, 2, 1, 1}), "ssssssscssssss");
}

TEST(PathFeatures, NoiseMakesNoCornersAndNoLines) {
  const auto f = find_features(zigzag_line(100, 0.5, 0.03), {0.05, 3.2});
  EXPECT_EQ(kinds_of(f), std::string(199, 's'));
  EXPECT_EQ(lines_of(f), std::string(200, '.'));
}

TEST(PathFeatures, NoiseIsSmoothThoughItTurnsMoreThanCorners) {
  const auto f = find_features(noisy_half_circle(20, 400, 0.03), {0.05, 3.2});
  EXPECT_GT(f.turns[200], 30 * kDegreeOfFeature);
  EXPECT_EQ(kinds_of(f), std::string(399, 's'));
}

// Noise that is up to five times the tolerance, 13,000 vertices. With what one vertex turns by
// alone, one of 36 was a corner.
TEST(PathFeatures, NoiseBeyondTheToleranceMakesHardlyAnyCorner) {
  std::size_t corners = 0;
  std::size_t vertices = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    for (const double cam : {0.002, 0.005, 0.01}) {
      for (const auto& row : surface_rows(cam, 0.02, seed)) {
        const std::string kinds = kinds_of(find_features(row, {2 * cam, 3.2, 0.0005}));
        corners += kinds.size() - static_cast<std::size_t>(std::ranges::count(kinds, 's'));
        vertices += kinds.size();
      }
    }
  }
  EXPECT_GT(vertices, 10000U);
  EXPECT_LE(corners, vertices / 5000);
}

// Corners of a polygon, its sides in steps of 0.4 mm, normal noise across them.
struct NoisyPolygon {
  std::vector<Point3> points;
  std::string kinds;
};

NoisyPolygon noisy_polygon(double turn_degrees, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> off(0, noise);
  NoisyPolygon polygon{{Point3::Zero()}, ""};
  Point3 corner = Point3::Zero();
  for (int side = 0; side < 4; ++side) {
    const double heading = side * turn_degrees * kDegreeOfFeature;
    const Vector3 along(std::cos(heading), std::sin(heading), 0);
    constexpr int kEdges = 50;
    for (int i = 1; i <= kEdges; ++i) {
      const Vector3 across(-along.y(), along.x(), 0);
      const bool end = i == kEdges;
      polygon.points.emplace_back(corner + 0.4 * i * along + (end ? 0 : off(random)) * across);
      polygon.kinds += end ? 'c' : 's';
    }
    corner = polygon.points.back();
  }
  polygon.kinds.pop_back();
  return polygon;
}

TEST(PathFeatures, CornersStandOutAgainstNoiseBeyondTheTolerance) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    for (const double turn : {35.0, 60.0, 90.0, 135.0}) {
      const NoisyPolygon polygon = noisy_polygon(turn, 0.01, seed);
      const auto f = find_features(polygon.points, {0.004, 3.2, 0.0005});
      EXPECT_EQ(kinds_of(f), polygon.kinds) << turn;
    }
  }
}

// Stairs scatter by more than the tolerance too, but noise would not turn them so.
TEST(PathFeatures, StairsAreNoNoise) {
  const auto f = find_features(staircase_path(40, 1), {});
  EXPECT_EQ(kinds_of(f), std::string(40, 'c'));
}

}  // namespace
}  // namespace batten::geometry
