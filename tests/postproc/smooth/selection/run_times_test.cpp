// What a run takes where it is, at three settings of the feed override.
#include "postproc/smooth/selection/run_times.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

#include "postproc/runs/run_path.h"
#include "tests/support/one_run.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// A wave with the speed of its spindle in each block, as some posts write it.
std::string wave_with_speeds() {
  return head("G21") + joined(wave_lines({}), " S12000\n") + tail();
}

TEST(RunTimes, HaveARestAtEachSpeedOfTheSpindleOnLinuxcnc) {
  const SmoothResult with = smoothed(wave_with_speeds(), options_for("linuxcnc"));
  const SmoothResult without = smoothed(wave_program(), options_for("linuxcnc"));
  EXPECT_GT(with.runs_before_s, 3 * without.runs_before_s);
  EXPECT_EQ(rewritten_runs(with), 1U);
  EXPECT_NEAR(with.runs_after_s, without.runs_after_s, 0.01 * without.runs_after_s);
  EXPECT_EQ(with.text.find("S12000", with.text.find("F2000")), std::string::npos);
}

TEST(RunTimes, AreThoseOfTheWayWhereSpeedsOfTheSpindleDoNotWait) {
  const SmoothResult with = smoothed(wave_with_speeds(), options_for("grbl"));
  const SmoothResult without = smoothed(wave_program(), options_for("grbl"));
  EXPECT_EQ(with.runs_before_s, without.runs_before_s);
}

// A half circle of 31.4 mm at 3000 mm/min: far from what limits the axes at half of the feed.
TEST(RunTimes, FollowTheOverrideAsFarAsTheMachineCan) {
  const OneRun run(circle_program(100));
  const Machine& machine = *find_machine("linuxcnc-fast");
  const std::vector<TimedPiece> motions = timed_pieces(run.run(), 0, 100);
  const Times times = times_of(motions, machine, gcode::PathMode::kBlending);
  EXPECT_EQ(times.programmed, cutting_time(motions, machine, gcode::PathMode::kBlending));
  EXPECT_GT(times.at_half, 1.8 * times.programmed);
  EXPECT_LT(times.at_half, 2 * times.programmed);
  EXPECT_LE(times.at_one_and_half, times.programmed);
  EXPECT_GE(times.at_one_and_half, times.programmed / 1.5);
  for (auto [feed_override, expected] :
       {std::pair{0.5, times.at_half}, {1.5, times.at_one_and_half}}) {
    std::vector<TimedPiece> overridden = motions;
    for (TimedPiece& each : overridden) each.feed *= feed_override;
    EXPECT_EQ(cutting_time(overridden, machine, gcode::PathMode::kBlending), expected);
  }
}

// Moves about a cut are timed thrice, and count once. LinuxCNC joins lines from where a part begins.
TEST(ChainTimes, AreThoseOfTheWholeChain) {
  for (const char* name : {"linuxcnc-fast", "linuxcnc", "router"}) {
    const Machine& machine = *find_machine(name);
    const OneRun run(wave_program({.lines = 19000, .height = 2, .length = 600}));
    const std::vector<TimedPiece> motions = timed_pieces(run.run(), 0, 19000);
    const gcode::PathControl path = gcode::PathMode::kBlending;
    const Times whole = times_of(motions, machine, path);
    for (const std::size_t at_once : {std::size_t{1}, std::size_t{700}, motions.size()}) {
      ChainTimes times(machine, path);
      for (std::size_t i = 0; i < motions.size(); i += at_once) {
        times.add(std::span(motions).subspan(i, std::min(at_once, motions.size() - i)));
      }
      const Times parts = times.finish();
      EXPECT_NEAR(parts.programmed, whole.programmed, 1e-4 * whole.programmed) << name;
      EXPECT_NEAR(parts.at_half, whole.at_half, 1e-4 * whole.at_half) << name;
      EXPECT_NEAR(parts.at_one_and_half, whole.at_one_and_half, 1e-4 * whole.at_one_and_half);
    }
  }
}

// A machine with jerk hardly slows down for a bend that is as tight as a cusp and shorter than it
// needs to; speeds that the bend itself could be held at would take hundreds of times as long.
TEST(RunTimes, AreThoseOfAPlanHoweverTightABendIs) {
  const Machine& machine = *find_machine("high-speed");
  std::vector<TimedPiece> chain;
  for (int i = 0; i < 3; ++i) {
    const double x = 10 * i;
    for (const auto& [from, to] : {std::pair{0.0, 0.5}, {0.5, 1.0}}) {
      TimedPiece piece;
      piece.piece = geometry::sub_piece(
          geometry::CubicBezier{
              {{x, 0, 0}, {x + 9.999, 10, 0}, {x + 0.001, 10, 0}, {x + 10, 0, 0}}},
          from, to);
      piece.feed = 6000;
      chain.push_back(piece);
    }
  }
  const double planned = cutting_time(chain, machine, gcode::PathMode::kBlending);
  EXPECT_LT(planned, 5);
  EXPECT_NEAR(times_of(chain, machine, gcode::PathMode::kBlending).programmed, planned,
              1e-9 * planned);
}

// Steps of a staircase, each shorter than what a control that may leave them rounds off.
std::string stairs_after(const std::string& path_words) {
  std::string text = head("G21") + path_words + "\nG1 F2500\n";
  for (int i = 1; i <= 200; ++i) {
    text += fmt::format("X{:.1f} Y{:.1f}\n", 0.1 * ((i + 1) / 2), 0.1 * (i / 2));
  }
  return text + tail();
}

// A path tolerance of the program counts, not the one that the machine starts with.
TEST(RunTimes, AreThoseUnderTheTolerancesOfG64) {
  SmoothOptions options = options_for("linuxcnc");
  const auto before = [&](const std::string& words) {
    return smoothed(stairs_after(words), options).runs_before_s;
  };
  for (const auto& [words, tolerances] : {std::pair{"G64", std::pair{0.0, 0.0}},
                                          {"G64 P0.02", {0.02, 0.02}},
                                          {"G64 P0.02 Q0", {0.02, 0}},
                                          {"G64 P0.002 Q0.001", {0.002, 0.001}}}) {
    SCOPED_TRACE(words);
    Machine machine = *options.machine;
    std::tie(machine.blend_tolerance, machine.naive_cam_tolerance) = tolerances;
    const OneRun run(stairs_after(""));
    const std::vector<TimedPiece> motions = timed_pieces(run.run(), 0, run.run().points.size() - 1);
    EXPECT_EQ(before(words), cutting_time(motions, machine, gcode::PathMode::kBlending));
  }
  EXPECT_GT(before("G64 P0.002"), 1.2 * before("G64"));
}

}  // namespace
}  // namespace batten::postproc
