// Times of chains: closed forms and properties of every model, the planner of grbl, chains that are
// asked more than once. What LinuxCNC alone does is in linuxcnc_model_test.cpp.
#include "postproc/machine/models/cycle_time.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "tests/support/machine_limits.h"
#include "tests/support/processor_time.h"

namespace batten::postproc {
namespace {

using gcode::PathMode;
using geometry::Arc;
using geometry::Line;
using geometry::PathPiece;
using geometry::Point3;
using geometry::Vector3;
using std::numbers::pi;

constexpr double kFeed = 6000;  // mm/min: 100 mm/s

// Limits that a test turns.
using Limit = void (*)(Machine&, double factor);
void velocity(Machine& m, double factor) { set_max_velocity(m, factor * m.max_velocity()); }
void acceleration(Machine& m, double factor) {
  set_max_acceleration(m, factor * m.max_acceleration());
}
void block_period(Machine& m, double factor) { m.block_period *= factor; }
void junction_deviation(Machine& m, double factor) { m.junction_deviation *= factor; }

double time_of(const std::vector<TimedPiece>& pieces, const Machine& m,
               PathMode path = PathMode::kBlending) {
  return cutting_time(pieces, m, path);
}

TimedPiece line(const Point3& from, const Point3& to, double feed = kFeed) {
  return {Line{from, to}, feed};
}

TimedPiece half_circle(double radius, double from_angle, double feed = kFeed) {
  const Point3 start(radius * std::cos(from_angle), radius * std::sin(from_angle), 0);
  return {Arc{start, -start, Point3::Zero(), Vector3::UnitZ(), pi}, feed};
}

class EveryModel : public testing::TestWithParam<ControllerModel> {};

INSTANTIATE_TEST_SUITE_P(CuttingTime, EveryModel, testing::ValuesIn(kModels), model_name);

TEST_P(EveryModel, TimesALineAsATrapezoidOrATriangle) {
  const double root = std::sqrt(2.0);
  const struct {
    TimedPiece piece;
    double seconds;
    const char* why;
  } rows[] = {
      {line({0, 0, 0}, {50, 0, 0}), 0.6, "100 mm/s in .1 s and 5 mm: .1 + (50 - 10) / 100 + .1"},
      {line({0, 0, 0}, {0, 0, 2.5}), 0.1, "half of it in sqrt(2.5 / 1000) s, below 100 mm/s"},
      {line({0, 0, 0}, {50, -50, 0}), 50 * root / 100 + 100 / (1000 * root),
       "along the diagonal two axes share the acceleration: 1000 sqrt(2)"},
      {line({0, 0, 0}, {100, 0, 0}, 60000), 0.7, "no faster than the axis: 200 mm/s in .2 s"},
      {line({0, 0, 0}, {100, 0, 0}, 0), 0.7, "no feed: as fast as the machine cuts"}};
  const Machine m = machine_of(GetParam());
  for (const auto& [piece, seconds, why] : rows) {
    EXPECT_NEAR(time_of({piece}, m), seconds + stop_loss(m), 1e-12) << why;
  }
}

TEST_P(EveryModel, TakesCollinearLinesAsOne) {
  const Machine m = machine_of(GetParam());
  const Point3 a(1, 2, 3);
  const Point3 b(31, 22, -7);
  const double whole = time_of({line(a, b)}, m);
  std::vector<TimedPiece> parts;
  constexpr int kParts = 10;
  for (int i = 0; i < kParts; ++i) {
    parts.push_back(line(a + (b - a) * i / kParts, a + (b - a) * (i + 1) / kParts));
  }
  EXPECT_NEAR(time_of(parts, m), whole, 1e-9);
}

TEST_P(EveryModel, StopsBetweenBlocksUnderExactStop) {
  const Machine m = machine_of(GetParam());
  const TimedPiece first = line({0, 0, 0}, {30, 0, 0});
  const TimedPiece second = line({30, 0, 0}, {50, 0, 0});
  const double alone = time_of({first}, m) + time_of({second}, m);
  EXPECT_NEAR(time_of({first, second}, m, PathMode::kExactStop), alone, 1e-12);
  EXPECT_LT(time_of({first, second}, m), alone - 0.05);
}

// G61 keeps the path, which is a stop only on a control that has no other way to.
TEST_P(EveryModel, StopsAtBlockEndsAsItsControlSays) {
  const Machine m = machine_of(GetParam());
  EXPECT_TRUE(stops_at_block_ends(m, PathMode::kExactStop));
  EXPECT_EQ(stops_at_block_ends(m, PathMode::kExactPath),
            GetParam() == ControllerModel::kLookAhead);
  EXPECT_FALSE(stops_at_block_ends(m, PathMode::kBlending));
}

TEST_P(EveryModel, TakesNoTimeForNothing) {
  const Machine m = machine_of(GetParam());
  EXPECT_EQ(time_of({}, m), 0);
  EXPECT_EQ(time_of({line({1, 1, 1}, {1, 1, 1})}, m), 0);
  const TimedPiece real = line({0, 0, 0}, {30, 0, 0});
  EXPECT_EQ(time_of({line({0, 0, 0}, {0, 0, 0}), real}, m), time_of({real}, m));
}

TEST_P(EveryModel, SlowsDownForShortBlocks) {
  Machine m = machine_of(GetParam());
  m.block_period = 0.004;
  std::vector<TimedPiece> parts;
  for (int i = 0; i < 1000; ++i) parts.push_back(line({0.1 * i, 0, 0}, {0.1 * (i + 1), 0, 0}));
  const double time = time_of(parts, m);
  EXPECT_GE(time, 1000 * 0.004);
  EXPECT_LE(time, 1000 * 0.004 * 1.02 + 0.1) << "LinuxCNC keeps 2 % of reserve";
}

// Leads of cut runs begin in the midst of a block.
TEST_P(EveryModel, TakesAPieceThatGoesOnWithoutItsBlockForABlock) {
  const Machine m = machine_of(GetParam());
  TimedPiece piece = line({0, 0, 0}, {30, 0, 0});
  const double time = time_of({piece}, m);
  piece.goes_on = true;
  EXPECT_EQ(time_of({piece}, m), time);
}

// With N blocks of .2 mm ahead the speed is at most sqrt(2 a N .2): 77.5 mm/s at N = 15.
TEST_P(EveryModel, BrakesForTheEndOfTheLookAhead) {
  Machine m = machine_of(GetParam());
  m.look_ahead = 15;
  std::vector<TimedPiece> parts;
  for (int i = 0; i < 3000; ++i) parts.push_back(line({0.2 * i, 0, 0}, {0.2 * (i + 1), 0, 0}));
  const double velocity = std::sqrt(2 * 1000 * 15 * 0.2);
  const double time = time_of(parts, m);
  EXPECT_GE(time, 600 / velocity);
  EXPECT_LE(time, 600 / velocity * 1.05);
  m.look_ahead = 1000;
  EXPECT_NEAR(time_of(parts, m), 6.1, 0.002) << "6 s at 100 mm/s and .1 s of ramps";
}

TEST_P(EveryModel, RefusesLimitsThatCannotMove) {
  const std::vector<TimedPiece> one = {line({0, 0, 0}, {1, 0, 0})};
  for (const Limit limit : {velocity, acceleration, block_period}) {
    for (const double factor : {0.0, std::nan("")}) {
      Machine m = machine_of(GetParam());
      limit(m, factor);
      EXPECT_THROW((void)time_of(one, m), std::invalid_argument);
    }
  }
  const Machine m = machine_of(GetParam());
  EXPECT_THROW((void)time_of({line({0, 0, 0}, {1, 0, 0}, -1)}, m), std::invalid_argument);
}

// --- bends --------------------------------------------------------------------------------

// Speeding up on a bend leaves sqrt(a^2 - (v^2 / r)^2) along the path. Integrated here in
// small steps of time; the model has it in closed form for the way and by quadrature.
TEST(LookAheadTime, SharesTheAccelerationOfABend) {
  const Machine m = machine_of(ControllerModel::kLookAhead);
  const double radius = 10;
  const double limit = std::sqrt(std::sqrt(3.0) / 2 * 1000 * radius);  // 93 mm/s
  double v = 0;
  double way = 0;
  double time = 0;
  constexpr double kStep = 1e-7;
  while (v < limit) {
    const double normal = v * v / radius;
    const double next = v + std::sqrt(1000.0 * 1000 - normal * normal) * kStep;
    way += (v + next) / 2 * kStep;
    v = next;
    time += kStep;
  }
  const double expected = 2 * time + (2 * pi * radius - 2 * way) / limit;
  const std::vector<TimedPiece> circle = {half_circle(radius, 0), half_circle(radius, pi)};
  EXPECT_NEAR(time_of(circle, m), expected, 1e-5);
}

// A cubic Bezier piece that runs straight and evenly is a line. LinuxCNC runs short parts at
// one acceleration each, which costs .2 ms here.
TEST_P(EveryModel, TimesAStraightBezierPieceAsALine) {
  const Machine m = machine_of(GetParam());
  const geometry::CubicBezier straight{{{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {30, 0, 0}}};
  EXPECT_NEAR(time_of({{straight, kFeed}}, m), time_of({line({0, 0, 0}, {30, 0, 0})}, m), 5e-4);
}

// The usual quarter of a circle by Bezier, 0.5522847 of the radius, is 3e-4 of it off.
TEST_P(EveryModel, TimesARoundBezierPieceAsAnArc) {
  const Machine m = machine_of(GetParam());
  const double k = 20 * 0.5522847498;
  const geometry::CubicBezier quarter{{{20, 0, 0}, {20, k, 0}, {k, 20, 0}, {0, 20, 0}}};
  const Arc arc{{20, 0, 0}, {0, 20, 0}, {0, 0, 0}, Vector3::UnitZ(), pi / 2};
  const double expected = time_of({{arc, kFeed}}, m);
  EXPECT_NEAR(time_of({{quarter, kFeed}}, m), expected, 0.02 * expected);
}

// A bend that is sharp in one place is slow there alone: a piece takes as long as its 64 parts, one
// of the length of them all with its greatest curvature would take far longer.
TEST(LookAheadTime, OfAPieceThatBendsUnevenlyIsThatOfItsParts) {
  Machine m = machine_of(ControllerModel::kLookAhead);
  m.block_period = 1e-9;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-15, 15);
  for (int i = 0; i < 100; ++i) {
    geometry::CubicBezier bend;
    for (Point3& point : bend.control) point = {place(random), place(random), place(random)};
    std::vector<TimedPiece> parts;
    constexpr int kParts = 64;
    for (int k = 0; k < kParts; ++k) {
      parts.push_back(
          {geometry::sub_piece(PathPiece(bend), double(k) / kParts, double(k + 1) / kParts),
           kFeed});
    }
    const double expected = time_of(parts, m);
    EXPECT_NEAR(time_of({{bend, kFeed}}, m), expected, 0.1 * expected) << i;
  }
}

// --- corners ------------------------------------------------------------------------------

// At 90 degrees X stops and Y starts: each changes by v, at most a T = 1 mm/s.
// From rest to 100 and down to 1: (100 - 1) / 1000 s and (100^2 - 1) / 2000 mm.
TEST(LookAheadTime, PassesACornerByTheAccelerationOfTheAxes) {
  const Machine m = machine_of(ControllerModel::kLookAhead);
  const double down_way = (100.0 * 100 - 1) / 2000;
  const double one = 0.1 + 0.099 + (30 - 5 - down_way) / 100;
  EXPECT_NEAR(time_of({line({0, 0, 0}, {30, 0, 0}), line({30, 0, 0}, {30, 30, 0})}, m), 2 * one,
              1e-12);
}

// r = 10, tolerance .002: half a chord is sqrt(.002 (20 - .002)) = .19999 mm, so that a half
// circle has floor(10 pi / 2 / .19999) = 78 chords.
TEST(GrblTime, CutsArcsIntoChords) {
  const Machine m = machine_of(ControllerModel::kGrbl);
  std::vector<TimedPiece> chords;
  constexpr int kChords = 78;
  const TimedPiece arc = half_circle(10, 0);
  for (int i = 0; i < kChords; ++i) {
    chords.push_back(line(geometry::point_at(arc.piece, double(i) / kChords),
                          geometry::point_at(arc.piece, double(i + 1) / kChords)));
  }
  EXPECT_NEAR(time_of({arc}, m), time_of(chords, m), 1e-9);
  chords.pop_back();
  EXPECT_GT(std::abs(time_of({arc}, m) - time_of(chords, m)), 1e-4);
}

TEST_P(EveryModel, TurnsBackOnlyAtRest) {
  const Machine m = machine_of(GetParam());
  const TimedPiece there = line({0, 0, 0}, {30, 0, 0});
  const TimedPiece back = line({30, 0, 0}, {0, 0, 0});
  const double alone = time_of({there}, m) + time_of({back}, m);
  // The corner speed of the look-ahead model is a T / 2 = .5 mm/s here: .5 ms twice.
  EXPECT_NEAR(time_of({there, back}, m), alone, 0.0011);
}

// --- properties ---------------------------------------------------------------------------

// Lines and arcs in a row, some tangent, some not, from .2 to 8 mm, with changing feeds.
std::vector<TimedPiece> random_chain(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<TimedPiece> chain;
  Point3 at = Point3::Zero();
  double heading = 0;
  const int pieces = 5 + static_cast<int>(unit(random) * 60);
  for (int i = 0; i < pieces; ++i) {
    if (unit(random) < 0.5) heading += (unit(random) - 0.5) * 2;
    const double feed = 600 + 12000 * unit(random);
    const Vector3 forward(std::cos(heading), std::sin(heading), 0);
    if (unit(random) < 0.5) {
      const Point3 to =
          at + (0.2 + 8 * unit(random) * unit(random)) * forward + Vector3(0, 0, unit(random));
      chain.push_back(line(at, to, feed));
      at = to;
    } else {
      const double radius = 0.5 + 10 * unit(random);
      const double sweep = (unit(random) < 0.5 ? -1 : 1) * (0.2 + unit(random));
      const Vector3 left(-forward.y(), forward.x(), 0);
      const Point3 center = at + (sweep > 0 ? radius : -radius) * left;
      const Vector3 from = at - center;
      const Point3 to =
          center + Vector3(from.x() * std::cos(sweep) - from.y() * std::sin(sweep),
                           from.x() * std::sin(sweep) + from.y() * std::cos(sweep), 0);
      chain.push_back({Arc{at, to, center, Vector3::UnitZ(), sweep}, feed});
      at = to;
      heading += sweep;
    }
  }
  return chain;
}

PathPiece backward(const PathPiece& piece) {
  if (const auto* l = std::get_if<Line>(&piece)) return Line{l->end, l->start};
  Arc arc = std::get<Arc>(piece);
  std::swap(arc.start, arc.end);
  arc.sweep = -arc.sweep;
  return arc;
}

PathPiece scaled(const PathPiece& piece, double by) {
  if (const auto* l = std::get_if<Line>(&piece)) return Line{l->start * by, l->end * by};
  Arc arc = std::get<Arc>(piece);
  arc.start *= by;
  arc.end *= by;
  arc.center *= by;
  return arc;
}

constexpr unsigned kChains = 150;

// Models whose rules promise it. LinuxCNC gives arcs less acceleration where its limit of
// speed is higher.
class MonotoneModel : public EveryModel {};
INSTANTIATE_TEST_SUITE_P(CuttingTime, MonotoneModel,
                         testing::Values(ControllerModel::kLookAhead, ControllerModel::kGrbl));

TEST_P(MonotoneModel, NeverTakesLongerWhenALimitRises) {
  const Machine m = machine_of(GetParam());
  for (unsigned seed = 0; seed < kChains; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::vector<TimedPiece> chain = random_chain(seed);
    const double time = time_of(chain, m);
    for (const Limit limit : {velocity, acceleration, junction_deviation}) {
      for (const double factor : {1.01, 1.5, 4.0}) {
        Machine better = m;
        limit(better, factor);
        EXPECT_LE(time_of(chain, better), time + 1e-9);
      }
    }
    Machine better = m;
    better.block_period /= 2;
    // The corner speed of the look-ahead model is what one period allows.
    if (m.model == ControllerModel::kGrbl) {
      EXPECT_LE(time_of(chain, better), time + 1e-9);
    }
    better = m;
    better.look_ahead = 3;
    EXPECT_GE(time_of(chain, better), time - 1e-9);
    for (TimedPiece& p : chain) p.feed *= 1.3;
    EXPECT_LE(time_of(chain, m), time + 1e-9);
  }
}

TEST_P(MonotoneModel, TakesTheSameTimeBackward) {
  const Machine m = machine_of(GetParam());
  for (unsigned seed = 0; seed < kChains; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::vector<TimedPiece> chain = random_chain(seed);
    std::vector<TimedPiece> reversed;
    for (auto it = chain.rbegin(); it != chain.rend(); ++it) {
      reversed.push_back({backward(it->piece), it->feed});
    }
    EXPECT_NEAR(time_of(reversed, m), time_of(chain, m), 1e-6);
  }
}

// Lengths, speeds and accelerations of another size, the clock the same.
TEST_P(EveryModel, TakesTheSameTimeInAnyUnitOfLength) {
  const Machine m = machine_of(GetParam());
  constexpr double kBy = 25.4;
  Machine big = m;
  velocity(big, kBy);
  acceleration(big, kBy);
  for (double Machine::*length : {&Machine::junction_deviation, &Machine::arc_tolerance,
                                  &Machine::blend_tolerance, &Machine::naive_cam_tolerance}) {
    big.*length *= kBy;
  }
  for (unsigned seed = 0; seed < kChains; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::vector<TimedPiece> chain = random_chain(seed);
    const double time = time_of(chain, m);
    for (TimedPiece& p : chain) p = {scaled(p.piece, kBy), p.feed * kBy};
    EXPECT_NEAR(time_of(chain, big), time, 1e-6);
  }
}

TEST_P(EveryModel, IsNeverFasterThanTheFeed) {
  const Machine m = machine_of(GetParam());
  for (unsigned seed = 0; seed < kChains; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::vector<TimedPiece> chain = random_chain(seed);
    double least = 0;
    for (const TimedPiece& p : chain) least += geometry::length_of(p.piece) / (p.feed / 60);
    // Blended corners and chords are shorter than the path.
    EXPECT_GE(time_of(chain, m), 0.97 * least);
    EXPECT_GE(time_of(chain, m, PathMode::kExactPath), 0.999 * least);
    // Not so on LinuxCNC: where it overlaps two moves, each has half the acceleration, which
    // can cost more than a stop.
    if (m.model != ControllerModel::kLinuxcnc) {
      EXPECT_GE(time_of(chain, m, PathMode::kExactStop), time_of(chain, m) - 1e-9);
    }
  }
}

// Eight times the pieces take about eight times as long to plan; a quadratic step would
// take 64 times. The best of three runs, and a factor of 3 for a busy computer; chains too
// long for the caches in both cases.
TEST_P(EveryModel, CostsLinearTime) {
  const Machine m = machine_of(GetParam());
  const auto seconds = [&](int pieces) {
    std::vector<TimedPiece> chain;
    for (int i = 0; i < pieces; ++i) {
      chain.push_back(line({0.3 * i, 0.01 * (i % 2), 0}, {0.3 * (i + 1), 0.01 * ((i + 1) % 2), 0}));
    }
    double best = 1e9;
    for (int run = 0; run < 3; ++run) {
      const double begin = processor_seconds();
      EXPECT_GT(time_of(chain, m), 0);
      best = std::min(best, processor_seconds() - begin);
    }
    return best;
  };
  const double small = seconds(30000);
  EXPECT_LT(seconds(240000), 8 * 3 * small);
}

// --- grbl's planner where it has a closed form: a corner, its window -----------------------------

constexpr double kRouterAcceleration = 250;  // mm/s^2 of each axis

Machine router() {
  Machine m = machine_of(ControllerModel::kGrbl);
  set_max_velocity(m, 80);
  set_max_acceleration(m, kRouterAcceleration);
  m.junction_deviation = 0.012;
  m.block_period = 1e-9;  // nothing that feeds it is a limit here
  m.look_ahead = 15;
  return m;
}

// A corner that turns by `turn`: v^2 = a d sin(t/2) / (1 - sin(t/2)) with t the angle between the
// lines, and a the acceleration along the change of direction.
class GrblCorner : public testing::TestWithParam<int> {};

TEST_P(GrblCorner, IsPassedAtItsJunctionSpeed) {
  const double turn = GetParam() * pi / 180;
  const Machine m = router();
  const double sin_half = std::cos(turn / 2);
  // From (1, 0) to (cos, sin): the change is along (cos - 1, sin), normalised; the first line
  // runs along X, the second in the plane.
  const double cx = std::abs(std::cos(turn) - 1);
  const double sy = std::abs(std::sin(turn));
  const double norm = std::hypot(cx, sy);
  const double corner_acceleration = kRouterAcceleration / (std::max(cx, sy) / norm);
  const double junction =
      std::sqrt(corner_acceleration * m.junction_deviation * sin_half / (1 - sin_half));
  const double feed = 40;  // mm/s
  const double corner = std::min(junction, feed);
  const double along = std::max(std::abs(std::cos(turn)), std::abs(std::sin(turn)));
  const auto side = [&](double a, double length) {
    const double up = feed * feed / (2 * a);
    const double down = (feed * feed - corner * corner) / (2 * a);
    return feed / a + (feed - corner) / a + (length - up - down) / feed;
  };
  const Point3 tip(30, 0, 0);
  const Point3 end = tip + 30 * Point3(std::cos(turn), std::sin(turn), 0);
  EXPECT_NEAR(time_of({{Line{{0, 0, 0}, tip}, feed * 60}, {Line{tip, end}, feed * 60}}, m),
              side(kRouterAcceleration, 30) + side(kRouterAcceleration / along, 30), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(GrblPlanner, GrblCorner, testing::Values(2, 10, 30, 45, 60, 90, 120, 150),
                         [](const auto& test) { return "Turn" + std::to_string(test.param); });

// The planner holds 15 blocks, the one that runs among them, and must be able to stop at the end
// of the last: behind a block there are 14 of length L, so its end is passed at
// sqrt(2 a 14 L) at most. Each block starts and ends at that speed; in between it speeds up and
// slows down again. The first 14 and the last 14 blocks are one ramp each.
TEST(GrblPlanner, BrakesForTheEndOfItsSixteenBlocks) {
  constexpr double kLength = 0.1;
  constexpr int kBlocks = 500;
  constexpr int kAhead = 14;
  std::vector<TimedPiece> blocks;
  for (int i = 0; i < kBlocks; ++i) {
    blocks.push_back({Line{{kLength * i, 0, 0}, {kLength * (i + 1), 0, 0}}, 60000});
  }
  const double window = std::sqrt(2 * kRouterAcceleration * kAhead * kLength);
  const double peak = std::sqrt(window * window + kRouterAcceleration * kLength);
  const double expected = 2 * window / kRouterAcceleration +
                          (kBlocks - 2 * kAhead) * 2 * (peak - window) / kRouterAcceleration;
  EXPECT_NEAR(time_of(blocks, router()), expected, 1e-6);
}

// grbl computes lengths and directions from the whole steps of the ends: a program takes as long as
// one whose ends lie there. With 250 steps/mm, y = 0.0021 is one step (0.004 mm), y = 0.0019 none.
TEST(GrblPlanner, RunsBetweenEndsOnWholeSteps) {
  Machine m = router();
  const Machine exact = m;
  set_xyz(m, &AxisLimits::steps, 250);
  const auto bend_to = [](double y) {
    return std::vector{line({0, 0, 0}, {10, 0, 0}), line({10, 0, 0}, {20, y, 0})};
  };
  EXPECT_EQ(time_of(bend_to(0.0019), m), time_of(bend_to(0), exact));
  EXPECT_EQ(time_of(bend_to(-0.0019), m), time_of(bend_to(0), exact));
  EXPECT_EQ(time_of(bend_to(0.0021), m), time_of(bend_to(0.004), exact));
  EXPECT_EQ(time_of(bend_to(-0.0021), m), time_of(bend_to(-0.004), exact));
  EXPECT_GT(time_of(bend_to(6), exact), time_of(bend_to(0), exact) + 1e-3);
}

// Nine moves of a tenth of a step and one of nine tenths are one step.
TEST(GrblPlanner, MakesNoMoveOfNoStep) {
  Machine m = router();
  set_xyz(m, &AxisLimits::steps, 10);
  std::vector<TimedPiece> blocks;
  for (int i = 0; i < 10; ++i) blocks.push_back(line({0.01 * i, 0, 0}, {0.01 * (i + 1), 0, 0}));
  EXPECT_NEAR(time_of(blocks, m), time_of({line({0, 0, 0}, {0.1, 0, 0})}, m), 1e-12);
  EXPECT_EQ(time_of({line({0, 0, 0}, {0.04, 0.04, -0.04})}, m), 0);
}

// Of nine full circles with end = start the real grbl ran six, grblHAL all: line 21 of
// arcs_tiny_f600, a radius of 0.02 mm, is one that grbl lost.
TEST(GrblPlanner, LosesFullCirclesThatItsSinglePrecisionTakesForNothing) {
  Machine m = router();
  int lost = 0;
  for (int i = 0; i < 200; ++i) {
    const Point3 at(2.3685 + 0.7731 * i, -0.5577 - 0.0013 * i, 0);
    const TimedPiece circle{
        geometry::Arc{at, at, at + Point3(-0.0035, -0.0197, 0), geometry::Vector3::UnitZ(), 2 * pi},
        600};
    m.model = ControllerModel::kGrblhal;
    EXPECT_GT(time_of({circle}, m), 0.01);
    m.model = ControllerModel::kGrbl;
    if (time_of({circle}, m) == 0) ++lost;
  }
  EXPECT_GT(lost, 20);
  EXPECT_LT(lost, 180);
  // Half circles are safe.
  const Point3 at(3, 0, 0);
  const geometry::Arc half{at, at + Point3(0, 0.04, 0), at + Point3(0, 0.02, 0),
                           geometry::Vector3::UnitZ(), pi};
  EXPECT_GT(time_of({TimedPiece{half, 600}}, m), 0.01);
}

// --- what a chain keeps from one question to the next changes no answer --------------------------

TEST(TimedChain, GivesTheTimesOfCuttingTime) {
  for (const char* name : {"linuxcnc", "router", "grbl"}) {
    const Machine& machine = *find_machine(name);
    for (unsigned seed = 0; seed < 5; ++seed) {
      SCOPED_TRACE(testing::Message() << name << " " << seed);
      std::vector<TimedPiece> pieces = random_chain(seed);
      for (TimedPiece& piece : pieces) piece.bytes = 12;
      pieces[2].feed = 0;
      pieces.insert(pieces.begin() + 3, line({1, 1, 1}, {1, 1, 1}));
      TimedChain chain(pieces, machine);
      gcode::PathControl unmerged = PathMode::kBlending;
      unmerged.naive_cam_tolerance = 0;
      for (const gcode::PathControl& path : {gcode::PathControl(PathMode::kBlending),
                                             gcode::PathControl(PathMode::kExactPath), unmerged}) {
        EXPECT_EQ(chain.time(path), cutting_time(pieces, machine, path));
        EXPECT_EQ(chain.time(path, ChainEnd::kEndOfMotion),
                  cutting_time(pieces, machine, path, ChainEnd::kEndOfMotion));
      }
      std::vector<TimedPiece> slower = pieces;
      for (TimedPiece& piece : slower) piece.feed *= 0.5;
      EXPECT_EQ(TimedChain(pieces, machine, 0.5).time(PathMode::kBlending),
                cutting_time(slower, machine, PathMode::kBlending));
    }
  }
}

}  // namespace
}  // namespace batten::postproc
