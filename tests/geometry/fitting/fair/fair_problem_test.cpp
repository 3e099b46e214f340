#include "geometry/fitting/fair/fair_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/fitting/fair/path_features.h"

namespace batten::geometry {
namespace {

// --- sagittas: by the lengths of arcs and of the cubic's two bows -------------------------------

constexpr double kTurn = 0.1;  // radians

// Vertices behind edges of 1 mm that turn by these angles, in the plane.
std::vector<Point3> bent(const std::vector<double>& turns) {
  std::vector<Point3> points = {Point3::Zero(), Point3::UnitX()};
  double heading = 0;
  for (const double turn : turns) {
    heading += turn;
    points.push_back(points.back() + Vector3(std::cos(heading), std::sin(heading), 0));
  }
  return points;
}

// Of the middle edge of three.
double middle_bow(double first_turn, double last_turn, double noise) {
  const std::vector<double> turns = {0, std::abs(first_turn), std::abs(last_turn), 0};
  const std::vector<double> noises(4, noise);
  return sagittas(bent({first_turn, last_turn}), std::vector<double>{0, 1, 2, 3}, turns, noises)[1];
}

TEST(EdgeBows, AreTheHeightOfAnArcThatTurnsAsMuch) {
  const double radius = 0.5 / std::sin(kTurn / 2);
  const double height = radius * (1 - std::cos(kTurn / 2));
  EXPECT_NEAR(middle_bow(kTurn, kTurn, 0), height, 0.01 * height);
}

// With the slopes s and s at its ends the cubic is s t (1 - t) (1 - 2t): s / (6 sqrt 3) at most.
TEST(EdgeBows, AreTheGreaterOfTwoWhereTheCurveCrossesTheEdge) {
  const double bow = 0.5 * kTurn / (6 * std::numbers::sqrt3);
  EXPECT_NEAR(middle_bow(kTurn, -kTurn, 0), bow, 0.01 * bow);
  EXPECT_GT(middle_bow(kTurn, -kTurn, kTurn), 2 * bow) << "the turns are noise";
}

// --- restate_samples: against the problem stated anew --------------------------------------------

// A wave with corners, long lines and some noise.
std::vector<Point3> path(std::mt19937& random) {
  std::normal_distribution<double> noise(0, 1e-3);
  std::vector<Point3> points;
  double x = 0;
  for (int i = 0; i < 400; ++i) {
    x += i % 97 == 40 ? 5 : 0.4;
    const double corner = i % 61 == 30 ? 0.7 : 0;
    points.emplace_back(x, std::sin(0.2 * x) + corner + noise(random), noise(random));
  }
  return points;
}

void expect_same(const std::vector<FitSample>& a, const std::vector<FitSample>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].parameter, b[i].parameter) << i;
    EXPECT_EQ(a[i].target, b[i].target) << i;
    EXPECT_EQ(a[i].along, b[i].along) << i;
    EXPECT_EQ(a[i].limit, b[i].limit) << i;
    EXPECT_EQ(a[i].scatter, b[i].scatter) << i;
  }
}

TEST(RestateSamples, GivesThoseOfTheProblemStatedAnew) {
  std::mt19937 random(7);
  const std::vector<Point3> points = path(random);
  PathFeatures features = find_features(points, {0.01, 3.2, 5e-4});
  // Behind them edges are watched as the smooth vertex before them says.
  for (std::size_t i = 20; i < points.size(); i += 23) {
    features.kinds[i] = VertexKind::kKeptCorner;
  }
  ASSERT_TRUE(std::ranges::count(features.kinds, VertexKind::kCorner) > 0);
  const BandOptions options;
  std::vector<double> loosen(points.size(), 1);
  std::vector<EdgeRefinement> care(points.size() - 1);
  FitProblem problem = state_fair_problem(points, features, loosen, care, options);
  std::uniform_int_distribution<std::size_t> edges(0, care.size() - 1);
  for (int round = 0; round < 300; ++round) {
    std::vector<std::size_t> changed;
    for (int k = 0; k < 4; ++k) {
      const std::size_t edge = edges(random);
      if (k % 2 == 0) {
        care[edge].share *= 0.95;
        care[edge].violations += 1;
        changed.push_back(edge + 1);
      } else {
        loosen[edge] =
            loosen[edge] > 60 ? std::numeric_limits<double>::infinity() : 4 * loosen[edge];
      }
      changed.push_back(edge);
    }
    std::ranges::sort(changed);
    restate_samples(points, features, loosen, care, options, changed, problem);
    expect_same(problem.samples,
                state_fair_problem(points, features, loosen, care, options).samples);
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace batten::geometry
