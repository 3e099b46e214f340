// What LinuxCNC does: seconds measured on the real control (2.9.0~pre1, simulated axes, 1 ms;
// tests/bench/compare_with_linuxcnc.py), closed forms, and the joining of lines.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "postproc/machine/models/cycle_time.h"
#include "tests/support/machine_limits.h"

namespace batten::postproc {
namespace {

using gcode::PathMode;
using geometry::Arc;
using geometry::Point3;
using geometry::Vector3;
using std::numbers::pi;

using Chain = std::vector<TimedPiece>;

Machine bench_machine(double tolerance) {
  Machine m = *find_machine("linuxcnc-fast");
  set_max_velocity(m, 400);
  set_max_acceleration(m, 4000);
  m.block_period = 0.001;
  m.blend_tolerance = tolerance;
  m.naive_cam_tolerance = tolerance;
  return m;
}

// The moves of a program at one feed, from 0,0,0.
class Program {
 public:
  explicit Program(double feed) : feed_(feed) {}

  Program& line(double x, double y, double z = 0) {
    const Point3 to(x, y, z);
    chain_.push_back({geometry::Line{at_, to}, feed_});
    at_ = to;
    return *this;
  }

  // In the plane of X and Y, with the centre as an offset from the start.
  Program& arc(double x, double y, double i, double j, double sweep, double z = 0) {
    const Point3 to(x, y, z);
    chain_.push_back({Arc{at_, to, at_ + Vector3(i, j, 0), Vector3::UnitZ(), sweep}, feed_});
    at_ = to;
    return *this;
  }

  [[nodiscard]] const Chain& chain() const { return chain_; }

