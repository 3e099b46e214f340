// What is said about a run before it is fitted must hold for what is made of it.
#include <gtest/gtest.h>

#include <cmath>

#include "postproc/smooth/selection/candidate_bounds.h"
#include "postproc/smooth/selection/selection.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

postproc::Run run_through(std::vector<Point3> points, double feed = 600) {
  postproc::Run run;
  run.points = std::move(points);
  run.feeds = {{0, feed}};
  return run;
}

// Chords of half a circle of radius 10.
std::vector<Point3> half_circle(int chords) {
  constexpr double kPi = 3.141592653589793;
  std::vector<Point3> points;
  for (int i = 0; i <= chords; ++i) {
    points.emplace_back(10 * std::cos(kPi * i / chords), 10 * std::sin(kPi * i / chords), 0);
  }
  return points;
}

Machine machine() { return *find_machine("linuxcnc-fast"); }

TEST(TimeAtFeeds, IsTheLengthAtEachFeed) {
  postproc::Run line = run_through({{0, 0, 0}, {20, 0, 0}, {50, 0, 0}});
  EXPECT_DOUBLE_EQ(time_at_feeds(line, machine()), 5);  // 50 mm at 10 mm/s
  line.feeds.push_back({1, 1800});
  EXPECT_DOUBLE_EQ(time_at_feeds(line, machine()), 2 + 1);
}

// s that are lost at the ends of a run at this speed, from rest to rest.
double ramps(double mm_per_s, double acceleration) { return mm_per_s / acceleration; }

TEST(LeastTime, OfALineIsItsLengthAtItsFeedWithTheWayUpToItAndDown) {
  const postproc::Run line = run_through({{0, 0, 0}, {20, 0, 0}, {50, 0, 0}});
  const double a = machine().axis(Axis::kX).acceleration;
  EXPECT_NEAR(least_time(line, 0.01, machine()), 5 + ramps(10, a), 1e-12);
}

TEST(LeastTime, CountsEachFeedForItsMotions) {
  postproc::Run line = run_through({{0, 0, 0}, {20, 0, 0}, {50, 0, 0}});
  line.feeds.push_back({1, 1800});
  const double a = machine().axis(Axis::kX).acceleration;
  // Up to 10 mm/s, from there to 30, and down.
  const double lost = 10 / a / 2 + (30.0 - 10) * (30 - 10) / (2 * a * 30) + 30 / a / 2;
  EXPECT_NEAR(least_time(line, 0.01, machine()), 2 + 1 + lost, 1e-12);
}

// A chord across a right corner that passes it at 0.1 mm is 2 * 0.1 * tan(22.5 deg) shorter.
TEST(LeastTime, LetsCornersBeCutByTheTolerance) {
  const postproc::Run corner = run_through({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}});
  const double a = machine().axis(Axis::kX).acceleration;
  EXPECT_NEAR(least_time(corner, 0.1, machine()),
              (20 - 0.2 * std::tan(M_PI / 8)) / 10 + ramps(10, a), 1e-12);
}

// Along the diagonal two axes share the way.
TEST(LeastTime, KnowsHowFastTheAxesAreTogether) {
  Machine slow = machine();
  for (Axis axis : {Axis::kX, Axis::kY}) slow.axis(axis).velocity = 5;
  const postproc::Run diagonal = run_through({{0, 0, 0}, {30, 30, 0}});
  const double a = std::sqrt(2) * slow.axis(Axis::kX).acceleration;
  const double speed = std::sqrt(2) * 5;
  EXPECT_NEAR(least_time(diagonal, 0.01, slow), 30 / 5.0 + ramps(speed, a), 1e-12);
  const double any =
      least_time(diagonal, 0.01, slow, {}, geometry::ToleranceKind::kPath, LimitsOf::kAnyDirection);
  EXPECT_LT(any, 30 / 5.0);
}

// Teeth of 0.05 mm every millimetre: the straight line through them is within the tolerance. But
// for half a tooth at either end, where nothing is cut, it takes no longer than that.
TEST(LeastTime, IsNoMoreThanThatOfTheLineThroughTeeth) {
  std::vector<Point3> teeth;
  for (int i = 0; i <= 100; ++i) teeth.emplace_back(i, i % 2 == 0 ? 0.05 : -0.05, 0);
  const double a = machine().axis(Axis::kX).acceleration;
  EXPECT_LE(least_time(run_through(teeth), 0.06, machine()),
            10.0 + ramps(10, a) + 2 * 0.5 * (std::sqrt(1.01) - 1) / 10 + 1e-9);
}

// --- sharp corners ---------------------------------------------------------------------------

// Two legs of 10 mm that turn by this, at 6000 mm/min.
postproc::Run corner_of(double turn) {
  const Point3 corner(10, 0, 0);
  return run_through({{0, 0, 0}, corner, corner + 10 * Point3(std::cos(turn), std::sin(turn), 0)},
                     6000);
}

// s, for such a corner rounded by an arc that leaves it by `far` (mm), whose bend alone limits the
// speed on it.
double rounded_time(double turn, double far, const Machine& machine) {
  const double half = turn / 2;
  const double radius = far / (1 / std::cos(half) - 1);
  const double a = machine.axis(Axis::kX).acceleration;
  const double speed = std::min(100.0, std::sqrt(a * radius));
  const double leg = 10 - radius * std::tan(half);
  const auto ramp = [&](double v) { return v * v / (2 * a); };  // mm, from rest
  const double peak = std::min(100.0, std::sqrt(a * (leg + ramp(speed))));
  const double at_feed = leg - 2 * ramp(peak) + ramp(speed);
  return 2 * ((2 * peak - speed) / a + std::max(0.0, at_feed) / peak) + radius * turn / speed;
}

