// What becomes of programs of arcs: those that stand for a curve are smoothed, those that were
// meant stay.
#include <gtest/gtest.h>

#include <cmath>

#include "gcode/state/reason.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/runs/run_path.h"
#include "tests/support/kinked_arcs.h"
#include "tests/support/sampled_motion.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// The cutting motions of a program that have a length, in order.
std::vector<TimedPiece> cuts_of(const std::string& text) {
  const ReadText read(text);
  std::vector<TimedPiece> cuts;
  for (const gcode::Motion& motion : read.meaning.motions) {
    if (motion.kind == gcode::MotionKind::kRapid || geometry::length_of(motion.piece) == 0)
      continue;
    const auto& state = read.meaning.states[read.meaning.blocks[motion.block].state_after];
    cuts.push_back({motion.piece, state.feed.value_or(0)});
  }
  return cuts;
}

// Radians: the greatest turn between two consecutive moves, but for corners (above 30 degrees).
double greatest_kink(std::span<const TimedPiece> moves) {
  double greatest = 0;
  for (std::size_t i = 1; i < moves.size(); ++i) {
    const double turn = turn_between(moves[i - 1].piece, moves[i].piece);
    if (turn < 30 * kDegree) greatest = std::max(greatest, turn);
  }
  return greatest;
}

double time_of(const std::string& text) {
  return cutting_time(cuts_of(text), *find_machine("linuxcnc-fast"), gcode::PathMode::kBlending);
}

// With the feed turned up as far as the machine goes, and without cutting corners: kinks cost
// stops.
double exact_time_of(const std::string& text) {
  std::vector<TimedPiece> cuts = cuts_of(text);
  for (TimedPiece& cut : cuts) cut.feed = 0;
  return cutting_time(cuts, *find_machine("linuxcnc-fast"), gcode::PathMode::kExactPath);
}

// Seconds on a machine that keeps 3000 mm/s^2 and 50000 mm/s^3 on every axis, at 100 mm/s, and
// stops in kinks where an axis would change its speed by more than its jerk can in a millisecond.
double planned_time_of(const std::string& text) {
  KinematicPathLimits limits;
  limits.feed = 100;
  limits.acceleration = geometry::Vector3::Constant(3000);
  limits.jerk = geometry::Vector3::Constant(50000);
  geometry::Path path;
  for (const TimedPiece& cut : cuts_of(text)) path.push_back(cut.piece);
  return planned_time(path, limits);
}

// Fewer arcs than there are cannot all be as near to the curve that they stand for.
SmoothOptions few_arcs() {
  SmoothOptions options = options_for("linuxcnc");
  options.prefer = Prefer::kSize;
  return options;
}

TEST(KinkedArcs, BecomeSmoothInNoMoreBlocks) {
  const std::string program = tests::kinked_arc_program(tests::three_leaves);
  const SmoothResult result = smoothed(program, few_arcs());
  ASSERT_TRUE(result.proved);
  EXPECT_EQ(rewritten_runs(result), 1U);
  EXPECT_LE(result.deviation_mm, 0.01);
  EXPECT_TRUE(verdict(program, result.text, 0.01).proved());

  const double before = greatest_kink(cuts_of(program));
  const double after = greatest_kink(cuts_of(result.text));
  const double planned_before = planned_time_of(program);
  const double planned_after = planned_time_of(result.text);
  RecordProperty("kink_before_deg", std::to_string(before / kDegree));
  RecordProperty("kink_after_deg", std::to_string(after / kDegree));
  RecordProperty("blocks_before", std::to_string(result.blocks_in));
  RecordProperty("blocks_after", std::to_string(result.blocks_out));
  RecordProperty("planned_before_s", std::to_string(planned_before));
  RecordProperty("planned_after_s", std::to_string(planned_after));
  EXPECT_GT(before, 0.5 * kDegree);
  EXPECT_LT(after, 0.1 * before);
  EXPECT_LE(cuts_of(result.text).size(), cuts_of(program).size());
  EXPECT_LE(time_of(result.text), 1.001 * time_of(program));
  EXPECT_LT(exact_time_of(result.text), 0.95 * exact_time_of(program));
  EXPECT_LT(planned_after, planned_before);
}

