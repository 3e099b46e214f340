// --linearize from the command line to the moves.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "gcode/controls/built_in.h"
#include "geometry/distance/path_distance.h"
#include "postproc/cli/cli.h"
#include "postproc/smooth/curve_forms.h"
#include "postproc/smooth/forms/output_plan.h"
#include "tests/support/curve_of.h"

namespace batten::postproc {
namespace {

using geometry::BsplineCurve;
using geometry::Point3;

SmoothOptions options_given(const std::vector<std::pair<std::string, std::string>>& words) {
  Arguments in = {{}, {"part.nc"}};
  in.given.add("target", "linuxcnc");
  for (const auto& [name, value] : words) in.given.add(name, value);
  const SmoothCommand command = smooth_command(in);
  EXPECT_TRUE(in.problems.empty());
  return command.options;
}

TEST(LinearizeOption, IsMinLinkForSizeAndChordsOtherwise) {
  EXPECT_EQ(linearize_of(options_given({{"prefer", "size"}})), Linearize::kMinLink);
  EXPECT_EQ(linearize_of(options_given({{"prefer", "time"}})), Linearize::kChord);
  EXPECT_EQ(linearize_of(options_given({{"prefer", "accuracy"}})), Linearize::kChord);
}

TEST(LinearizeOption, GoesBeforeThePreference) {
  for (const auto& choice : linearizations()) {
    const std::string name(choice.name);
    for (const char* preference : {"time", "size"}) {
      const auto options = options_given({{"linearize", name}, {"prefer", preference}});
      EXPECT_EQ(linearize_of(options), choice.value);
    }
    EXPECT_EQ(name_of(choice.value), choice.name);
  }
}

TEST(LinearizeOption, RefusesUnknownNames) {
  Arguments in = {{}, {"part.nc"}};
  in.given.add("target", "linuxcnc");
  in.given.add("linearize", "min-link");
  (void)smooth_command(in);
  ASSERT_EQ(in.problems.size(), 1U);
  EXPECT_NE(in.problems.front().find("minlink"), std::string::npos) << in.problems.front();
}

// y = 5 sin(x / 5), with the feed halved half way and a comment.
struct Wave {
  Run run;
  geometry::SmoothCurve fair;

  Wave() : fair{curve(), {}, 0, 0, 0, 0} {
    for (int i = 0; i <= 100; ++i) {
      fair.vertex_parameters.push_back(0.6 * i);
      run.points.push_back(fair.curve.point_at(fair.vertex_parameters.back()));
    }
    run.feeds = {{0, 1000}, {50, 500}};
    run.comments = {{30, {}}};
  }

  static BsplineCurve curve() {
    const auto f = [](double u) { return Point3(u, 5 * std::sin(u / 5), -1); };
    return geometry::curve_of(f, 0, 60, 600);
  }

  [[nodiscard]] OutputPlan planned(Linearize linearize, double deviation = 0.005,
                                   bool counted = false) const {
    PlanOptions options{gcode::find_control("linuxcnc"), find_machine("linuxcnc")};
    options.max_deviation = deviation;
    options.linearize = linearize;
    options.counted = counted;
    return plan_lines(run, fair, geometry::MarkedPieces(fair.curve), options);
  }
};

TEST(PlanLines, StayNearTheCurveAndChangeTheFeedOnItHoweverTheyAreLaid) {
  const Wave wave;
  geometry::Path curve;
  for (const auto& piece : wave.fair.curve.bezier_pieces()) curve.push_back(piece);
  for (const auto& choice : linearizations()) {
    SCOPED_TRACE(choice.name);
    const OutputPlan plan = wave.planned(choice.value);
    geometry::Path lines;
    for (const PlannedMove& move : plan.moves) lines.push_back(move.piece);
    EXPECT_EQ(geometry::start_point(lines.front()), wave.run.points.front());
    EXPECT_EQ(geometry::end_point(lines.back()), wave.run.points.back());
    // The proof of path_distance may be 2 % of the tolerance too great.
    EXPECT_EQ(geometry::compare_paths(curve, lines, 1.021 * 0.005).verdict,
              geometry::Verdict::kProved);
    int changes = 0;
    for (std::size_t i = 1; i < plan.moves.size(); ++i) {
      if (plan.moves[i].feed == plan.moves[i - 1].feed) continue;
      ++changes;
      EXPECT_LE((geometry::start_point(plan.moves[i].piece) - wave.run.points[50]).norm(), 1e-9);
    }
    EXPECT_EQ(changes, 1);
  }
}

// The bound that a quick count of links gives holds for them, and is near to them.
TEST(PlanLines, AreAsManyLinksAsTheirQuickCountSays) {
  const Wave wave;
  for (const double deviation : {0.001, 0.002, 0.005, 0.01, 0.02}) {
    const std::size_t links = wave.planned(Linearize::kMinLink, deviation).moves.size();
    const std::size_t counted = wave.planned(Linearize::kMinLink, deviation, true).moves.size();
    const double least = kFormTuning.counted_links * kBounds.fewer * static_cast<double>(counted);
    EXPECT_GE(static_cast<double>(links), least);
    EXPECT_LE(static_cast<double>(links), 1.15 * least);
  }
}

// A quarter turn of a kilometre in one piece takes some eight thousand equal steps.
TEST(PlanLines, AreChordsWhereEqualStepsWouldBeWithoutBound) {
  Wave wave;
  EXPECT_FALSE(wave.planned(Linearize::kIlca).chords_for_steps);
  const std::vector<Point3> points = {{0, 0, 0}, {5.5e5, 0, 0}, {1e6, 4.5e5, 0}, {1e6, 1e6, 0}};
  wave.fair.curve = BsplineCurve(geometry::BsplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 1}), points);
  wave.run.points = {points.front(), wave.fair.curve.point_at(0.5), points.back()};
  wave.run.feeds = {{0, 1000}};
  wave.run.comments.clear();
  wave.fair.vertex_parameters = {0, 0.5, 1};
  const OutputPlan steps = wave.planned(Linearize::kIlca);
  EXPECT_TRUE(steps.chords_for_steps);
  const OutputPlan chords = wave.planned(Linearize::kChord);
  EXPECT_FALSE(chords.chords_for_steps);
  ASSERT_EQ(steps.moves.size(), chords.moves.size());
  for (std::size_t i = 0; i < steps.moves.size(); ++i) {
    EXPECT_EQ(geometry::end_point(steps.moves[i].piece),
              geometry::end_point(chords.moves[i].piece));
  }
}

TEST(PlanLines, AreFewestAsMinLink) {
  const Wave wave;
  const auto links = static_cast<double>(wave.planned(Linearize::kMinLink).moves.size());
  const auto chords = static_cast<double>(wave.planned(Linearize::kChord).moves.size());
  EXPECT_LE(links, 0.75 * chords);
  for (const Linearize other : {Linearize::kIlca, Linearize::kBlca}) {
    EXPECT_LE(chords, static_cast<double>(wave.planned(other).moves.size()));
  }
}

}  // namespace
}  // namespace batten::postproc
