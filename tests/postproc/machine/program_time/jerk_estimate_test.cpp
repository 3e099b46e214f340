// On machines with limits on jerk the model of the control is an estimate of the least-time plan:
// both times of the same chains.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "postproc/machine/models/planned_chain.h"
#include "postproc/smooth/selection/run_times.h"
#include "tests/support/machine_limits.h"
#include "tests/support/planned_paths.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::Line;
using geometry::Point3;
using geometry::Vector3;

const Machine& fast_mill() { return *find_machine("high-speed"); }

double estimated_of(const std::vector<TimedPiece>& chain, const Machine& machine) {
  return cutting_time(chain, machine, gcode::PathMode::kBlending);
}

double planned_of(const std::vector<TimedPiece>& chain, const Machine& machine) {
  return PlannedMotion(chain, machine, FeedPlanner::kJerk).duration();
}

// A wavy row in space of chords from .05 to .5 mm, its ends printed with three decimals: kinks of
// all sizes.
std::vector<TimedPiece> printed_chords(double feed) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> length(0.05, 0.5);
  const auto printed = [](double x) { return std::round(1000 * x) / 1000; };
  std::vector<TimedPiece> chain;
  Point3 at(0, 0, 0);
  for (double x = 0; x < 60;) {
    x += length(random);
    const Point3 next(printed(x), printed(3 * std::sin(x / 4)), printed(std::cos(x / 3)));
    chain.push_back({Line{at, next}, feed});
    at = next;
  }
  return chain;
}

// Corners of all angles, a feed of its own on each leg: from too short to reach it to long.
std::vector<TimedPiece> corners_of_many_feeds(double feed) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<TimedPiece> chain;
  Point3 at(0, 0, 0);
  double angle = 0;
  for (int i = 0; i < 200; ++i) {
    angle += 3 * std::pow(2 * unit(random) - 1, 5);  // most of them small
    const Point3 next =
        at + 8 * std::pow(unit(random), 3) * Vector3(std::cos(angle), std::sin(angle), 0);
    chain.push_back({Line{at, next}, feed * (0.3 + unit(random))});
    at = next;
  }
  return chain;
}

// Tangent arcs of radii from .5 to 8 mm, and lines between some of them.
std::vector<TimedPiece> tangent_arcs(double feed) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<TimedPiece> chain;
  Point3 at(0, 0, 0);
  double angle = 0;
  for (int i = 0; i < 60; ++i) {
    const double radius = 0.5 * std::pow(16, unit(random));
    const double sweep = (i % 2 == 0 ? 1 : -1) * (0.3 + 2 * unit(random));
    const double side = sweep > 0 ? 1 : -1;
    const Point3 center = at + side * radius * Vector3(-std::sin(angle), std::cos(angle), 0);
    angle += sweep;
    const Point3 end = center - side * radius * Vector3(-std::sin(angle), std::cos(angle), 0);
    chain.push_back({Arc{at, end, center, {0, 0, 1}, sweep}, feed});
    at = end;
    if (i % 3 != 0) continue;
    const Point3 next = at + 6 * unit(random) * Vector3(std::cos(angle), std::sin(angle), 0);
    chain.push_back({Line{at, next}, feed});
    at = next;
  }
  return chain;
}

std::vector<TimedPiece> pieces_of(const std::vector<Point3>& control, double feed) {
  std::vector<double> knots;
  for (std::size_t i = 0; i + 2 < control.size(); ++i) knots.push_back(static_cast<double>(i));
  std::vector<TimedPiece> chain;
  const geometry::BsplineCurve curve(geometry::BsplineBasis::clamped(3, knots), control);
  for (const geometry::CubicBezier& piece : curve.bezier_pieces()) chain.push_back({piece, feed});
  return chain;
}

// Bends everywhere that are slower than the feed, but for the least one, and over before the speed
// has settled: stretches of held speeds are farthest off there, and too slow.
std::vector<TimedPiece> spline_of_all_bends(double feed) {
  std::vector<Point3> control;
  for (int i = -1; i < 62; ++i) {
    control.emplace_back(2 * i, 4 * std::sin(0.7 * i) + std::sin(2.3 * i), std::sin(1.1 * i));
  }
  return pieces_of(control, feed);
}

// Round lobes, about whose sharp places the speed rises and falls.
std::vector<TimedPiece> lobes(double feed) {
  std::vector<Point3> control;
  for (int i = 0; i < 80; ++i) {
    const double angle = 2 * 3.14159265 * i / 79;
    const double radius = 20 + 6 * std::cos(9 * angle);
    control.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  return pieces_of(control, feed);
}

std::vector<TimedPiece> spline_of_scattered_points(double feed) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0, 40);
  std::vector<Point3> control;
  for (int i = 0; i < 40; ++i) control.emplace_back(place(random), place(random), place(random));
  return pieces_of(control, feed);
}

