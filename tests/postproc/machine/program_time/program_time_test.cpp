// Whole programs in time: closed forms and properties; the samples of a program's motion against
// its time, its path and the limits of the machine.
#include "postproc/machine/program_time/program_time.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "geometry/path/path.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/program_time/program_time_chains.h"
#include "postproc/machine/program_time/program_time_profile.h"
#include "tests/support/curve_programs.h"
#include "tests/support/interpreted.h"
#include "tests/support/machine_limits.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

StepOptions from_zero() {
  StepOptions options;
  options.start = geometry::Point3::Zero();
  return options;
}

// On a control of no name, unless one is given.
ProgramTime timed(const std::string& text,
                  const Machine& machine = machine_of(ControllerModel::kLookAhead),
                  const StepOptions& options = from_zero()) {
  const tests::Interpreted program(text);
  return time_program(program.program, program.read, machine, options);
}

double seconds_of(const std::string& text, const Machine& machine) {
  return timed(text, machine).seconds.sum();
}

std::size_t count_of(const ProgramTime& time, std::string_view id) {
  const auto found = std::ranges::find(time.not_timed, id, &NotTimed::id);
  return found == time.not_timed.end() ? 0 : found->count;
}

class EveryControl : public testing::TestWithParam<ControllerModel> {};

INSTANTIATE_TEST_SUITE_P(ProgramTime, EveryControl, testing::ValuesIn(kModels), model_name);

// A control without rapids runs them at the last feed.
TEST(ProgramTime, OverridesWhatKlipperRunsItsRapidsAt) {
  const Machine& machine = *find_machine("klipper-router");
  StepOptions options = from_zero();
  options.feed_override = 1.5;
  const auto text_with = [](const char* feed) {
    return std::string("G21 G90\nG1 X30 F") + feed + "\nG0 X0\nG1 Y30\n";
  };
  const double by_override = timed(text_with("400"), machine, options).seconds.sum();
  EXPECT_NEAR(by_override, timed(text_with("600"), machine).seconds.sum(), 1e-9);
}

// In each mode of the feed, in arcs, drilling cycles and a turn of a rotary axis alone.
TEST_P(EveryControl, TakesWithTheFeedOverrideWhatItTakesWithSuchFeeds) {
  const Machine machine = machine_of(GetParam());
  const std::vector<std::string> feeds = {"400", "1", "2.5", "0.2"};
  const std::vector<std::string> overridden = {"600", "1.5", "3.75", "0.3"};
  const auto text_with = [](const std::vector<std::string>& f) {
    return "G21 G90 G94 G17 M3 S1000\nG1 X30 F" + f[0] + "\nG2 X50 Y20 I0 J20\nG0 X0 Y0\n" +
           "G81 X5 Y5 Z-4 R1\nG80\nG93 G1 X20 F" + f[1] + "\nA90 F" + f[2] + "\nG95 G1 X50 F" +
           f[3] + "\nG0 X0\nM2\n";
  };
  StepOptions options = from_zero();
  options.feed_override = 1.5;
  const ProgramTime by_override = timed(text_with(feeds), machine, options);
  const ProgramTime by_feeds = timed(text_with(overridden), machine);
  EXPECT_NEAR(by_override.seconds.sum(), by_feeds.seconds.sum(), 1e-9);
  EXPECT_NEAR(by_override.seconds.rotary, by_feeds.seconds.rotary, 1e-12);
  EXPECT_NEAR(by_override.cutting_at_feed, by_feeds.cutting_at_feed, 1e-9);
  EXPECT_GT(by_override.seconds.rotary, 0);
  EXPECT_LT(by_override.seconds.cutting, timed(text_with(feeds), machine).seconds.cutting);
}

// --- parts ---------------------------------------------------------------------------------

// Rapid: 300 mm/s after .3 s and 45 mm: .3 + (300 - 90) / 300 + .3. Cut: 100 mm/s after .1 s and
// 5 mm: .1 + (50 - 10) / 100 + .1. The dwell between them brings both to rest.
TEST_P(EveryControl, AddsRapidsDwellsAndCuts) {
  const Machine m = machine_of(GetParam());
  const ProgramTime time =
      timed("G21 G90 G61.1\nG0 X300\nG4 P0.5\nG1 X350 F6000\nM2\n", m,
            {.dwell_unit = gcode::DwellUnit::kSeconds, .start = geometry::Point3(0, 0, 0)});
  EXPECT_NEAR(time.seconds.rapids, 1.3 + stop_loss(m), 1e-9);
  EXPECT_NEAR(time.seconds.cutting, 0.6 + stop_loss(m), 1e-9);
  EXPECT_DOUBLE_EQ(time.seconds.dwells, 0.5);
  EXPECT_NEAR(time.rapid_mm, 300, 1e-9);
  EXPECT_NEAR(time.cutting_mm, 50, 1e-9);
  EXPECT_NEAR(time.cutting_at_feed, 0.5, 1e-12);
  EXPECT_EQ(time.counts.cuts, 1u);
  EXPECT_EQ(time.counts.rapids, 1u);
  EXPECT_EQ(time.counts.dwells, 1u);
  EXPECT_TRUE(time.not_timed.empty());
}

