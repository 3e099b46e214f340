#include "postproc/smooth/forms/line_arcs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <variant>
#include <vector>

#include "gcode/controls/built_in.h"
#include "tests/support/curve_of.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::Line;
using geometry::Point3;

constexpr double kRounding = 0.0005;  // mm
constexpr double kRadius = 8;

// A quarter of a circle between two lines, in the plane across an axis.
struct Corner {
  Run run;
  geometry::SmoothCurve fair;

  explicit Corner(int normal, int chords = 20, double scatter = 0) : fair{line_fair()} {
    std::mt19937 chance(5);
    std::uniform_real_distribution<double> off(-scatter, scatter);
    const auto add = [&](double x, double y) {
      Point3 p;
      p[(normal + 1) % 3] = std::round((x + off(chance)) * 1000) / 1000;
      p[(normal + 2) % 3] = std::round((y + off(chance)) * 1000) / 1000;
      p[normal] = -2;
      run.points.push_back(p);
    };
    add(-10, -kRadius);
    for (int i = 0; i <= chords; ++i) {
      const double angle = geometry::kPi / 2 * i / chords;
      add(kRadius * std::sin(angle), -kRadius * std::cos(angle));
    }
    add(kRadius, 12);
    run.feeds = {{0, 600}};
    const double last = static_cast<double>(run.points.size() - 1);
    for (std::size_t i = 0; i < run.points.size(); ++i) {
      fair.vertex_parameters.push_back(static_cast<double>(i) / last);
    }
  }

 private:
  static geometry::SmoothCurve line_fair() {
    return {geometry::curve_of([](double u) { return Point3(u, 0, 0); }, 0, 1, 4), {}};
  }
};

PlanOptions options_of(std::string_view target) {
  PlanOptions options;
  options.target = gcode::find_control(target);
  return options;
}

TEST(LineArcs, AreFoundInEachPlane) {
  for (const int normal : {0, 1, 2}) {
    SCOPED_TRACE(normal);
    const Corner corner(normal);
    const auto shape = line_arcs_of(corner.run, 0.01, kRounding);
    ASSERT_TRUE(shape);
    EXPECT_TRUE(shape->is_certain);
    EXPECT_EQ(shape->normal, normal);
    const auto moves = moves_along(*shape, corner.run, corner.fair);
    ASSERT_EQ(moves.size(), 3U);
    EXPECT_EQ(std::get<Line>(moves[0].piece).start, corner.run.points.front());
    EXPECT_EQ(std::get<Line>(moves[2].piece).end, corner.run.points.back());
    const Arc& arc = std::get<Arc>(moves[1].piece);
    EXPECT_NEAR(geometry::radius_of(arc), kRadius, 0.002);
    EXPECT_NEAR(std::abs(arc.sweep), geometry::kPi / 2, 0.001);
    EXPECT_EQ(moves[1].start, corner.fair.vertex_parameters[1]);

    const auto plan = plan_line_arcs(*shape, corner.run, corner.fair, options_of("linuxcnc"));
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->form, Form::kArcs);
    EXPECT_EQ(plan->moves.size(), 3U);
  }
}

TEST(LineArcs, AreNotFoundWhereVerticesScatter) {
  EXPECT_TRUE(line_arcs_of(Corner(2).run, 0.01, kRounding));
  EXPECT_FALSE(line_arcs_of(Corner(2, 20, 0.005).run, 0.01, kRounding));
}

TEST(LineArcs, AreNotFoundInChordsThatLeaveTheArcTooFar) {
  EXPECT_TRUE(line_arcs_of(Corner(2, 20).run, 0.0065, kRounding));
  EXPECT_FALSE(line_arcs_of(Corner(2, 20).run, 0.0055, kRounding));  // 0.006 by the sagitta
}

TEST(LineArcs, AreCutWhereTheFeedChanges) {
  Corner corner(2);
  corner.run.feeds.push_back({11, 300});
  const auto shape = line_arcs_of(corner.run, 0.01, kRounding);
  ASSERT_TRUE(shape);
  const auto moves = moves_along(*shape, corner.run, corner.fair);
  ASSERT_EQ(moves.size(), 4U);
  EXPECT_EQ(moves[1].feed, 600);
  EXPECT_EQ(moves[2].feed, 300);
  EXPECT_EQ(moves[3].feed, 300);
}

// Of ellipses, waves, spirals and cubics in chords of any length, rounded to 3 or 4 decimals.
TEST(LineArcs, AreNotFoundInOtherCurves) {
  const std::vector<std::function<Point3(double)>> curves = {
      [](double u) { return Point3(20 * std::cos(u), 12 * std::sin(u), 0); },
      [](double u) { return Point3(10 * std::cos(u), 9.5 * std::sin(u), 0); },
      [](double u) { return Point3(10 * u, 4 * std::sin(2 * u), 0); },
      [](double u) { return Point3((5 + 2 * u) * std::cos(u), (5 + 2 * u) * std::sin(u), 0); },
      [](double u) { return Point3(5 * u - 15, std::pow(5 * u - 15, 3) / 900, 0); }};
  for (std::size_t k = 0; k < curves.size(); ++k) {
    for (const double chord : {0.1, 0.3, 0.6, 1.2, 2.5}) {
      for (const double step : {1e-3, 1e-4}) {
        SCOPED_TRACE(testing::Message() << k << ", " << chord << ", " << step);
        postproc::Run run;
        for (double u = 0; u < 6;) {
          run.points.emplace_back((curves[k](u) / step).array().round() * step);
          u += chord / ((curves[k](u + 1e-4) - curves[k](u)).norm() / 1e-4);
        }
        run.feeds = {{0, 600}};
        EXPECT_FALSE(line_arcs_of(run, 0.009, step / 2));
      }
    }
  }
}

// A circle that is no more than a guess is written, too, but is not what was meant.
TEST(LineArcs, AreNotCertainOfAScatteredCircle) {
  for (const double scatter : {0.0, 0.003}) {
    SCOPED_TRACE(scatter);
    std::mt19937 chance(5);
    std::uniform_real_distribution<double> off(-scatter, scatter);
    postproc::Run run;
    for (int i = 0; i <= 100; ++i) {
      const double angle = 2 * geometry::kPi * i / 100;
      const double radius = kRadius + (i % 100 == 0 ? 0 : off(chance));
      run.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    }
    run.feeds = {{0, 600}};
    const auto shape = line_arcs_of(run, 0.01, 1e-4);
    ASSERT_TRUE(shape);
    EXPECT_EQ(shape->sections.size(), 1U);
    EXPECT_EQ(shape->is_certain, scatter == 0);
  }
}

TEST(LineArcs, AreNotPlannedForAControlWithoutArcsInTheirPlane) {
  const Corner corner(1);
  const auto shape = line_arcs_of(corner.run, 0.01, kRounding);
  ASSERT_TRUE(shape);
  EXPECT_FALSE(plan_line_arcs(*shape, corner.run, corner.fair, options_of("marlin")));
  PlanOptions few = options_of("linuxcnc");
  few.most_arcs = 2;
  EXPECT_FALSE(plan_line_arcs(*shape, corner.run, corner.fair, few));
}

}  // namespace
}  // namespace batten::postproc