// A slow curve in the midst of lines, by which most of the time goes.
std::vector<TimedPiece> curve_among_lines(double feed) {
  std::vector<TimedPiece> chain = lobes(feed);
  const Point3 end = geometry::end_point(chain.back().piece);
  const Vector3 on = geometry::direction_at(chain.back().piece, 1);
  chain.push_back({Line{end, end + 2000 * on}, feed});
  return chain;
}

struct EstimateCase {
  std::string name;
  std::vector<TimedPiece> (*make)(double feed);
  double within;  // of the plan's time
};

class JerkEstimate : public testing::TestWithParam<EstimateCase> {};

TEST_P(JerkEstimate, IsThePlansTime) {
  for (const double feed : {1500.0, 6000.0, 20000.0}) {
    const std::vector<TimedPiece> chain = GetParam().make(feed);
    const double plan = planned_of(chain, fast_mill());
    const double estimate = estimated_of(chain, fast_mill());
    fmt::print("{} at {} mm/min: plan {:.4f} s, estimate {:+.2f} %\n", GetParam().name, feed, plan,
               100 * (estimate / plan - 1));
    EXPECT_NEAR(estimate, plan, GetParam().within * plan) << feed;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Chains, JerkEstimate,
    testing::Values(EstimateCase{"PrintedChords", printed_chords, 0.01},
                    EstimateCase{"CornersOfManyFeeds", corners_of_many_feeds, 0.01},
                    EstimateCase{"TangentArcs", tangent_arcs, 0.01},
                    EstimateCase{"SplineOfAllBends", spline_of_all_bends, 0.002},
                    EstimateCase{"Lobes", lobes, 0.002},
                    EstimateCase{"SplineOfScatteredPoints", spline_of_scattered_points, 0.01},
                    EstimateCase{"CurveAmongLines", curve_among_lines, 0.01}),
    [](const auto& test) { return test.param.name; });

// Forms of few slow bends for each piece, and of cusps, are compared by their stretches, which are
// too slow; the times at other settings of the override are so by as much.
TEST(JerkEstimateOfForms, IsAPlanWhereThatIsWorthItsWork) {
  constexpr auto kPath = gcode::PathMode::kBlending;
  const auto timed = [](const std::vector<TimedPiece>& chain, WorthAPlan worth) {
    return times_of(chain, fast_mill(), kPath, worth);
  };
  const std::vector<TimedPiece> chain = lobes(6000);
  const double plan = estimated_of(chain, fast_mill());
  const Times planned = timed(chain, {});
  const Times by_stretches = timed(chain, kNoPlan);
  EXPECT_EQ(planned.programmed, plan);
  EXPECT_GT(by_stretches.programmed, 1.05 * plan);
  const double ratio = planned.programmed / by_stretches.programmed;
  EXPECT_NEAR(planned.at_half, ratio * by_stretches.at_half, 1e-12);
  EXPECT_NEAR(planned.at_one_and_half, ratio * by_stretches.at_one_and_half, 1e-12);
  // Slow bends take less than all of it.
  const double all = by_stretches.programmed / static_cast<double>(chain.size());
  EXPECT_EQ(timed(chain, {.seconds = all}).programmed, by_stretches.programmed);
  // The same in the size of a printed step: some milliseconds for each piece.
  std::vector<TimedPiece> small = chain;
  for (TimedPiece& each : small) {
    for (Point3& point : std::get<geometry::CubicBezier>(each.piece).control) point *= 2e-4;
  }
  EXPECT_EQ(timed(small, kAmongForms).programmed, timed(small, kNoPlan).programmed);
  EXPECT_LT(timed(small, {}).programmed, 0.99 * timed(small, kNoPlan).programmed);
  EXPECT_EQ(timed(chain, kAmongForms).programmed, plan);
}

// Without a limit on jerk a joint goes by the speed of the axes alone, as it did.
TEST(JerkEstimateOfAJoint, GoesByAccelerationWithoutALimitOnJerk) {
  Machine machine = fast_mill();
  const auto corner = [](double turn) {
    const Point3 end = Point3(20, 0, 0) + 20 * Vector3(std::cos(turn), std::sin(turn), 0);
    return std::vector<TimedPiece>{{Line{{0, 0, 0}, {20, 0, 0}}, 6000},
                                   {Line{{20, 0, 0}, end}, 6000}};
  };
  const double with = estimated_of(corner(0.05), machine);
  const double straight = estimated_of(corner(0), machine);
  EXPECT_GT(with, 1.1 * straight);
  set_max_jerk(machine, Machine::kNone);
  // 10000 mm/s2 for half a millisecond is 5 mm/s, 100 mm/s times the turn.
  EXPECT_NEAR(estimated_of(corner(0.0499), machine), estimated_of(corner(0), machine), 1e-5);
  EXPECT_GT(estimated_of(corner(0.06), machine), estimated_of(corner(0), machine) + 1e-4);
}

}  // namespace
}  // namespace batten::postproc