// A program of all kinds of steps from a seed.
std::string random_program(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::string text = "G21 G90 G17\nT1 M6\nM3 S8000\nG0 X0 Y0 Z5\nF1500\n";
  for (int i = 0; i < 120; ++i) {
    const double x = 40 * unit(random);
    const double y = 30 * unit(random);
    const std::string cut = fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", x, y, -unit(random));
    const std::vector<std::string> others = {
        fmt::format("G0 X{:.3f} Y{:.3f} Z5\n", x, y),
        fmt::format("G4 P{:.2f}\n", unit(random)),
        fmt::format("F{:.0f}\n", 300 + 4000 * unit(random)),
        fmt::format("T{} M6\n", 1 + static_cast<int>(unit(random) * 3)),
        "M5\nM3\n",
        fmt::format("G64 P{:.2f}\n", 0.1 * unit(random)),
        "G91\nG1 X1 Y1\nG3 X2 Y0 I1\nG90\n"};
    const auto kind = static_cast<std::size_t>(unit(random) * 12);
    text += kind < others.size() ? others[kind] : cut;
  }
  return text + "M30\n";
}

constexpr unsigned kPrograms = 60;

TEST_P(EveryControl, PartsSumToTheWholeByKindAndByTool) {
  const Machine m = machine_of(GetParam());
  for (unsigned seed = 0; seed < kPrograms; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const ProgramTime time = timed(random_program(seed), m);
    EXPECT_GT(time.seconds.cutting, 1);
    TimeParts tools;
    for (const ToolTime& tool : time.tools) {
      tools.cutting += tool.seconds.cutting;
      tools.rapids += tool.seconds.rapids;
      tools.dwells += tool.seconds.dwells;
      tools.tool_changes += tool.seconds.tool_changes;
      tools.spindle += tool.seconds.spindle;
    }
    EXPECT_NEAR(tools.cutting, time.seconds.cutting, 1e-9);
    EXPECT_NEAR(tools.rapids, time.seconds.rapids, 1e-9);
    EXPECT_NEAR(tools.sum(), time.seconds.sum(), 1e-9);
    EXPECT_LE(time.below_half_feed, time.seconds.cutting + 1e-9);
    EXPECT_GE(time.seconds.cutting, 0.97 * time.cutting_at_feed) << "never above the feed";
  }
}

// The times of the chains themselves, added up without the bookkeeping by blocks.
TEST_P(EveryControl, AgreesWithTheTimeOfItsChain) {
  const Machine m = machine_of(GetParam());
  const std::string text =
      "G21 G90\nG1 X10 F3000\nX10 Y10\nG3 X0 Y20 I-10\nG1 X-20 Y20.5\nX-20.3 Y21\nM2\n";
  const tests::Interpreted program(text);
  std::vector<TimedPiece> chain;
  for (const gcode::Motion& motion : program.read.motions) {
    chain.push_back({motion.piece, 3000});
  }
  EXPECT_NEAR(timed(text, m).seconds.cutting,
              cutting_time(chain, m, gcode::PathMode::kBlending, ChainEnd::kEndOfMotion), 1e-9);
}

TEST_P(EveryControl, ADwellAddsExactlyItsSeconds) {
  const Machine m = machine_of(GetParam());
  for (const double dwell : {0.001, 0.25, 3.0, 600.0}) {
    // M8 brings the motion to rest in both.
    const std::string before = "G21 G90\nG1 X10 F3000\nM8\n";
    const std::string after = "G1 Y10\nX0\nM2\n";
    const double without = seconds_of(before + after, m);
    const double with = seconds_of(before + fmt::format("G4 X{}\n", dwell) + after, m);
    EXPECT_NEAR(with - without, dwell, 1e-9);
  }
}

// --- properties ------------------------------------------------------------------------------

// Half the speed at a quarter of the acceleration and twice the period is the same motion in
// slow motion: every time doubles. LinuxCNC has a time of its own besides, the 10 ms below which
// moves keep one acceleration.
TEST_P(EveryControl, SlowMotionTakesTwiceTheTime) {
  const Machine m = machine_of(GetParam());
  Machine slow = m;
  set_max_velocity(slow, slow.max_velocity() / 2);
  set_rapid_velocity(slow, slow.rapid_velocity() / 2);
  set_max_acceleration(slow, slow.max_acceleration() / 4);
  slow.block_period *= 2;
  slow.servo_period *= 2;
  for (unsigned seed = 0; seed < kPrograms; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto program = [&](double feed) {
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> unit(0, 1);
      std::string text = fmt::format("G21 G90\nG0 X5 Y5\nF{}\n", feed);
      for (int i = 0; i < 80; ++i) {
        text += fmt::format("G1 X{:.3f} Y{:.3f}\n", 20 * unit(random), 20 * unit(random));
        if (i % 9 == 0) text += "G91\nG2 X2 Y2 I1 J1\nG90\n";
        if (i % 17 == 0) text += "G0 X0 Y0\n";
      }
      return text + "M2\n";
    };
    const double time = seconds_of(program(4000), m);
    const double twice = seconds_of(program(2000), slow);
    EXPECT_NEAR(twice, 2 * time, m.model == ControllerModel::kLinuxcnc ? 0.01 * time : 1e-9 * time);
  }
}

