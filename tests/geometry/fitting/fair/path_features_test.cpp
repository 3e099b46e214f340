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

#include "tests/support/paths.h"
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

// Beside edges that are much shorter, blocks that only noise turns were meant as a line; not where
// a vertex is off it by more than can be taken back inside the tolerance.
TEST(PathFeatures, ALineAmongNoiseIsOneBesideShorterEdges) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::vector<Point3> points = noisy_rounding(0.008, seed);
    const std::string lines = "------" + std::string(11, '.') + "------";
    EXPECT_EQ(lines_of(find_features(points, {0.03, 3.2})), lines);
    for (std::size_t i = 1; i <= 6; ++i) points[i].z() = i == 3 ? 0.0145 : 0;
    EXPECT_EQ(lines_of(find_features(points, {0.03, 3.2})), lines);
    EXPECT_NE(lines_of(find_features(points, {0.02, 3.2})), lines);
  }
}

// The chords are of 0.571 mm.
TEST(PathFeatures, ALineHasEdgesThatAreThreeTimesAsLongAsThoseBesideIt) {
  const auto lines = [](double block) {
    return lines_of(find_features(noisy_rounding(0.001, 1, block), {0.03, 3.2}));
  };
  EXPECT_EQ(lines(0.571 * 3.2), "------" + std::string(11, '.') + "------");
  EXPECT_EQ(lines(0.571 * 2.8), std::string(23, '.'));
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

// --- kinks among noise -------------------------------------------------------------------------

struct Chain {
  std::vector<Point3> points;
  std::vector<double> parameters;
};

// Two lines of so many edges of `step` that meet at an angle, in a plane that slants in space.
Chain broken_line(std::size_t before, std::size_t behind, double step, double angle) {
  const Vector3 in = Vector3(2, 1, 2) / 3;
  const Vector3 left = Vector3(-2, 2, 1) / 3;
  Chain chain;
  for (std::size_t i = 0; i <= before + behind; ++i) {
    const double s = step * (static_cast<double>(i) - static_cast<double>(before));
    const Vector3 out = std::cos(angle) * in + std::sin(angle) * left;
    chain.points.emplace_back(s * (s < 0 ? in : out));
    chain.parameters.push_back(s);
  }
  return chain;
}

TEST(Kink, IsTheAngleOfTwoLinesWhereverTheirEndsAre) {
  for (const double degrees : {0.0, 1.0, 20.0, 90.0, 150.0}) {
    for (const std::size_t before : {2, 3, 4, 6, 9}) {
      const Chain chain = broken_line(before, 5, 0.4, degrees * kDegreeOfFeature);
      const auto kink = kink_at(chain.points, chain.parameters, before, 0.01);
      ASSERT_TRUE(kink);
      EXPECT_NEAR(kink->angle, degrees * kDegreeOfFeature, 1e-7) << before;
    }
  }
}

// A cubic, and with six vertices on either side one of the fourth degree, has no kink.
TEST(Kink, IsNoneInABendThatChanges) {
  for (const std::size_t beside : {4, 6}) {
    Chain chain;
    for (std::size_t i = 0; i <= 2 * beside; ++i) {
      const double x = 0.5 * (static_cast<double>(i) - static_cast<double>(beside));
      const double fourth = beside == 6 ? 0.01 * std::pow(x, 4) : 0;
      chain.points.emplace_back(x, 0.3 * x * x - 0.05 * std::pow(x, 3) + fourth, 0);
      chain.parameters.push_back(x);
    }
    const auto kink = kink_at(chain.points, chain.parameters, beside, 0.01);
    ASSERT_TRUE(kink);
    EXPECT_LE(kink->angle, 1e-7);
  }
}

// Noise across a straight line, in one direction: the angle is the amount of a normal variable,
// whose mean square is the square of its standard deviation.
TEST(Kink, OfNoiseAloneIsAsGreatAsItSays) {
  for (const std::size_t beside : {3, 4, 5, 6}) {
    const Chain line = broken_line(beside, beside, 0.5, 0);
    std::mt19937 random(7);
    std::normal_distribution<double> off(0, 0.01);
    double squares = 0;
    double said = 0;
    constexpr int kTimes = 4000;
    for (int k = 0; k < kTimes; ++k) {
      Chain noisy = line;
      for (Point3& p : noisy.points) p += off(random) * Vector3(-2, 2, 1) / 3;
      const auto kink = kink_at(noisy.points, noisy.parameters, beside, 0.01);
      ASSERT_TRUE(kink);
      squares += kink->angle * kink->angle;
      said = kink->deviation;
    }
    // The mean of 4000 squares is known to sqrt(2 / 4000) = 2.2 % (one standard deviation).
    EXPECT_NEAR(std::sqrt(squares / kTimes) / said, 1, 0.05) << beside;
  }
}

TEST(Kink, IsNotKnownAtAnEndNorAmongTooFewVertices) {
  const Chain chain = broken_line(2, 9, 1, 1);
  EXPECT_FALSE(kink_at(chain.points, chain.parameters, 0, 0.01));
  EXPECT_FALSE(kink_at(chain.points, chain.parameters, 11, 0.01));
  EXPECT_TRUE(kink_at(chain.points, chain.parameters, 1, 0.01));
  const Chain few = broken_line(2, 2, 1, 1);
  EXPECT_FALSE(kink_at(few.points, few.parameters, 2, 0.01));
}

// --- noise of vertices ------------------------------------------------------------------------

std::vector<double> noise_of(const std::vector<Point3>& points) {
  return find_features(points, {}).noise;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// A line or an arc of radius 40, a vertex per mm, each moved across the path by normal noise.
std::vector<Point3> noisy_line_or_arc(bool arc, double deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  std::vector<Point3> points;
  for (int i = 0; i < 200; ++i) {
    if (arc) {
      const double r = 40 + normal(random);
      points.emplace_back(r * std::cos(i / 40.0), r * std::sin(i / 40.0), 0);
    } else {
      points.emplace_back(i, normal(random), 0);
    }
  }
  return points;
}

TEST(VertexNoise, IsThatOfWhiteNoiseWithinThirtyPercent) {
  for (const bool arc : {false, true}) {
    for (const double deviation : {1e-5, 0.001, 0.03}) {
      for (unsigned seed = 1; seed <= 10; ++seed) {
        SCOPED_TRACE(testing::Message() << arc << " " << deviation << " seed " << seed);
        const double found = median(noise_of(noisy_line_or_arc(arc, deviation, seed)));
        // A circle sampled once per mm leaves a cubic by 1e-7 mm: nothing beside the noise.
        EXPECT_NEAR(found, deviation, 0.3 * deviation);
      }
    }
  }
}

TEST(VertexNoise, IsNothingOnCleanSamplesOfSmoothCurves) {
  constexpr double kRounding = 1e-6;
  for (const auto& points :
       {arc_path(20, 3, 100), helix_path(20, 6, 2, 240), zigzag_line(100, 0.5, 0)}) {
    for (const double noise : noise_of(points)) EXPECT_LE(noise, kRounding);
  }
  std::vector<Point3> uneven;  // steps of 0.2 to 1.8 mm along a sine
  for (double x = 0; x < 80; x += 1 + 0.8 * std::sin(17 * x)) {
    uneven.emplace_back(x, 3 * std::sin(x / 12), 0);
  }
  for (const double noise : noise_of(uneven)) EXPECT_LE(noise, 1e-4);
}

TEST(VertexNoise, IsNotACornerThatStandsAlone) {
  for (const double turn : {0.1, 0.5, 1.5}) {
    std::vector<Point3> points;
    for (int i = -50; i <= 50; ++i) {
      const double angle = i <= 0 ? 0 : turn;
      points.emplace_back(i * std::cos(angle), i * std::sin(angle), 0);
    }
    for (const double noise : noise_of(points)) EXPECT_LE(noise, 1e-9) << turn;
  }
}

// Residuals against the cubic through (-1, 4, 4, -1) / 6 of the neighbours are 8/3 of the
// zig-zag's height; scaled to white noise they are divided by the root of 35/18, and the median
// of products by 0.36.
TEST(VertexNoise, CountsAZigzagThreeTimes) {
  const double expected = 0.03 * (8.0 / 3) / std::sqrt(35.0 / 18 * 0.36);
  const auto noise = noise_of(zigzag_line(100, 0.5, 0.03));
  EXPECT_NEAR(noise[100], expected, 0.01 * expected);
}

TEST(VertexNoise, FollowsAChangeAlongThePath) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 0.01);
  std::vector<Point3> points;
  for (int i = 0; i < 200; ++i) points.emplace_back(i, i < 100 ? 0 : normal(random), 0);
  const auto noise = noise_of(points);
  EXPECT_LE(noise[60], 1e-9);
  EXPECT_GE(noise[140], 0.005);
}

