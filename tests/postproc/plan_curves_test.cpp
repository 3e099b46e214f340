#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "geometry/path.h"
#include "postproc/plan/output_plan.h"
#include "tests/support/curve_of.h"
#include "wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::BsplineCurve;
using geometry::Point3;

// --- knots that rounding has parted -------------------------------------------------------------

// A curve of few spans, with vertices on it and another feed from one of its knots on: but for
// `steps` of the last bit, as two ways to compute one parameter differ.
struct NearKnot {
  Run run;
  geometry::FairPath fair;

  explicit NearKnot(int steps) : fair{bend(), {}, 0, 0, 0, 0} {
    const BsplineCurve& curve = fair.curve;
    double change = curve.breakpoints()[3];
    const double towards = steps > 0 ? curve.last() : curve.first();
    for (int i = 0; i < std::abs(steps); ++i) change = std::nextafter(change, towards);
    fair.vertex_parameters = {curve.first(), change, curve.last()};
    for (const double u : fair.vertex_parameters) run.points.push_back(curve.point_at(u));
    run.feeds = {{0, 1000}, {1, 500}};
  }

  // y = 5 sin(x / 5) over two crests in spans of 5 mm.
  static BsplineCurve bend() {
    const auto f = [](double u) { return Point3(u, 5 * std::sin(u / 5), -1); };
    return geometry::curve_of(f, 0, 30, 6);
  }
};

class PartedKnots : public testing::TestWithParam<const char*> {};

// Without the guard in CurvePlanner::add_taken the piece between the two is halved until nothing is
// left of it, and BsplineCurve::part throws.
TEST_P(PartedKnots, AreOneKnot) {
  for (const int steps : {-3, -1, 0, 1, 3}) {
    SCOPED_TRACE(testing::Message() << steps << " steps of the last bit");
    const NearKnot near(steps);
    PlanOptions options;
    options.target = gcode::find_dialect(GetParam());
    options.max_deviation = 0.005;
    const auto plan = plan_curves(near.run, near.fair, options);
    ASSERT_TRUE(plan);
    ASSERT_FALSE(plan->moves.empty());
    Point3 place = near.run.points.front();
    for (const PlannedMove& move : plan->moves) {
      EXPECT_LE((geometry::start_point(move.piece) - place).norm(), 1e-9);
      EXPECT_GT(geometry::length_of(move.piece), 1e-6);
      place = geometry::end_point(move.piece);
    }
    EXPECT_LE((place - near.run.points.back()).norm(), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, PartedKnots,
                         testing::Values("linuxcnc", "marlin", "fanuc", "siemens", "itnc530"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace batten::postproc