 private:
  double feed_;
  Point3 at_ = Point3::Zero();
  Chain chain_;
};

Chain square() {
  Program p(6000);
  for (int k = 0; k < 5; ++k) p.line(10, 0).line(10, 10).line(0, 10).line(0, 0);
  return p.chain();
}

Chain zigzag() {
  Program p(6000);
  for (int i = 1; i < 200; ++i) p.line(0.5 * i, 0.25 * (i % 2));
  return p.chain();
}

Chain slots() {
  Program p(6000);
  for (int k = 0; k < 6; ++k) {
    p.line(20, 8 * k).arc(20, 8 * k + 4, 0, 2, pi).line(0, 8 * k + 4).arc(0, 8 * k + 8, 0, 2, -pi);
  }
  return p.chain();
}

// Arcs through (0, 0) and (4, 0) about (2, 1): they meet at an angle of 127 degrees.
Chain scallops() {
  Program p(6000);
  const double sweep = 2 * std::atan2(2.0, 1.0);
  for (int k = 0; k < 8; ++k) p.arc(4 * (k + 1), 0, 2, 1, sweep);
  return p.chain();
}

Chain lines_and_arcs() {
  Program p(6000);
  for (int k = 0; k < 6; ++k) {
    const double x = 10 * k;
    p.line(x + 2, 0).arc(x + 8, 0, 3, 0, -pi).line(x + 9, 2).line(x + 10, 0);
  }
  return p.chain();
}

Chain helix() {
  Program p(6000);
  for (int k = 1; k <= 3; ++k) p.arc(0, 0, 5, 0, 2 * pi, -2 * k);
  p.line(3, 0, -6);
  return p.chain();
}

Chain star() {
  Program p(6000);
  for (int i = 0; i < 20; ++i) p.line(6 * std::cos(0.7 * i), 6 * std::sin(0.7 * i)).line(0, 0);
  return p.chain();
}

Chain circle_of_arcs(double feed) {
  Program p(feed);
  p.arc(-40, 0, -20, 0, pi).arc(0, 0, 20, 0, pi);
  return p.chain();
}

Chain circle_of_lines(double feed, int lines) {
  Program p(feed);
  for (int i = 1; i <= lines; ++i) {
    const double a = 2 * pi * i / lines;
    p.line(20 * std::cos(a) - 20, 20 * std::sin(a));
  }
  return p.chain();
}

// With a speed of the spindle in every so many of its blocks.
Chain with_speeds(Chain chain, std::size_t every) {
  for (std::size_t i = every; i < chain.size(); i += every) chain[i].says_speed = true;
  return chain;
}

struct MeasuredCase {
  std::string name;
  Chain chain;
  PathMode path;
  double tolerance;  // P and Q; 0: G64 alone
  double seconds;    // measured
};

class MeasuredTime : public testing::TestWithParam<MeasuredCase> {};

TEST_P(MeasuredTime, IsPredicted) {
  const MeasuredCase& c = GetParam();
  const double time = cutting_time(c.chain, bench_machine(c.tolerance), c.path);
  EXPECT_NEAR(time, c.seconds, 0.01 * c.seconds);
}

constexpr PathMode kG61 = PathMode::kExactPath;
constexpr PathMode kG64 = PathMode::kBlending;

INSTANTIATE_TEST_SUITE_P(
    Linuxcnc, MeasuredTime,
    testing::Values(MeasuredCase{"SquareExactPath", square(), kG61, 0, 2.560},
                    MeasuredCase{"SquareBlendedFreely", square(), kG64, 0, 1.766},
                    MeasuredCase{"SquareBlended", square(), kG64, 0.01, 2.488},
                    MeasuredCase{"SquareBlendedMore", square(), kG64, 0.05, 2.457},
                    MeasuredCase{"ZigzagExactPath", zigzag(), kG61, 0, 4.776},
                    MeasuredCase{"ZigzagBlendedFreely", zigzag(), kG64, 0, 2.356},
                    MeasuredCase{"ZigzagBlended", zigzag(), kG64, 0.01, 3.769},
                    MeasuredCase{"ZigzagBlendedMore", zigzag(), kG64, 0.05, 2.753},
                    MeasuredCase{"SlotsExactPath", slots(), kG61, 0, 3.348},
                    MeasuredCase{"SlotsBlended", slots(), kG64, 0.01, 3.348},
                    MeasuredCase{"ScallopsExactPath", scallops(), kG61, 0, 0.848},
                    MeasuredCase{"ScallopsBlendedFreely", scallops(), kG64, 0, 0.556},
                    MeasuredCase{"ScallopsBlended", scallops(), kG64, 0.01, 0.788},
                    MeasuredCase{"LinesAndArcsExactPath", lines_and_arcs(), kG61, 0, 1.776},
                    MeasuredCase{"LinesAndArcsBlendedFreely", lines_and_arcs(), kG64, 0, 1.301},
                    MeasuredCase{"LinesAndArcsBlended", lines_and_arcs(), kG64, 0.01, 1.646},
                    MeasuredCase{"LinesAndArcsBlendedMore", lines_and_arcs(), kG64, 0.05, 1.599},
                    MeasuredCase{"HelixExactPath", helix(), kG61, 0, 1.047},
                    MeasuredCase{"HelixBlended", helix(), kG64, 0.01, 1.084},
                    MeasuredCase{"StarExactPath", star(), kG61, 0, 3.413},
                    MeasuredCase{"StarBlendedFreely", star(), kG64, 0, 2.862},
                    MeasuredCase{"StarBlended", star(), kG64, 0.01, 3.327},
                    MeasuredCase{"CircleWithSpeeds", with_speeds(circle_of_lines(6000, 300), 1),
                                 kG64, 0.01, 9.253},
                    MeasuredCase{"CircleWithAFewSpeeds",
                                 with_speeds(circle_of_lines(6000, 300), 10), kG64, 0.01, 2.459},
                    MeasuredCase{"ZigzagWithSpeeds", with_speeds(zigzag(), 5), kG64, 0.01, 4.298}),
    [](const auto& test) { return test.param.name; });

// Lines over waves of 4 mm, where Z may do 40 mm/s: 100 mm/s on the crests, 51 mm/s on the slopes.
// The corners between them are passed as fast as the lines, not at 40 mm/s.
TEST(LinuxcncTime, PassesCornersOfASlowAxisAsFastAsTheirLines) {
  Program p(6000);
  for (int i = 1; i <= 80; ++i) p.line(0.5 * i, 0, 4 * std::sin(2 * pi * i / 40));
  Machine m = bench_machine(0.01);
  m.axis(Axis::kZ).velocity = 40;
  EXPECT_NEAR(cutting_time(p.chain(), m, kG64), 0.903, 0.009);  // measured
}

// Half of 4000 mm/s^2 along arcs: to 250 mm/s in .125 s and 15.625 mm, at both ends.
// Where no motion follows, the last arc has half of that again: .25 s and 31.25 mm.
TEST(LinuxcncTime, HalvesTheAccelerationOfTheLastMoveOfAProgram) {
  const double length = 40 * pi;
  const Machine m = bench_machine(0.01);
  const Chain circle = circle_of_arcs(15000);
  const double stops = 0.25 + (length - 31.25) / 250 + 0.0005;
  const double runs_out = 0.375 + (length - 15.625 - 31.25) / 250 + 0.0005;
  EXPECT_NEAR(cutting_time(circle, m, kG64, ChainEnd::kStop), stops, 1e-6);
  EXPECT_NEAR(cutting_time(circle, m, kG64, ChainEnd::kEndOfMotion), runs_out, 1e-6);
  EXPECT_NEAR(cutting_time(circle, m, kG61, ChainEnd::kEndOfMotion), stops, 1e-6);
}

// Measured: .633 s for 255 lines, .691 s for two arcs, 2.58 s for 2517 lines.
TEST(LinuxcncTime, PrefersLongLinesToArcsAndArcsToTinyLines) {
  Machine m = bench_machine(0.01);
  m.naive_cam_tolerance = 0;
  const auto time = [&](const Chain& c) {
    return cutting_time(c, m, kG64, ChainEnd::kEndOfMotion);
  };
  const double lines = time(circle_of_lines(15000, 255));
  const double arcs = time(circle_of_arcs(15000));
  const double tiny_lines = time(circle_of_lines(15000, 2517));
  EXPECT_NEAR(lines, 0.633, 0.001);
  EXPECT_NEAR(arcs, 0.691, 0.001);
  EXPECT_NEAR(tiny_lines, 2.581, 0.005);
  m.naive_cam_tolerance = 0.01;
  EXPECT_NEAR(time(circle_of_lines(15000, 2517)), 0.633, 0.001) << "joined by naive CAM";
}

// Corners that the exact path keeps stop; each side gives a tenth of its acceleration away.
// 10 mm at 3600 mm/s^2: 2 sqrt(10 / 3600) s, and half a period at each of the two stops.
TEST(LinuxcncTime, StopsAtCornersOfTheExactPath) {
  Program p(60000);
  p.line(10, 0).line(10, 10);
  const double expected = 2 * (2 * std::sqrt(10.0 / 3600) + 0.0005);
  EXPECT_NEAR(cutting_time(p.chain(), bench_machine(0.01), kG61), expected, 1e-9);
}

// The quarter of a circle of 20 mm, in which 32 arcs rise by 6 um each over their chords.
geometry::CubicBezier quarter_of_a_circle() {
  constexpr double k = 20 * 0.5522847;
  return {{{20, 0, 0}, {20, k, 0}, {k, 20, 0}, {0, 20, 0}}};
}

// Of a curve that says how many arcs the control makes of its pieces: 8 of one, one of 8.
TEST(LinuxcncTime, RunsACurveAsTheArcsThatItsPiecesAre) {
  const auto moves = [](const Chain& chain) {
    const auto all =
        stretches_of(chain, bench_machine(0), kG64, ChainEnd::kStop, WithPositions::kYes);
    return std::ranges::count(all.places, false, &StretchPlace::is_corner);
  };
  TimedPiece whole{quarter_of_a_circle(), 6000};
  whole.arcs = 8;
  EXPECT_EQ(moves({whole}), 8);
  Chain pieces;
  for (int i = 0; i < 64; ++i) {
    TimedPiece& piece = pieces.emplace_back(whole);
    piece.piece = geometry::sub_piece(whole.piece, i / 64.0, (i + 1) / 64.0);
    piece.goes_on = i > 0;
    piece.arcs = 0.125;
  }
  EXPECT_EQ(moves(pieces), 8);
  const Machine machine = bench_machine(0);
  EXPECT_NEAR(cutting_time(pieces, machine, kG64), cutting_time({{whole}}, machine, kG64), 1e-3);
}

// Leads of cut runs and parts of long chains begin in the midst of a block.
TEST(LinuxcncTime, RunsCurvesFromTheMidstOfABlock) {
  Chain pieces;
  for (int i = 0; i < 12; ++i) {
    TimedPiece& piece = pieces.emplace_back(TimedPiece{
        geometry::sub_piece(quarter_of_a_circle(), (50 + i) / 64.0, (51 + i) / 64.0), 6000});
    piece.goes_on = true;
    piece.arcs = 0.25;
  }
  const auto stretches =
      stretches_of(pieces, bench_machine(0), kG64, ChainEnd::kStop, WithPositions::kYes);
  EXPECT_EQ(std::ranges::count(stretches.places, false, &StretchPlace::is_corner), 3);
  pieces[4].piece =
      geometry::Line{geometry::start_point(pieces[4].piece), geometry::end_point(pieces[4].piece)};
  const double length = 20 * std::numbers::pi / 2 * 12 / 64;
  EXPECT_GT(cutting_time(pieces, bench_machine(0), kG64), length / 100);
}

// Measured: curves in XY at 50 mm/s where Z moves at 40 mm/s at most.
TEST(LinuxcncTime, RunsACurveInXyWhateverZAllows) {
  Machine machine = bench_machine(0);
  const Chain curve = {{quarter_of_a_circle(), 6000}};
  const double time = cutting_time(curve, machine, kG64);
  machine.axis(Axis::kZ).velocity = 5;
  machine.axis(Axis::kZ).acceleration = 50;
  EXPECT_EQ(cutting_time(curve, machine, kG64), time);
}

// --- naive CAM ----------------------------------------------------------------------------

// The moves that are left, without corners.
std::vector<geometry::PathPiece> joined(const Chain& chain, double tolerance) {
  Machine m = bench_machine(0.01);
  m.naive_cam_tolerance = tolerance;
  std::vector<geometry::PathPiece> moves;
  for (const StretchPlace& at :
       stretches_of(chain, m, kG64, ChainEnd::kStop, WithPositions::kYes).places) {
    if (!at.is_corner) moves.push_back(at.path);
  }
  return moves;
}

std::size_t joined_count(const Chain& chain, double tolerance) {
  return joined(chain, tolerance).size();
}

TEST(NaiveCam, JoinsLinesWithinTheTolerance) {
  Program p(1000);
  p.line(1, 0.009).line(2, 0).line(3, 0.009);
  EXPECT_EQ(joined_count(p.chain(), 0.001), 3u);
  EXPECT_EQ(joined_count(p.chain(), 0), 3u);
  const auto moves = joined(p.chain(), 0.01);
  ASSERT_EQ(moves.size(), 1u);
  EXPECT_EQ(geometry::start_point(moves[0]), Point3(0, 0, 0));
  EXPECT_EQ(geometry::end_point(moves[0]), Point3(3, 0.009, 0));
}

TEST(NaiveCam, JoinsAHundredAndOnePoints) {
  Program p(1000);
  for (int i = 1; i <= 202; ++i) p.line(i, 0);
  EXPECT_EQ(joined_count(p.chain(), 0.01), 2u);
  p.line(203, 0);
  EXPECT_EQ(joined_count(p.chain(), 0.01), 3u);
}

TEST(NaiveCam, KeepsLinesOfDifferentFeedsApart) {
  Chain chain = Program(1000).line(1, 0).line(2, 0).chain();
  chain[1].feed = 2000;
  EXPECT_EQ(joined_count(chain, 0.01), 2u);
}

// Half a chord of 1 mm on a radius of 50 rises by .0100025 mm.
TEST(NaiveCam, TakesFlatArcsOfThePlaneXyForLines) {
  const double angle = 2 * std::asin(1.0 / 50);
  Program p(1000);
  p.arc(2, 0, 1, std::sqrt(50.0 * 50 - 1), angle);
  EXPECT_TRUE(std::holds_alternative<Arc>(joined(p.chain(), 0.0099)[0]));
  EXPECT_TRUE(std::holds_alternative<geometry::Line>(joined(p.chain(), 0.0101)[0]));

  Arc upright = std::get<Arc>(p.chain()[0].piece);  // turned into the plane of X and Z
  for (Point3* q : {&upright.start, &upright.end, &upright.center}) *q = {q->x(), 0, q->y()};
  upright.axis = -Vector3::UnitY();
  EXPECT_TRUE(std::holds_alternative<Arc>(joined(Chain{{upright, 1000}}, 0.0101)[0]));
}

TEST(NaiveCam, TakesPartsOfCurvesForLines) {
  const Chain curve = {{quarter_of_a_circle(), 6000}};
  EXPECT_EQ(joined_count(curve, 0), 32u);
  EXPECT_EQ(joined_count(curve, 0.005), 32u);
  const std::vector<geometry::PathPiece> lines = joined(curve, 0.02);
  EXPECT_LT(lines.size(), 30u);
  for (const geometry::PathPiece& line : lines) {
    EXPECT_TRUE(std::holds_alternative<geometry::Line>(line));
  }
}

TEST(NaiveCam, IsOffUnderTheExactPath) {
  const Chain tiny = circle_of_lines(15000, 2517);
  EXPECT_NEAR(cutting_time(tiny, bench_machine(0.01), kG61), 2.578, 0.02);  // measured
}

}  // namespace
}  // namespace batten::postproc