// Half the acceleration alone: a move that is all ramps takes sqrt(2) times as long; half the
// speed alone: one that is all cruise takes twice as long.
TEST_P(EveryControl, HalvedLimitsStretchTheirOwnPartOfAMove) {
  const Machine m = machine_of(GetParam());
  Machine half = m;
  set_max_acceleration(half, half.max_acceleration() / 2);
  const std::string ramps = "G21 G90\nG1 X2 F20000\nG0 X2.5\nM2\n";
  const auto cut = [&](const Machine& machine) {
    return timed(ramps, machine).seconds.cutting - stop_loss(machine);
  };
  if (m.model != ControllerModel::kGrbl) {  // whose rapid goes on from the cut
    EXPECT_NEAR(cut(half), std::sqrt(2.0) * cut(m), 1e-9);
  }
  half = m;
  set_max_velocity(half, half.max_velocity() / 2);
  const double long_way = timed("G21 G90\nG1 X20000 F60000\nM2\n", m).seconds.cutting;
  const double slow_way = timed("G21 G90\nG1 X20000 F60000\nM2\n", half).seconds.cutting;
  EXPECT_NEAR(slow_way, 2 * long_way, 0.01 * long_way);
}

TEST(ProgramTimeOfAGenericControl, IsTheSameBackward) {
  for (unsigned seed = 0; seed < kPrograms; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<std::string> places;
    for (int i = 0; i < 100; ++i) {
      places.push_back(fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", i + unit(random), 5 * unit(random),
                                   unit(random)));
    }
    const auto program = [](const std::vector<std::string>& through) {
      std::string text = "G21 G90\nG0 " + through.front() + "M8\nG1 F4000\n";
      for (const std::string& place : through) text += place;
      return text + "M2\n";
    };
    const double forward = timed(program(places)).seconds.cutting;
    std::ranges::reverse(places);
    EXPECT_NEAR(timed(program(places)).seconds.cutting, forward, 1e-6);
  }
}

// --- feeds and units ---------------------------------------------------------------------------

TEST_P(EveryControl, TakesTheThreeFeedModesForWhatTheyAre) {
  const Machine m = machine_of(GetParam());
  const double per_minute = seconds_of("G21 G90\nG94 G1 X50 F3000\nG1 X80\nM2\n", m);
  // 50 mm at 3000 mm/min is a minute / 60, 30 mm a minute / 100.
  EXPECT_NEAR(seconds_of("G21 G90\nG93 G1 X50 F60\nG1 X80 F100\nM2\n", m), per_minute, 1e-9);
  const ProgramTime per_turn = timed("G21 G90\nS1500\nG95 G1 X50 F2\nG1 X80\nM2\n", m);
  EXPECT_NEAR(per_turn.seconds.sum(), per_minute, 1e-9);
  EXPECT_TRUE(per_turn.not_timed.empty());
  EXPECT_EQ(count_of(timed("G21 G90\nG95 G1 X50 F2\nM2\n", m), "spindle-speed-unknown"), 1u);
}

TEST_P(EveryControl, TakesInchProgramsForWhatTheyAre) {
  const Machine m = machine_of(GetParam());
  const std::string mm =
      "G21 G90\nG64 P0.0254 Q0\nG0 X25.4\nG1 X50.8 Y2.54 F2540\nG2 X76.2 Y2.54 I12.7 J0\nM2\n";
  const std::string inch =
      "G20 G90\nG64 P0.001 Q0\nG0 X1\nG1 X2 Y0.1 F100\nG2 X3 Y0.1 I0.5 J0\nM2\n";
  EXPECT_NEAR(seconds_of(inch, m), seconds_of(mm, m), 1e-9);
}

TEST_P(EveryControl, TakesIncrementsForWhatTheyAre) {
  const Machine m = machine_of(GetParam());
  const std::string absolute = "G21 G90\nG0 X10 Y5\nG1 X30 Y5 F3000\nX30 Y25\nG0 X0 Y0\nM2\n";
  const std::string steps = "G21 G91\nG0 X10 Y5\nG1 X20 F3000\nY20\nG0 X-30 Y-25\nM2\n";
  EXPECT_NEAR(seconds_of(steps, m), seconds_of(absolute, m), 1e-9);
  // An increment is as long wherever it begins.
  const ProgramTime somewhere = timed(steps, m, {});
  EXPECT_NEAR(somewhere.seconds.sum(), seconds_of(absolute, m), 1e-9);
  EXPECT_TRUE(somewhere.not_timed.empty());
}

// --- exact stops and tolerances ------------------------------------------------------------------

// 30 mm at 100 mm/s from rest to rest: .1 + .2 + .1 s; G9 stops behind its own block alone.
TEST_P(EveryControl, StopsWhereTheProgramSaysSo) {
  const Machine m = machine_of(GetParam());
  const std::string head = "G21 G90\nF6000\n";
  const double one = 0.4 + stop_loss(m);
  const std::string tail = "G0 X90\nM2\n";
  const auto cut = [&](const std::string& text) {
    return timed(head + text + "M8\n" + tail, m).seconds.cutting;
  };
  EXPECT_NEAR(cut("G61.1\nG1 X30\nX60\nX90\n"), 3 * one, 1e-9);
  const double through = cut("G61.1\nG1 X90\n");
  EXPECT_NEAR(through, 1.0 + stop_loss(m), 1e-9) << ".1 + .8 + .1 s";
  const double nine = cut("G9 G1 X30\nG61.1\nX90\n");
  EXPECT_NEAR(nine, one + 0.7 + stop_loss(m), 1e-9) << ".1 + .5 + .1 s behind the stop";
}