TEST(VertexNoise, NeedsSixVertices) {
  const auto points = zigzag_line(2, 0.5, 0.03);
  ASSERT_EQ(points.size(), 5u);
  EXPECT_EQ(noise_of(points), std::vector<double>(5, 0.0));
  EXPECT_GT(noise_of(zigzag_line(2.5, 0.5, 0.03))[3], 0.0);
}

// --- sagittas: by the lengths of arcs and of the cubic's two bows -------------------------------

constexpr double kTurn = 0.1;  // radians

// Of the middle edge of three of 1 mm.
double middle_bow(double first_turn, double last_turn, double noise) {
  const std::vector<double> turns = {0, std::abs(first_turn), std::abs(last_turn), 0};
  const std::vector<double> noises(4, noise);
  const auto points =
      turtle({{0, 1}, {first_turn / kDegreeOfFeature, 1}, {last_turn / kDegreeOfFeature, 1}});
  return sagittas(points, std::vector<double>{0, 1, 2, 3}, turns, noises)[1];
}

TEST(Sagittas, AreTheHeightOfAnArcThatTurnsAsMuch) {
  const double radius = 0.5 / std::sin(kTurn / 2);
  const double height = radius * (1 - std::cos(kTurn / 2));
  EXPECT_NEAR(middle_bow(kTurn, kTurn, 0), height, 0.01 * height);
}

// With the slopes s and s at its ends the cubic is s t (1 - t) (1 - 2t): s / (6 sqrt 3) at most.
TEST(Sagittas, AreTheGreaterOfTwoWhereTheCurveCrossesTheEdge) {
  const double bow = 0.5 * kTurn / (6 * std::numbers::sqrt3);
  EXPECT_NEAR(middle_bow(kTurn, -kTurn, 0), bow, 0.01 * bow);
  EXPECT_GT(middle_bow(kTurn, -kTurn, kTurn), 2 * bow) << "the turns are noise";
}

}  // namespace
}  // namespace batten::geometry
