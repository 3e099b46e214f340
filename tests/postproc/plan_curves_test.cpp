#include <gtest/gtest.h>

#include <cmath>
#include <random>
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

// --- straight lines that are not quite straight
// ---------------------------------------------------

// 60 mm in some direction of space, in steps of 0.3 mm, each place off by up to `noise`.
std::string noisy_line(unsigned seed, double noise, bool klartext) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> scatter(-noise, noise);
  std::uniform_real_distribution<double> direction(-1, 1);
  const Point3 along = Point3(1, direction(random), 0.3 * direction(random)).normalized();
  const auto place = [&](double s) -> Point3 {
    return along * s + Point3(scatter(random), scatter(random), scatter(random));
  };
  std::string text = klartext ? "BEGIN PGM A MM\nTOOL CALL 1 Z S3000\nL X+0 Y+0 Z+0 R0 FMAX\n"
                              : "G21 G90 G17\nG0 X0 Y0 Z0\n";
  constexpr int kLines = 200;
  for (int i = 1; i <= kLines; ++i) {
    const Point3 p = place(0.3 * i);
    text += klartext ? fmt::format("L X{:+.4f} Y{:+.4f} Z{:+.4f}", p.x(), p.y(), p.z())
                     : fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f}", p.x(), p.y(), p.z());
    text += i == 1 ? " F900\n" : "\n";
  }
  return text + (klartext ? "L Z+50 FMAX\nM30\nEND PGM A MM\n" : "G0 Z50\nM30\n");
}

class NoisyLine : public testing::TestWithParam<const char*> {};

TEST_P(NoisyLine, IsOneLineAndNoCurve) {
  constexpr unsigned kLines = 5;
  for (unsigned seed = 1; seed <= kLines; ++seed) {
    for (const double noise : {0.0, 0.0005, 0.002}) {
      for (const Form form : {Form::kAuto, Form::kCurves}) {
        SCOPED_TRACE(testing::Message()
                     << "seed " << seed << ", noise " << noise << " mm, " << name_of(form));
        SmoothOptions options = options_for(GetParam());
        options.output = form;
        const bool klartext = options.target->language() == gcode::Language::kKlartext;
        const SmoothResult result = smoothed(noisy_line(seed, noise, klartext), options);
        ASSERT_TRUE(result.understood && result.proved);
        ASSERT_EQ(rewritten_runs(result), 1U);
        const auto run = std::ranges::find(result.runs, RunStatus::kRewritten, &RunReport::status);
        EXPECT_EQ(run->blocks_out, 1U) << result.text;
        EXPECT_NE(run->form, OutputForm::kCurves);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, NoisyLine,
                         testing::Values("fanuc", "siemens", "siemens-bspline", "itnc530",
                                         "linuxcnc", "marlin"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace batten::postproc