TEST(ProgramTimeOnLinuxcnc, TakesTheTolerancesOfTheProgram) {
  const std::string body = "G1 X10 F6000\nY10\nX20\nY20\nX20.1\nX20.2\nG0 Z1\nM2\n";
  const auto with_tolerances = [&](double p, double q) {
    Machine m = machine_of(ControllerModel::kLinuxcnc);
    m.blend_tolerance = p;
    m.naive_cam_tolerance = q;
    return seconds_of("G21 G90\n" + body, m);
  };
  Machine m = machine_of(ControllerModel::kLinuxcnc);
  m.blend_tolerance = 0.3;
  m.naive_cam_tolerance = 0.3;
  const auto saying = [&](const std::string& words) {
    return seconds_of("G21 G90\n" + words + "\n" + body, m);
  };
  EXPECT_NEAR(saying("G64 P0.02 Q0"), with_tolerances(0.02, 0), 1e-12);
  EXPECT_NEAR(saying("G64 P0.05"), with_tolerances(0.05, 0.05), 1e-12);
  EXPECT_NEAR(saying("G64"), with_tolerances(0, 0), 1e-12);
  EXPECT_NEAR(saying("G64 P-1 Q-2"), with_tolerances(0, 0), 1e-12) << "as rs274 says";
  EXPECT_NEAR(saying(""), with_tolerances(0.3, 0.3), 1e-12) << "nothing said: as the machine is";
  EXPECT_GT(std::abs(saying("G64 P0.02 Q0") - saying("")), 0.01);
}

// grbl runs rapids and cuts through one queue; other controls come to rest between them.
TEST(ProgramTimeOnGrbl, RunsFromACutIntoARapid) {
  const std::string text = "G21 G90\nG1 X50 F6000\nG0 X100\nM2\n";
  const Machine m = machine_of(ControllerModel::kGrbl);
  // To 100 mm/s in 5 mm and .1 s, 45 mm at it; to a peak v and down again in 50 mm:
  // (v^2 - 100^2) / 2000 + v^2 / 2000 = 50 gives v^2 = 55000.
  const double peak = std::sqrt(55000.0);
  const double expected = 0.1 + 0.45 + (peak - 100) / 1000 + peak / 1000;
  EXPECT_NEAR(seconds_of(text, m), expected, 1e-9);
}

// --- canned cycles -----------------------------------------------------------------------------

TEST_P(EveryControl, DrillsAsTheMovesOfTheCycleWouldDo) {
  const Machine m = machine_of(GetParam());
  const std::string head = "G21 G90\nG0 X0 Y0 Z20\nG61.1\n";
  const std::string cycle = head + "G99 G81 X10 Y10 Z-3 R2 F300\nX20\nG98 X30\nG80\nM2\n";
  const std::string moves = head +
                            "G0 X10 Y10\nZ2\nG1 Z-3 F300\nG0 Z2\nX20\nG1 Z-3\nG0 Z2\nX30\n"
                            "G1 Z-3\nG0 Z20\nM2\n";
  EXPECT_NEAR(seconds_of(cycle, m), seconds_of(moves, m), 1e-3);
  EXPECT_TRUE(timed(cycle, m).not_timed.empty());
}

TEST(ProgramTimeOfCycles, PecksAndDwells) {
  const std::string head = "G21 G90\nG0 X0 Y0 Z2\n";
  const ProgramTime pecks = timed(head + "G83 X0 Y0 Z-5 R2 Q3 F600\nG80\nM2\n");
  // 2 to -1, up to 2, down to -.746, to -4, up, down to -3.746, to -5, up.
  EXPECT_NEAR(pecks.cutting_mm, 3 + 3.254 + 1.254, 1e-9);
  // The first rapid to Z2 too.
  EXPECT_NEAR(pecks.rapid_mm, 2 + 3 + 2.746 + 6 + 5.746 + 7, 1e-9);
  const ProgramTime chips = timed(head + "G73 X0 Y0 Z-5 R2 Q3 F600\nG80\nM2\n");
  EXPECT_NEAR(chips.rapid_mm, 2 + 0.254 + 0.254 + 7, 1e-9);
  const ProgramTime dwells = timed(head + "G82 X0 Y0 Z-5 R2 P1.5 F600\nX5\nX10\nG80\nM2\n");
  EXPECT_NEAR(dwells.seconds.dwells, 4.5, 1e-12);
  const ProgramTime bores = timed(head + "G85 X0 Y0 Z-5 R2 F600\nG80\nM2\n");
  EXPECT_NEAR(bores.cutting_mm, 14, 1e-9);
  EXPECT_TRUE(bores.not_timed.empty());
}

TEST(ProgramTimeOfCycles, RepeatsIncrementalHoles) {
  const ProgramTime time =
      timed("G21 G90\nG0 X0 Y0 Z10\nG91 G99 G81 X5 Z-6 R-8 L4 F600\nG80\nM2\n");
  EXPECT_EQ(time.counts.cuts, 4u);
  EXPECT_NEAR(time.cutting_mm, 4 * 6, 1e-9);
  EXPECT_NEAR(time.rapid_mm, 10 + 5 + 8 + 3 * 5 + 4 * 6, 1e-9) << "from X0 Y0 Z0";
}

// Axis words that belong to another code of their block are no hole, which would be 7 mm more.
TEST(ProgramTimeOfCycles, DrillOnlyWhereTheAxisWordsAreTheirs) {
  const std::string cycle = "G21 G90\nG0 X0 Y0 Z2\nG81 X0 Y0 Z-5 R2 F600\n";
  EXPECT_NEAR(timed(cycle + "X5\nG80\nM2\n").cutting_mm, 14, 1e-9);
  for (const char* other : {"G65 P9000 X5", "G68 X5 Y5 R30", "G51 X5 Y5 P2"}) {
    EXPECT_NEAR(timed(cycle + other + "\nG80\nM2\n").cutting_mm, 7, 1e-9) << other;
  }
}

