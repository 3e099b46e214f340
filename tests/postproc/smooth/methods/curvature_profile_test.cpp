// How much a curve bends, and how many chords are expected of it.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/fitting/fair/fair.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/methods/run_curve.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// Along x from 0 to 10 at y = x^2 / 8: its curvature is 1/4 at the vertex, and less everywhere
// else.
geometry::BsplineCurve parabola() {
  const std::vector<double> knots = {0, 0, 0, 0, 10, 10, 10, 10};
  const auto x = [](int i) { return 10.0 * i / 3; };
  // The polar form of x^2 / 8: products of two of its three arguments, in the mean.
  const std::vector<geometry::Point3> control = {
      {x(0), 0, 0}, {x(1), 0, 0}, {x(2), 100.0 / 24, 0}, {x(3), 100.0 / 8, 0}};
  return {geometry::BsplineBasis(3, knots), control};
}

// Chords of 10 mm are longer than any there: all may be twice as far off.
TEST(CurvatureProfile, FindsTheGreatestCurvatureAndExpectsFewerChordsWhereTheyWouldBeShort) {
  const CurvatureProfile bends(parabola());
  EXPECT_NEAR(bends.greatest(), 0.25, 1e-9);
  EXPECT_NEAR(bends.chords(0.001, 10), bends.chords(0.002, 0), 1e-9 * bends.chords(0.002, 0));
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
    plan.chord_height = deviation;
    const OutputPlan lines = plan_lines(run, *fair, geometry::MarkedPieces(fair->curve), plan);
    const auto planned = static_cast<double>(lines.moves.size());
    const double step = 10 * options.machine->block_period;
    const double estimated = CurvatureProfile(fair->curve).chords(deviation, kPlans.periods * step);
    EXPECT_NEAR(estimated, planned, 0.2 * planned);
  }
}

}  // namespace
}  // namespace batten::postproc
