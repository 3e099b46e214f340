// Klipper's planner where it has a closed form: a move from rest to rest, corners, circles of
// chords, the minimum cruise ratio; and what the real one took.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::Line;
using geometry::Point3;
using std::numbers::pi;

// max_velocity 83.33, max_accel 400; square_corner_velocity 5, minimum_cruise_ratio 0.5.
Machine klipper(double velocity = 83.33, double acceleration = 400, double ratio = 0.5) {
  Machine m = *find_machine("klipper-router");
  m.path_feed = velocity;
  m.path_acceleration = acceleration;
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
    m.axis(axis).velocity = velocity;
    m.axis(axis).acceleration = acceleration;
  }
  m.minimum_cruise_ratio = ratio;
  m.block_period = 1e-6;
  return m;
}

double seconds(const std::vector<TimedPiece>& pieces, const Machine& m) {
  return cutting_time(pieces, m, gcode::PathMode::kBlending);
}

TimedPiece move(const Point3& from, const Point3& to, double feed = 3000) {
  return {Line{from, to}, feed};
}

std::vector<TimedPiece> through(const std::vector<Point3>& points, double feed = 3000) {
  std::vector<TimedPiece> pieces;
  for (std::size_t i = 1; i < points.size(); ++i) {
    pieces.push_back(move(points[i - 1], points[i], feed));
  }
  return pieces;
}

// ../shared/firmware, settings S, T and M: seconds that Klipper's own code took, to four digits.
TEST(KlipperModel, TakesAsLongAsTheRealOne) {
  const std::vector<TimedPiece> straight = through({{0, 0, 0}, {100, 0, 0}});
  const std::vector<TimedPiece> corner = through({{0, 0, 0}, {50, 0, 0}, {50, 50, 0}});
  Machine milder = klipper(83.33, 400, 0);
  milder.square_corner_velocity = 3.1075;
  EXPECT_NEAR(seconds(straight, klipper(300, 3000)), 2.0167, 6e-5);
  EXPECT_NEAR(seconds(straight, klipper()), 2.1250, 6e-5);
  EXPECT_NEAR(seconds(straight, milder), 2.1250, 6e-5);
  EXPECT_NEAR(seconds(corner, klipper(300, 3000)), 2.0302, 6e-5);
  EXPECT_NEAR(seconds(corner, klipper()), 2.2262, 6e-5);
  EXPECT_NEAR(seconds(corner, milder), 2.2349, 6e-5);
}

// From rest to rest over d the speed stays below sqrt(a' d) with a' = a (1 - ratio); it rises and
// falls with all of a.
TEST(KlipperModel, CruisesAlongAShortMove) {
  for (const double ratio : {0.0, 0.3, 0.5, 0.9}) {
    const double d = 2;
    const double peak = std::sqrt(400 * (1 - ratio) * d);
    EXPECT_NEAR(seconds(through({{0, 0, 0}, {d, 0, 0}}, 60000), klipper(83.33, 400, ratio)),
                2 * peak / 400 + (d - peak * peak / 400) / peak, 1e-12)
        << ratio;
  }
}

// A straight line in pieces is the same motion, wherever it is cut.
TEST(KlipperModel, DoesNotMindWhereALineIsCut) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 50; ++i) {
    const double d = 1 + 30 * unit(random);
    std::vector<Point3> points = {{0, 0, 0}};
    while (points.back().x() < d) {
      points.emplace_back(std::min(d, points.back().x() + 0.01 + unit(random)), 0, 0);
    }
    EXPECT_NEAR(seconds(through(points, 6000), klipper()),
                seconds(through({{0, 0, 0}, {d, 0, 0}}, 6000), klipper()), 1e-9);
  }
}