TEST(ProgramTimeOfCycles, CountsWhatItDoesNotFollow) {
  const std::string head = "G21 G90\nG0 X0 Y0 Z2\n";
  EXPECT_EQ(count_of(timed(head + "G87 X0 Y0 Z-5 R2 F600\nM2\n"), "canned-cycle"), 1u);
  EXPECT_EQ(count_of(timed(head + "G18 G81 X0 Z-5 R2 F600\nM2\n"), "canned-cycle"), 1u);
  EXPECT_EQ(count_of(timed(head + "G81 X0 Y0 Z-5 F600\nM2\n"), "canned-cycle"), 1u) << "no R";
}

// --- what is not known is said -------------------------------------------------------------------

struct NotKnown {
  std::string name;
  std::string text;
  std::string id;
  std::size_t count;
};

class IsSaid : public testing::TestWithParam<NotKnown> {};

TEST_P(IsSaid, WithItsCount) {
  const Machine m = machine_of(ControllerModel::kLookAhead);
  const ProgramTime time = timed("G21 G90\n" + GetParam().text + "M2\n", m, {});
  EXPECT_EQ(count_of(time, GetParam().id), GetParam().count) << GetParam().id;
  for (const NotTimed& entry : time.not_timed) {
    EXPECT_FALSE(entry.text.empty());
    EXPECT_GT(entry.first_line, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(
    NotTimed, IsSaid,
    testing::Values(
        NotKnown{"ThePlaceBeforeTheFirstMove", "G0 X10 Y10\nG1 X20 F500\n", "start-unknown", 1},
        NotKnown{"ThePlaceAfterAToolChange", "G0 X1 Y1 Z1\nT1 M6\nG0 X10 Y10 Z5\nG1 X2 F9\n",
                 "position-assumed", 1},
        NotKnown{"ThePlaceAfterReference", "G0 X1 Y1 Z1\nG28 Z0\nG0 Z5\n", "reference-move", 1},
        NotKnown{"TheFeed", "G0 X1 Y1\nG1 X5\nG1 X6\n", "feed-unknown", 2},
        NotKnown{"Expressions", "G0 X1 Y1\nG1 X[1+1] F100\n", "expression", 1},
        NotKnown{"DeletableBlocks", "G0 X1 Y1\n/G1 X2 F100\n", "block-delete", 1},
        NotKnown{"RotaryAxes", "G0 X1 Y1\nG1 X2 A10 F100\n", "rotary-axis", 1},
        NotKnown{"Probing", "G0 X1 Y1\nG38.2 Z-5 F100\n", "probe", 1},
        NotKnown{"Threading", "G0 X1 Y1\nS100\nG33 Z-5 K1\n", "threading", 1},
        NotKnown{"TheOperator", "M0\nM1\n", "operator-stop", 2},
        NotKnown{"MacroFunctions", "M123\nM55\n", "misc-function", 2},
        NotKnown{"Subprograms", "G0 X1 Y1\nM98 P1000\n", "subprogram", 1},
        NotKnown{"Compensation", "G0 X1 Y1\nG41 D1\nG1 X2 F100\nG40\n", "path-changed-by-control",
                 1},
        NotKnown{"DwellsWithoutAPoint", "G4 P500\nG4 P.5\nG4 X2\n", "dwell-unit-assumed", 1},
        NotKnown{"DwellsWithoutALength", "G4\n", "dwell-unknown", 1},
        NotKnown{"BlocksBehindTheEnd", "G0 X1 Y1\nM30\nG1 X2 F100\nG1 X3\n", "after-end", 2}),
    [](const auto& test) { return test.param.name; });

// The start counts where it is said; an axis that nobody knows takes no time.
TEST(ProgramTimePositions, ComeFromTheStartThatIsGivenAndFromSetCoordinates) {
  const std::string text = "G21 G90\nG0 X300\nM2\n";
  EXPECT_EQ(timed(text, machine_of(ControllerModel::kLookAhead), {}).seconds.sum(), 0);
  EXPECT_NEAR(timed(text).seconds.sum(), 1.3, 1e-9);
  const ProgramTime time = timed("G21 G90\nG0 X100\nG92 X0\nG0 X200\nM2\n");
  EXPECT_NEAR(time.rapid_mm, 300, 1e-9);
  EXPECT_EQ(count_of(time, "position-assumed"), 0u);
}

// --- curves of the control ----------------------------------------------------------------------

// y = x - x^2 / 20 from 0 to 10: its length is 5 (sqrt 2 + asinh 1). The line behind it is 5 mm.
TEST(ProgramTimeOfCurves, IsThatOfTheirLengthWhereTheirControlIsNamed) {
  const Machine m = machine_of(ControllerModel::kLookAhead);
  const std::string text =
      "G21 G90\nG0 X0 Y0 Z0\nG1 F600\nPOLY PO[X]=(10) PO[Y]=(5,-5)\nG1 Y10\nM2\n";
  gcode::Diagnostics found;
  const gcode::Program program = gcode::parse(gcode::SourceText("test.mpf", text), found);
  const gcode::ReadOptions siemens = {.curves = gcode::find_control("siemens")->curves};
  const auto followed = gcode::interpret(program, siemens, found);
  const ProgramTime time = time_program(program, followed, m, from_zero());
  EXPECT_NEAR(time.cutting_mm, 5 * (std::sqrt(2.0) + std::asinh(1.0)) + 5, 1e-6);
  EXPECT_TRUE(time.not_timed.empty());
  const auto unknown = gcode::interpret(program, {}, found);
  EXPECT_FALSE(time_program(program, unknown, m, from_zero()).not_timed.empty());
}

// A curve with weights is read as many pieces: no block begins between them, nothing stops there.
TEST(ProgramTimeOfCurves, IsTheSameWithWeightsThatOnlyMoveTheirParameter) {
  const auto seconds = [](const char* target, ControllerModel model, tests::CurveWord word,
                          const char* mode) {
    tests::CurvePath path{.pieces = 12, .step = 5, .length = 60, .kink = 0};
    const std::string text = mode + tests::curve_program(path, word);
    gcode::Diagnostics found;
    const gcode::Control& control = *gcode::find_control(target);
    const gcode::Program program =
        gcode::parse(gcode::SourceText("test.nc", text), control.language, found);
    const auto read = gcode::interpret(program, {.curves = control.curves}, found);
    Machine machine = machine_of(model);
    if (model == ControllerModel::kLookAhead) machine.block_period = 0.02;
    return time_program(program, read, machine, from_zero()).seconds.sum();
  };
  using enum tests::CurveWord;
  for (const char* mode : {"", "G61\n"}) {
    const auto fanuc = [&](tests::CurveWord word) {
      return seconds("fanuc", ControllerModel::kLookAhead, word, mode);
    };
    EXPECT_NEAR(fanuc(kG062Weights), fanuc(kG062), 0.005 * fanuc(kG062)) << mode;
    const auto linuxcnc = [&](tests::CurveWord word) {
      return seconds("linuxcnc", ControllerModel::kLinuxcnc, word, mode);
    };
    EXPECT_NEAR(linuxcnc(kG52Weights), linuxcnc(kG52), 0.01 * linuxcnc(kG52)) << mode;
  }
}

// --- exact stop ---------------------------------------------------------------------------------

// A zigzag from line 3 on whose corners are so blunt that plans hardly slow down there; lines 23 to
// 42 have `mode`, or G9 each.
std::string zigzag_with(const std::string& mode, const std::string& blending = "G64") {
  std::string text = "G21 G90\nG1 F6000 X0 Y0 Z0\n";
  for (int i = 1; i <= 60; ++i) {
    std::string words;
    if (i == 21 || i == 41) words = (i == 21 ? mode : blending) + " ";
    if (mode == "G9") words = i > 20 && i <= 40 ? "G9 " : "";
    text += fmt::format("{}X{} Y{:.5f}\n", words, 2 * i, 0.00008 * (i % 2));
  }
  return text + "M2\n";
}

// The choice of `smooth`, `batten time` and its profile tell the same seconds of curves that slow
// the machine down under a limit on jerk, which are those of the plan.
TEST(SlowCurves, TakeWhatThePlanTakes) {
  const Machine& machine = *find_machine("high-speed");
  std::string text = tests::curve_program({.kink = 0}, tests::CurveWord::kG062);
  text.replace(text.find("F2000"), 5, "F20000");
  const tests::Interpreted program(text, {.curves = gcode::find_control("fanuc")->curves});
  const ProgramSteps steps = read_steps(program.program, program.read, from_zero());
  const auto cutting = [&](FeedPlanner planner) {
    return time_program(program.program, program.read, machine, from_zero(), planner)
        .seconds.cutting;
  };
  const double told = cutting(FeedPlanner::kControl);
  EXPECT_NEAR(told, cutting(FeedPlanner::kJerk), 0.002 * told);
  std::vector<TimedPiece> pieces;
  for (const ProgramStep& step : steps.steps) {
    if (step.kind == StepKind::kCut) pieces.push_back({step.piece, step.feed});
  }
  EXPECT_NEAR(cutting_time(pieces, machine, gcode::PathMode::kBlending), told, 1e-9);
}

class ExactStop : public testing::TestWithParam<std::string> {
 protected:
  const Machine& machine_ = *find_machine("high-speed");
  tests::Interpreted program_{zigzag_with(GetParam())};

  [[nodiscard]] double planned(const tests::Interpreted& program, FeedPlanner planner) const {
    return time_program(program.program, program.read, machine_, from_zero(), planner)
        .seconds.cutting;
  }
};

INSTANTIATE_TEST_SUITE_P(Words, ExactStop, testing::Values("G61", "G61.1", "G60", "G9"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '.');
                           return name;
                         });

TEST_P(ExactStop, CostsAPlanWhatItCostsTheEstimate) {
  const tests::Interpreted without(zigzag_with("G64"));
  const double plan = planned(program_, FeedPlanner::kJerk);
  EXPECT_NEAR(planned(program_, FeedPlanner::kControl), plan, 0.01 * plan);
  for (const FeedPlanner planner : {FeedPlanner::kJerk, FeedPlanner::kSCurve}) {
    EXPECT_GT(planned(program_, planner), 1.1 * planned(without, planner)) << name_of(planner);
  }
  // Of the machine's own mode, where the program says nothing.
  Machine machine = machine_;
  machine.path_mode = gcode::PathMode::kExactStop;
  const tests::Interpreted silent("G21 G90\nG1 F6000 X0 Y0 Z0\nX10\nX20\nM2\n");
  const auto seconds = [&](FeedPlanner planner) {
    return time_program(silent.program, silent.read, machine, from_zero(), planner).seconds.sum();
  };
  EXPECT_NEAR(seconds(FeedPlanner::kJerk), seconds(FeedPlanner::kControl), 1e-3);
}

// At the end of each block in which it holds: over the last whole period before the stop the mean
// speed is at most 7/6 of what the jerk makes of a period.
TEST_P(ExactStop, ShowsAsRestInTheProfileOfAPlan) {
  constexpr double kPeriod = 1e-4;
  const ProgramSteps steps = read_steps(program_.program, program_.read, from_zero());
  for (const FeedPlanner planner : {FeedPlanner::kJerk, FeedPlanner::kSCurve}) {
    std::vector<double> slowest(64, 1e9);  // mm/min near the end of each line
    const auto see = [&](const ProfileSample& s) {
      const double left = 2 * (s.line - 2.0) - s.place.x();
      if (left < 1) slowest.at(s.line) = std::min(slowest.at(s.line), s.feed);
      return true;
    };
    EXPECT_TRUE(sample_program(steps, machine_, kPeriod, see, planner));
    for (std::size_t line = 23; line <= 42; ++line) {
      EXPECT_LE(slowest[line], 1e5 * kPeriod * kPeriod * kMinute * 7 / 6 * 1.001) << line;
    }
    EXPECT_GT(*std::min_element(slowest.begin() + 4, slowest.begin() + 20), 2000);
  }
}

// --- tools, slow places -------------------------------------------------------------------------

TEST(ProgramTimeByTool, GivesEachToolItsOwn) {
  const ProgramTime time =
      timed("G21 G90\nT3 M6\nG1 X50 F6000\nT7 M6\nG1 X0 F3000\nT3 M6\nG1 X50 F6000\nM2\n");
  ASSERT_EQ(time.tools.size(), 2u);
  EXPECT_EQ(time.tools[0].tool, 3);
  EXPECT_EQ(time.tools[1].tool, 7);
  EXPECT_NEAR(time.tools[0].seconds.cutting, 2 * 0.6, 1e-9);
  EXPECT_NEAR(time.tools[1].seconds.cutting, 0.05 + 0.95 + 0.05, 1e-9) << "50 mm/s, 1.25 mm ramps";
  EXPECT_EQ(time.counts.tool_changes, 3u);
}

// Half of 100 mm/s is passed .05 s after the start and before the end.
TEST(ProgramTimeBelowHalfTheFeed, IsCountedToTheMoment) {
  EXPECT_NEAR(timed("G21 G90\nG1 X50 F6000\nM2\n").below_half_feed, 0.1, 1e-9);
}

// From rest to 50 mm/s, from 50 down to the next feed of 10 before it begins, from 5 mm/s to rest;
// the line that is run at its feed from end to end has none.
TEST(ProgramTimeBelowHalfTheFeed, IsCountedWhereALineEndsSlowerThanItBegins) {
  const double expected = (50 + 40 + 5) / 1000.0;
  EXPECT_NEAR(timed("G21 G90\nG1 X30 F6000\nX60\nX90\nX100 F600\nM2\n").below_half_feed, expected,
              1e-9);
}

TEST(ProgramTimeSlowPlaces, AreWhereTheCornersAre) {
  Machine m = machine_of(ControllerModel::kLookAhead);
  std::string text = "G21 G90\nG1 X100 F6000\n";  // line 2: fast
  for (int i = 1; i <= 40; ++i) {                 // lines 3 to 42: teeth
    text += fmt::format("X{:.2f} Y{:.2f}\n", 100 + 0.1 * i, 0.3 * (i % 2));
  }
  text += "X200 Y0\nM2\n";
  const ProgramTime time = timed(text, m);
  ASSERT_EQ(time.slowest.size(), 1u);
  EXPECT_EQ(time.slowest[0].first_line, 3u);
  EXPECT_EQ(time.slowest[0].last_line, 42u);
  EXPECT_NEAR(time.slowest[0].feed, 6000, 1e-6);
  EXPECT_NEAR(time.slowest[0].seconds_lost,
              time.slowest[0].seconds - time.slowest[0].length_mm / 100, 1e-9);
}

// --- long motions --------------------------------------------------------------------------------

// A wave of 40,000 moves with no rest takes what its one chain takes, read as a whole and in parts.
TEST_P(EveryControl, TimesALongMotionInPartsAsTheWhole) {
  const Machine m = machine_of(GetParam());
  std::string text = "G21 G90 G64\nG1 F3000 X0 Y0 Z0\n";
  for (int i = 1; i <= 40000; ++i) {
    text += fmt::format("X{:.3f} Y{:.3f}\n", 0.1 * i, 2 * std::sin(0.05 * i));
  }
  const tests::Interpreted program(text);
  const ProgramSteps steps = read_steps(program.program, program.read, from_zero());
  double whole = 0;
  const auto add = [&](const RunChain& c) {
    whole += c.seconds + ChainMotion(c.stretches).duration();
  };
  ChainCutter uncut(m, steps.steps.size() + 1);
  for (const ProgramStep& step : steps.steps) uncut.add(step, steps.controls, add);
  uncut.finish(add);
  EXPECT_NEAR(seconds_of(text, m), whole, 1e-5 * whole);
}

// --- samples -------------------------------------------------------------------------------------

struct SampledProgram {
  std::vector<ProfileSample> samples;
  double seconds = 0;
};

SampledProgram sampled(const std::string& text, const Machine& m, double period = 0.001) {
  const tests::Interpreted program(text);
  const ProgramSteps steps = read_steps(program.program, program.read, from_zero());
  SampledProgram result;
  EXPECT_TRUE(sample_program(steps, m, period, [&](const ProfileSample& s) {
    result.samples.push_back(s);
    return true;
  }));
  result.seconds = seconds_of(text, m);
  return result;
}

// 0 to 100 mm/s in .1 s, .4 s at it, .1 s down; the rapid behind it makes it come to rest.
TEST_P(EveryControl, SamplesALineAsATrapezoid) {
  const SampledProgram p = sampled("G21 G90\nG1 X50 F6000\nG0 Z1\nM2\n", machine_of(GetParam()));
  ASSERT_GE(p.samples.size(), 601u);
  const auto& s = p.samples;
  EXPECT_NEAR(s[50].place.x(), 1000 * 0.05 * 0.05 / 2, 1e-6);
  EXPECT_NEAR(s[50].acceleration.x(), 1000, 1);
  EXPECT_NEAR(s[50].jerk.x(), 0, 1);
  EXPECT_NEAR(s[300].place.x(), 5 + 20, 1e-6);
  EXPECT_NEAR(s[300].feed, 6000, 1e-3);
  EXPECT_NEAR(s[300].acceleration.x(), 0, 1e-3);
  EXPECT_EQ(s[300].line, 2u);
}

TEST_P(EveryControl, SamplesTheWholeProgram) {
  const Machine m = machine_of(GetParam());
  const std::string text =
      "G21 G90\nG0 X10 Y10 Z5\nM3 S100\nG1 Z-1 F300\nX30 F2000\nY20\nG3 X20 Y30 I-10\nG1 X0 Y0\n"
      "G4 X0.1\nG0 Z50\nM2\n";
  const SampledProgram p = sampled(text, m);
  EXPECT_GE(p.samples.back().time, p.seconds - 1e-9);
  EXPECT_LT(p.samples.back().time, p.seconds + 0.001);
  EXPECT_LT((p.samples.back().place - Point3(0, 0, 50)).norm(), 1e-9);
  for (std::size_t i = 1; i < p.samples.size(); ++i) {
    EXPECT_NEAR(p.samples[i].time - p.samples[i - 1].time, 0.001, 1e-9);
    EXPECT_GE(p.samples[i].line, p.samples[i - 1].line);
  }
}

// Between the corners no axis has more than its acceleration; in a corner of the generic model
// it may have a step of speed of what one period allows, which a period's difference shows as
// the acceleration once more. grbl's corners are steps by design.
TEST_P(EveryControl, SamplesKeepTheLimitsOfTheAxes) {
  const Machine m = machine_of(GetParam());
  if (m.model == ControllerModel::kGrbl) return;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::string text = "G21 G90\nG1 F3000\n";
    for (int i = 0; i < 40; ++i) {
      text += fmt::format("X{:.3f} Y{:.3f}\n", 3 * i + unit(random), 6 * unit(random));
    }
    const SampledProgram p = sampled(text + "G0 Z1\nM2\n", m);
    double speed = 0;
    double acceleration = 0;
    for (const ProfileSample& s : p.samples) {
      speed = std::max(speed, s.feed);
      acceleration = std::max(acceleration, s.acceleration.cwiseAbs().maxCoeff());
    }
    // The bends of LinuxCNC's corners stand for its blend arcs, evenly to some per cent.
    EXPECT_LE(speed, 3000 * (m.model == ControllerModel::kLinuxcnc ? 1.03 : 1.001));
    EXPECT_LE(acceleration, 2.05 * m.max_acceleration());
    EXPECT_GE(acceleration, 0.99 * m.max_acceleration());
  }
}

// An arc at 50 mm/s on a radius of 10 mm: v^2 / r = 250 mm/s^2 towards the centre.
TEST_P(EveryControl, SamplesABendThatPullsTowardsItsCentre) {
  const SampledProgram p =
      sampled("G21 G90\nG0 X0 Y0\nG3 X0 Y0 I-10 J0 F3000\nG0 Z1\nM2\n", machine_of(GetParam()));
  const ProfileSample& s = p.samples[p.samples.size() / 2];
  EXPECT_NEAR(s.feed, 3000, 15);
  const Point3 from_centre = s.place - Point3(-10, 0, 0);
  EXPECT_NEAR(from_centre.norm(), 10, 0.01);
  if (GetParam() == ControllerModel::kGrbl) return;  // chords: none or a step
  EXPECT_NEAR(s.acceleration.dot(from_centre) / 10, -250, 3);
}

// The corner of a square under G64 P0.01 on LinuxCNC: the samples cut it by no more than P.
TEST(ProfileOnLinuxcnc, RunsThroughTheBlendArcs) {
  const SampledProgram p = sampled("G21 G90\nG64 P0.05\nG1 X20 F3000\nY20\nG0 Z1\nM2\n",
                                   machine_of(ControllerModel::kLinuxcnc));
  double nearest = 1e9;
  for (const ProfileSample& s : p.samples) {
    nearest = std::min(nearest, (s.place - Point3(20, 0, 0)).norm());
  }
  EXPECT_GT(nearest, 0.005);
  EXPECT_LT(nearest, 0.08) << "at most P and half a period's way";
}

TEST(Profile, StopsWhenItIsTold) {
  const tests::Interpreted program("G21 G90\nG1 X50 F6000\nM2\n");
  const ProgramSteps steps = read_steps(program.program, program.read, from_zero());
  int samples = 0;
  EXPECT_FALSE(sample_program(steps, machine_of(ControllerModel::kLookAhead), 0.001,
                              [&](const ProfileSample&) { return ++samples < 10; }));
  EXPECT_EQ(samples, 10);
}

}  // namespace
}  // namespace batten::postproc