// A closed outline of its own for each seed.
tests::PlaneCurve random_outline(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const double size = std::pow(10.0, 2 * unit(random));
  const double third = 0.25 * unit(random);
  const double fifth = 0.06 * unit(random);
  return [=](double t) {
    const double a = 2 * std::numbers::pi * t;
    const double r = size * (1 + third * std::cos(3 * a) + fifth * std::sin(5 * a));
    return geometry::Vector2(r * std::cos(a), r * std::sin(a));
  };
}

TEST(KinkedArcs, StayInTheBandOrAsTheyAre) {
  constexpr unsigned kOutlines = 8;
  std::size_t rewritten = 0;
  for (unsigned seed = 0; seed < kOutlines; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const tests::KinkedArcs written{.parts = 3 + static_cast<int>(seed % 4),
                                    .decimals = 3 + static_cast<int>(seed % 2)};
    const std::string program = tests::kinked_arc_program(random_outline(seed), written);
    const SmoothResult result = smoothed(program, few_arcs());
    EXPECT_TRUE(result.proved);
    EXPECT_TRUE(verdict(program, result.text, 0.01).proved());
    expect_rest_copied(program, result);
    if (rewritten_runs(result) == 0) {
      EXPECT_EQ(result.text, program);
      continue;
    }
    ++rewritten;
    EXPECT_LE(greatest_kink(cuts_of(result.text)), greatest_kink(cuts_of(program)));
    EXPECT_LE(time_of(result.text), 1.01 * time_of(program));
  }
  RecordProperty("rewritten", std::to_string(rewritten));
  EXPECT_GE(rewritten, kOutlines / 2);
}

TEST(KinkedArcs, ComeOutAlikeWithAnyThreadsAndOnASecondPass) {
  const std::string program = tests::kinked_arc_program(tests::three_leaves);
  SmoothOptions options = few_arcs();
  const std::string once = smoothed(program, options).text;
  ASSERT_NE(once, program);
  EXPECT_EQ(smoothed(once, options).text, once);
  options.threads = 2;
  EXPECT_EQ(smoothed(program, options).text, once);
  // Without the mark too: the arcs are tangent now.
  options.allowed = {std::string(gcode::reason::kAlreadySmoothed)};
  EXPECT_EQ(smoothed(once, options).text, once);
}

// Where it cannot say arcs, the target gets what it can take, or the program stays.
TEST(KinkedArcs, AreProvedForEveryTarget) {
  const std::string program = tests::kinked_arc_program(tests::three_leaves);
  for (const std::string target : {"grbl", "linuxcnc"}) {
    for (const Form form : {Form::kAuto, Form::kArcs, Form::kLines}) {
      SmoothOptions options = options_for(target);
      options.output = form;
      const SmoothResult result = smoothed(program, options);
      EXPECT_TRUE(result.proved) << target;
      EXPECT_TRUE(verdict(program, result.text, 0.01).proved()) << target;
    }
  }
}

TEST(IntendedArcs, StayByteForByte) {
  const std::string pocket =
      "G21 G90 G17\nG0 X5 Y0 Z5\nG1 Z-1 F300\nG1 X35 F600\nG3 X40 Y5 I0 J5\nG1 Y20\n"
      "G3 X35 Y25 I-5 J0\nG1 X5\nG3 X0 Y20 I0 J-5\nG1 Y5\nG3 X5 Y0 I5 J0\nG0 Z5\n"
      "G0 X60 Y10\nG1 Z-1\nG2 X60 Y10 I5 J0\nG0 Z5\nM2\n";
  EXPECT_EQ(smoothed(pocket, options_for("linuxcnc")).text, pocket);
}

}  // namespace
}  // namespace batten::postproc
