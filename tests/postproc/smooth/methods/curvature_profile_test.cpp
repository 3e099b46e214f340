// How much a curve bends, and how many chords are expected of it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/fitting/fair/fair.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/methods/run_curve.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

// Along x from 0 to 10 at y = x^2 / 8: its curvature is 1/4 at the vertex, and less everywhere
// else.
geometry::BsplineCurve parabola() {
  const std::vector<double> knots = {0, 0, 0, 0, 10, 10, 10, 10};
  const auto x = [](int i) { return 10.0 * i / 3; };
  // The polar form of x^2 / 8: products of two of its three arguments, in the mean.
  const std::vector<Point3> control = {
      {x(0), 0, 0}, {x(1), 0, 0}, {x(2), 100.0 / 24, 0}, {x(3), 100.0 / 8, 0}};
  return {geometry::BsplineBasis(3, knots), control};
}

TEST(CurvatureProfile, FindsTheGreatestCurvature) {
  EXPECT_NEAR(CurvatureProfile(parabola()).greatest(), 0.25, 1e-9);
}

// n chords that are all at the greatest height h of chord are as many as the root of the curvature,
// over the length, divided by the root of 8 h: here the curvature is (1 + x^2 / 16)^(-3/2) / 4.
TEST(CurvatureProfile, ExpectsChordsByTheRootOfTheCurvature) {
  double roots = 0;
  constexpr int kSteps = 10000;
  for (int i = 0; i < kSteps; ++i) {
    const double x = 10 * (i + 0.5) / kSteps;
    const double slope = 1 + x * x / 16;
    roots += 10.0 / kSteps * std::sqrt(slope) * std::pow(slope, -0.75) / 2;
  }
  const double height = 0.001;
  const double chords = roots / std::sqrt(8 * height);
  // The length is taken to be the parameter, which here is x: too short by up to 2.7 times.
  EXPECT_LT(CurvatureProfile(parabola()).chords(height, 0), chords);
  EXPECT_GT(CurvatureProfile(parabola()).chords(height, 0), chords / 2.7);
}

// Chords of 10 mm are longer than any there: all may be twice as far off.
TEST(CurvatureProfile, ExpectsFewerChordsWhereTheyWouldBeShort) {
  const CurvatureProfile bends(parabola());
  EXPECT_NEAR(bends.chords(0.001, 10), bends.chords(0.002, 0), 1e-9 * bends.chords(0.002, 0));
}

TEST(CurvatureProfile, OfALineAreNone) {
  const std::vector<double> knots = {0, 0, 0, 0, 30, 30, 30, 30};
  const std::vector<Point3> control = {{0, 0, 0}, {10, 5, 0}, {20, 10, 0}, {30, 15, 0}};
  const CurvatureProfile bends({geometry::BsplineBasis(3, knots), control});
  EXPECT_NEAR(bends.greatest(), 0, 1e-12);
  EXPECT_NEAR(bends.chords(0.001, 0), 0, 1e-4);
}

// Half a circle of radius 10.
TEST(CurvatureProfile, ExpectChordsWithinAFifthOfThoseThatArePlanned) {
  postproc::Run run;
  for (int i = 0; i <= 400; ++i) {
    const double angle = std::numbers::pi * i / 400;
    run.points.emplace_back(10 * std::cos(angle), 10 * std::sin(angle), 0);
  }
  run.feeds = {{0, 600}};
  const auto fair = geometry::fair_path(run.points, {});
  ASSERT_TRUE(fair);
  const SmoothOptions options = options_for("linuxcnc");
  for (const double deviation : {0.0005, 0.002, 0.005}) {
    SCOPED_TRACE(testing::Message() << deviation << " mm");
    PlanOptions plan{options.target, options.machine};
    plan.max_deviation = deviation;
    const auto planned = static_cast<double>(plan_lines(run, *fair, plan).moves.size());
    const double step = 10 * options.machine->block_period;
    const double estimated = CurvatureProfile(fair->curve).chords(0.5 * deviation, 2 * step);
    EXPECT_NEAR(estimated, planned, 0.2 * planned);
  }
}

}  // namespace
}  // namespace batten::postproc
