#include "geometry/arcs/circle_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace batten::geometry {
namespace {

constexpr double kLimit = 0.01;

struct Round {
  Point2 center = Point2(20, -7);
  double radius = 10;
  double start = 0.3;
  double sweep = 2 * kPi;
  int edges = 100;
  int decimals = 9;

  [[nodiscard]] Point2 at(int i) const {
    const double angle = start + sweep * i / edges;
    const Point2 p = center + radius * Point2(std::cos(angle), std::sin(angle));
    const double unit = std::pow(10.0, decimals);
    return (p * unit).array().round() / unit;
  }

  [[nodiscard]] std::vector<Point2> points() const {
    std::vector<Point2> all;
    for (int i = 0; i <= edges; ++i) all.push_back(at(i));
    return all;
  }
};

TEST(FitCircle, FindsACircleFromAnyPartOfIt) {
  std::mt19937 chance(3);
  std::uniform_real_distribution<double> of_place(-500, 500);
  std::uniform_real_distribution<double> of_angle(-kPi, kPi);
  std::uniform_real_distribution<double> of_size(0, 1);
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    Round round{{of_place(chance), of_place(chance)}, 0.5 + 60 * of_size(chance), of_angle(chance)};
    round.sweep = (i % 2 == 0 ? 1 : -1) * (i % 5 == 0 ? 2 * kPi : 0.2 + 6 * of_size(chance));
    const auto circle = fit_circle(round.points(), {0.2, 0.2});
    ASSERT_TRUE(circle);
    EXPECT_NEAR((circle->center - round.center).norm(), 0, 1e-4);
    EXPECT_NEAR(circle->radius, round.radius, 1e-4);
    EXPECT_LE(circle->rms, 1e-8);
    EXPECT_NEAR(circle->angles.back(), round.sweep, 1e-4);
  }
}

// The ends are met, and the others are off by what their decimals make and what those of the ends.
TEST(FitCircle, IsNearestToRoundedPoints) {
  for (const double sweep : {2 * kPi, -2 * kPi, 1.0, -4.0}) {
    for (const int edges : {100, 400, 1500}) {
      Round round{.sweep = sweep, .edges = edges, .decimals = 3};
      const std::vector<Point2> points = round.points();
      const auto circle = fit_circle(points, {kLimit, kLimit});
      ASSERT_TRUE(circle);
      EXPECT_NEAR((points.back() - circle->center).norm(), circle->radius, 1e-9);
      EXPECT_LT((circle->center - round.center).norm(), std::abs(sweep) < 2 ? 0.006 : 0.0012);
      for (const Point2& p : points) {
        EXPECT_NEAR((circle->center - p).norm(), circle->radius, 0.0015);
      }
      double all = 0;
      for (const Point2& p : points) {
        all += std::pow((circle->center - p).norm() - circle->radius, 2);
      }
      EXPECT_NEAR(circle->rms, std::sqrt(all / static_cast<double>(points.size())), 1e-12);
      // Of no other centre that passes the first point the squares are less.
      const auto squares = [&](const Point2& center) {
        double sum = 0;
        const double radius = (center - points.front()).norm();
        for (const Point2& p : points) sum += std::pow((center - p).norm() - radius, 2);
        return sum;
      };
      if (std::abs(sweep) < 6) continue;
      for (const Point2& off :
           {Point2(1e-4, 0), Point2(-1e-4, 0), Point2(0, 1e-4), Point2(0, -1e-4)}) {
        EXPECT_LT(squares(circle->center), squares(circle->center + off));
      }
    }
  }
}

TEST(FitCircle, IsNothingOfOtherPaths) {
  const auto is_circle = [](const std::vector<Point2>& points) {
    return fit_circle(points, {kLimit, kLimit}).has_value();
  };
  const std::vector<Point2> round = Round{}.points();
  ASSERT_TRUE(is_circle(round));
  EXPECT_FALSE(is_circle(Round{.edges = 3}.points()));
  EXPECT_FALSE(is_circle(Round{.edges = 12}.points()));  // a polygon
  EXPECT_FALSE(is_circle(Round{.sweep = 4 * kPi, .edges = 200}.points()));
  std::vector<Point2> line;
  for (int i = 0; i < 20; ++i) line.emplace_back(i, 2 * i);
  EXPECT_FALSE(is_circle(line));
  std::vector<Point2> ellipse = round;
  for (Point2& p : ellipse) p.x() *= 1.01;
  EXPECT_FALSE(is_circle(ellipse));
  std::vector<Point2> back = round;  // and to the last point again
  std::swap(back[40], back[41]);
  EXPECT_FALSE(is_circle(back));
  std::vector<Point2> with_dent = round;
  with_dent[41] += 0.012 * (with_dent[41] - Round{}.center).normalized();
  EXPECT_FALSE(is_circle(with_dent));
  std::vector<Point2> twice = round;
  twice[41] = twice[40];
  EXPECT_FALSE(is_circle(twice));
}

}  // namespace
}  // namespace batten::geometry
