#include <gtest/gtest.h>

#include <cmath>
#include <variant>

#include "gcode/controls/built_in.h"
#include "geometry/path/path.h"
#include "postproc/smooth/forms/output_plan.h"
#include "tests/support/curve_of.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

// --- knots that rounding has parted -------------------------------------------------------------

// A curve of few spans, with vertices on it and another feed from one of its knots on: but for
// `steps` of the last bit, as two ways to compute one parameter differ.
struct NearKnot {
  Run run;
  geometry::SmoothCurve fair;

  explicit NearKnot(int steps) : fair{bend(), {}, 0, 0, 0, 0} {
    const geometry::BsplineCurve& curve = fair.curve;
    double change = curve.breakpoints()[3];
    const double towards = steps > 0 ? curve.last() : curve.first();
    for (int i = 0; i < std::abs(steps); ++i) change = std::nextafter(change, towards);
    fair.vertex_parameters = {curve.first(), change, curve.last()};
    for (const double u : fair.vertex_parameters) run.points.push_back(curve.point_at(u));
    run.feeds = {{0, 1000}, {1, 500}};
  }

  // y = 5 sin(x / 5) over two crests in spans of 5 mm.
  static geometry::BsplineCurve bend() {
    const auto f = [](double u) { return Point3(u, 5 * std::sin(u / 5), -1); };
    return geometry::curve_of(f, 0, 30, 6);
  }
};

class CurvesOfTargets : public testing::TestWithParam<const char*> {};

// Else the piece between the two is halved until nothing is left of it.
TEST_P(CurvesOfTargets, TakePartedKnotsForOne) {
  for (const int steps : {-3, -1, 0, 1, 3}) {
    SCOPED_TRACE(testing::Message() << steps << " steps of the last bit");
    const NearKnot near(steps);
    PlanOptions options;
    options.target = gcode::find_control(GetParam());
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

INSTANTIATE_TEST_SUITE_P(Targets, CurvesOfTargets,
                         testing::Values("linuxcnc", "marlin", "fanuc", "siemens", "itnc530"),
                         [](const auto& test) { return std::string(test.param); });

// --- lines with a bow that is noise --------------------------------------------------------------

// Moves of one run of 40 mm that bows by so much to one side; none where no curve is planned.
std::vector<PlannedMove> moves_of_bow(const char* target, double bow) {
  const auto f = [bow](double u) { return Point3(u, bow * std::sin(u * 3.14159 / 40), -1); };
  geometry::SmoothCurve fair{geometry::curve_of(f, 0, 40, 8), {}, 0, 0, 0, 0};
  Run run;
  fair.vertex_parameters = {fair.curve.first(), fair.curve.last()};
  for (const double u : fair.vertex_parameters) run.points.push_back(fair.curve.point_at(u));
  run.feeds = {{0, 1000}};
  PlanOptions options;
  options.target = gcode::find_control(target);
  options.max_deviation = 0.005;
  const auto plan = plan_curves(run, fair, options);
  return plan ? plan->moves : std::vector<PlannedMove>{};
}

TEST_P(CurvesOfTargets, ABowOfNoiseIsNoCurveAndABendIs) {
  EXPECT_TRUE(moves_of_bow(GetParam(), 0.0005).empty());  // no curve: left to the lines
  // Chords of Marlin's own are too far from such a bend.
  if (std::string(GetParam()) == "marlin") return;
  const std::vector<PlannedMove> bent = moves_of_bow(GetParam(), 3);
  ASSERT_FALSE(bent.empty());
  EXPECT_FALSE(std::holds_alternative<geometry::Line>(bent.front().piece));
}

}  // namespace
}  // namespace batten::postproc