// The circle that rounds a corner must touch both moves before their middle: along chords of a
// circle of radius r that turn by phi that is v^2 = a r cos(phi / 2), a speed that grbl's junction
// deviation alone would let pass.
TEST(KlipperModel, RunsChordsOfACircleAsFastAsTheCircleAllows) {
  const double r = 1;
  constexpr int kChords = 36;
  std::vector<Point3> points;
  for (int i = 0; i <= 40 * kChords; ++i) {
    const double angle = 2 * pi * i / kChords;
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
  }
  const double speed = std::sqrt(400 * r * std::cos(pi / kChords));
  const double length = 40 * kChords * 2 * r * std::sin(pi / kChords);
  // A chord of 0.17 mm leaves little to speed up in between; the ends take v / a more.
  EXPECT_NEAR(seconds(through(points, 60000), klipper(83.33, 400, 0.99)),
              length / speed + speed / 400, 0.01 * length / speed);
  EXPECT_LT(seconds(through(points, 60000), klipper(83.33, 400, 0)),
            seconds(through(points, 60000), klipper(83.33, 400, 0.99)));
}

// A turn back is a stop: as two moves by themselves.
TEST(KlipperModel, TurnsBackAtRest) {
  const std::vector<TimedPiece> there = through({{0, 0, 0}, {30, 0, 0}});
  EXPECT_NEAR(seconds(through({{0, 0, 0}, {30, 0, 0}, {0, 0, 0}}), klipper()),
              2 * seconds(there, klipper()), 1e-9);
}

// max_z_velocity and max_z_accel hold for the Z part of a move: at a slope of 3 to 4 the path may
// have 5/3 of them.
TEST(KlipperModel, KeepsTheLimitsOfZ) {
  Machine m = klipper();
  m.axis(Axis::kZ).velocity = 6;
  m.axis(Axis::kZ).acceleration = 60;
  EXPECT_NEAR(seconds(through({{0, 0, 0}, {40, 0, 30}}, 6000), m), 50 / 10.0 + 10 / 100.0, 1e-9);
}

// It has no rapids: G0 runs at the last F, and at 25 mm/s before the first.
TEST(KlipperModel, RunsG0AtTheLastFeed) {
  TimedPiece rapid = move({0, 0, 0}, {100, 0, 0}, 1200);
  const double cut = seconds({rapid}, klipper());
  rapid.rapid = true;
  EXPECT_EQ(seconds({rapid}, klipper()), cut);
  rapid.feed = 0;
  EXPECT_NEAR(seconds({rapid}, klipper()), 100 / 25.0 + 25 / 400.0, 1e-9);
}

// A quarter of r = 5 is 7.85 mm: at a resolution of 1 mm that is 7 chords.
TEST(KlipperModel, CutsArcsIntoChordsOfItsResolution) {
  const Arc arc{{5, 0, 0}, {0, 5, 0}, Point3::Zero(), geometry::Vector3::UnitZ(), pi / 2};
  std::vector<Point3> points;
  for (int i = 0; i <= 7; ++i) points.push_back(geometry::point_at(arc, i / 7.0));
  EXPECT_NEAR(seconds({{arc, 3000}}, klipper()), seconds(through(points), klipper()), 1e-9);
  Machine fine = klipper();
  fine.arc_resolution = 0.1;
  EXPECT_GT(std::abs(seconds({{arc, 3000}}, fine) - seconds({{arc, 3000}}, klipper())), 1e-4);
}

// The real one made no motion of `G3 X49.7413 Y-6.9536 I-0.3473 J-1.9696` with X and Y the place
// where it was: rounding left an angle of some 1e-16. Two half circles are safe.
TEST(KlipperModel, LosesAFullCircleThatRoundsToNothing) {
  const Point3 at(49.7413, -6.9536, 0);
  const Point3 center(49.7413 - 0.3473, -6.9536 - 1.9696, 0);
  const geometry::Vector3 axis = geometry::Vector3::UnitZ();
  EXPECT_EQ(seconds({{Arc{at, at, center, axis, 2 * pi}, 600}}, klipper()), 0);
  EXPECT_GT(seconds({{Arc{at, 2 * center - at, center, axis, pi}, 600}}, klipper()), 0.5);
}

}  // namespace
}  // namespace batten::postproc