class CornerBound : public testing::TestWithParam<const char*> {};

// It knows that something brakes there, and no more than what brakes an arc.
TEST_P(CornerBound, IsBetweenTheStraightWayAndAnArc) {
  const Machine machine = *find_machine(GetParam());
  const double straight = least_time(corner_of(1e-6), 0.01, machine);
  for (const double turn : {0.8, 1.5, 2.2, 2.8}) {
    SCOPED_TRACE(turn);
    const double least = least_time(corner_of(turn), 0.01, machine);
    EXPECT_GT(least, 1.01 * straight);
    // As far as the control rounds by itself on top of the tolerance.
    const double far = 0.01 + machine.blend_tolerance + machine.naive_cam_tolerance;
    EXPECT_LE(least, rounded_time(turn, far, machine));
    // In the band a circle may be as wide as it is on the path with more tolerance.
    const double wider = 0.01 * 2 / (1 + std::cos(turn / 2));
    const double in_band =
        least_time(corner_of(turn), 0.01, machine, {}, geometry::ToleranceKind::kBand);
    EXPECT_LE(in_band, least_time(corner_of(turn), wider, machine));
  }
}
INSTANTIATE_TEST_SUITE_P(Machines, CornerBound, testing::Values("linuxcnc", "mill"));

TEST(CornerBound, IsNoneWhereTheControlMayLeaveTheCornerOrShortBlocksRunOn) {
  const Machine linuxcnc = *find_machine("linuxcnc");
  gcode::PathControl path;
  const double least = least_time(corner_of(1.5), 0.01, linuxcnc, path);
  path.blend_tolerance = 0;  // G64 without P
  const double no_limit = least_time(corner_of(1.5), 0.01, linuxcnc, path);
  EXPECT_LT(no_limit, 0.99 * least);
  path.blend_tolerance = 1;
  EXPECT_LT(least_time(corner_of(1.5), 0.01, linuxcnc, path), least);
  const Machine router = *find_machine("router");
  EXPECT_LT(least_time(corner_of(1.5), 0.01, router),
            1.01 * least_time(corner_of(1e-6), 0.01, router));
}

// Edges that are shorter than the bend may be left out by it.
TEST(CornerBound, IsNoneOfTeethThatABendPasses) {
  const Machine machine = *find_machine("mill");
  std::vector<Point3> teeth;
  for (int i = 0; i <= 100; ++i) teeth.emplace_back(0.05 * i, i % 2 == 0 ? 0.01 : -0.01, 0);
  const postproc::Run flat = run_through({{0, 0, 0}, {5, 0, 0}}, 6000);
  EXPECT_LE(least_time(run_through(teeth, 6000), 0.02, machine),
            1.001 * least_time(flat, 0.02, machine));
}

// Chords of length c on a circle of radius r are c^2 / 8 r away from it.
TEST(CoarsePart, IsTheShareOfVerticesThatLeaveTheTolerance) {
  const postproc::Run run = run_through(half_circle(50));  // 0.00494 mm
  EXPECT_EQ(coarse_part(run, 0.0045), 1);
  EXPECT_EQ(coarse_part(run, 0.0055), 0);
}

// --- which methods are tried beside the first ----------------------------------------------------

TEST(CornersAreWorthTrying, OnRunsOfCornersWhereTimeIsLeftToWin) {
  EXPECT_TRUE(corners_are_worth_trying(1, 5, 10));
  EXPECT_FALSE(corners_are_worth_trying(1, 9.9, 10));
  EXPECT_FALSE(corners_are_worth_trying(0.1, 5, 10));
}

TEST(RoundingIsWorthTrying, WhereItsBoundLeavesTwoPerCent) {
  EXPECT_TRUE(rounding_is_worth_trying(9.75, 10));
  EXPECT_FALSE(rounding_is_worth_trying(9.85, 10));
}

// A quarter of a second, with half a millisecond for each point, and a tenth of the time.
TEST(TubeIsWorthTrying, WhereItsBoundLeavesWhatItsWorkCosts) {
  EXPECT_TRUE(tube_is_worth_trying(20, 0.7, 1));
  EXPECT_FALSE(tube_is_worth_trying(20, 0.8, 1));
  EXPECT_TRUE(tube_is_worth_trying(2000, 8.5, 10));
  EXPECT_FALSE(tube_is_worth_trying(2000, 9, 10));
  EXPECT_TRUE(tube_is_worth_trying(20, 89, 100));
  EXPECT_FALSE(tube_is_worth_trying(20, 91, 100));
}

// Where the control rounds corners itself, no curve through them wins what the search costs.
TEST(SearchesAreWorthTrying, WhereRoundingHasWonTimeAndMoreIsLeft) {
  EXPECT_TRUE(searches_are_worth_trying(20, 5, 10, 9.8));
  EXPECT_FALSE(searches_are_worth_trying(20, 5, 10, 9.95));
  EXPECT_FALSE(searches_are_worth_trying(20, 9.7, 10, 9.8));
  EXPECT_FALSE(searches_are_worth_trying(20, 0.1, 0.5, 0.4));
}

// A search for each corner of a program of 149 lines, three runs of some eighty corners, took 5 s:
// found by the fuzzer of the whole pipeline, 38 s under its sanitizers.
TEST(SearchesAreWorthTrying, NotOnARunOfManyCorners) {
  EXPECT_FALSE(searches_are_worth_trying(80, 5, 10, 9.8));
}

}  // namespace
}  // namespace batten::postproc
