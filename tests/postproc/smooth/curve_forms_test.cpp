// Which forms of a curve are made.
#include "postproc/smooth/curve_forms.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "tests/support/one_run.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// On a circle, where chords as near as they may be would be as many as there were.
TEST(CurveForms, AreChordsInClearlyFewerBlocks) {
  for (const char* target : {"linuxcnc", "siemens"}) {
    SCOPED_TRACE(target);
    const OneRun run(circle_program(100));
    const SmoothedRun all = run.smooth(options_for(target));
    const double before = all.facts.scale.original.blocks;
    EXPECT_TRUE(std::ranges::any_of(all.candidates, [&](const Candidate& c) {
      return c.form == Form::kLines && c.figures.blocks <= kCost.clearly_smaller * before &&
             c.figures.blocks >= 0.8 * before;
    }));
  }
}

// A spiral of a half to one millimetre in chords that each turn by 0.2 rad: what follows its bends
// is longer than they are by two thousandths, and so is its time. A little inside it is not.
TEST(CurveForms, AreInsideBendsThatChordsCutShort) {
  std::string spiral = "G21 G90 G17 G64\nG0 X0.5 Y0\nF400\n";
  for (int i = 1; i < 60; ++i) {
    const double radius = 0.5 + 0.01 * i;
    spiral +=
        fmt::format("G1 X{:.3f} Y{:.3f}\n", radius * std::cos(0.2 * i), radius * std::sin(0.2 * i));
  }
  const SmoothOptions options = options_for("linuxcnc");
  const SmoothedRun run = OneRun(spiral).smooth(options);
  const Selection chosen = choose(run, options);
  ASSERT_FALSE(chosen.order.empty()) << chosen.reason;
  const Candidate& best = run.candidates[chosen.order.front()];
  EXPECT_EQ(best.key.role, CurveRole::kInside);
  const Figures& before = run.facts.scale.original;
  EXPECT_LE(best.figures.blocks, kCost.clearly_smaller * before.blocks);
  EXPECT_LE(best.figures.distance, before.distance);
  int along_the_bends = 0;
  for (const Candidate& c : run.candidates) {
    if (c.key.role != CurveRole::kFirst || c.has_run_in_place) continue;
    ++along_the_bends;
    EXPECT_EQ(objection_to(c.figures, run.facts.scale, options.prefer), Objection::kSlower);
  }
  EXPECT_GT(along_the_bends, 0);
}

// Lines in their room are the same however high they may be, and what two deviations allow may
// have one and the same text.
TEST(CurveForms, AreMadeOnce) {
  std::string steps = "G21 G90 G64\nG0 X0 Y0\nF2000\n";
  for (int i = 0; i <= 40; ++i) {
    steps += fmt::format("G1 X{:.1f} Y{:.1f}\n", 0.1 * ((i + 1) / 2), 0.1 * (i / 2));
  }
  for (const char* target : {"linuxcnc", "fanuc", "siemens"}) {
    SCOPED_TRACE(target);
    const SmoothedRun all = OneRun(steps).smooth(options_for(target));
    std::set<std::string> texts;
    for (const Candidate& c : all.candidates) texts.insert(c.text.text);
    ASSERT_GT(texts.size(), 3U);
    EXPECT_EQ(texts.size(), all.candidates.size());
  }
}

// A wave in chords that are as high as the tolerance, or a quarter higher: no form in fewer blocks
// is within it, but the vertices can be moved outwards by two thirds of a chord's height.
std::string coarse_wave(double chord_height) {
  std::string text = "G21 G90 G17 G64\nG0 X0 Y0\nF1200\n";
  double x = 0;
  while (x < 40) {
    const double bend = std::abs(0.25 * std::sin(x / 2)) + 0.02;  // about, 1/mm
    x += std::sqrt(8 * chord_height / bend);
    text += fmt::format("G1 X{:.3f} Y{:.3f}\n", x, std::sin(x / 2));
  }
  return text;
}

TEST(CurveForms, OfCoarseChordsAreTheirVerticesMoved) {
  for (const double height : {0.008, 0.0125}) {
    SCOPED_TRACE(height);
    const SmoothOptions options = options_for("grbl");
    const OneRun run(coarse_wave(height));
    const SmoothedRun made = run.smooth(options, CandidateScope::kToChoose);
    const Selection selection = choose(made, options);
    ASSERT_FALSE(selection.order.empty()) << selection.reason;
    const Candidate& chosen = made.candidates[selection.order.front()];
    EXPECT_TRUE(chosen.has_vertices);
    EXPECT_EQ(chosen.figures.blocks, made.facts.scale.original.blocks);
    EXPECT_LE(chosen.figures.distance, 0.7 * made.facts.scale.original.distance);
    const SmoothResult result = smoothed(coarse_wave(height), options);
    EXPECT_TRUE(result.proved);
    EXPECT_LE(result.deviation_mm, 0.01);
    EXPECT_EQ(smoothed(result.text, options).text, result.text);
  }
}

// What is printed anew would be as far off as the chords are.
TEST(CurveForms, HaveNoVerticesMovedByLessThanIsPrinted) {
  std::string text = "G21 G90 G17 G64\nG0 X0 Y0\nF1200\n";
  for (int i = 1; i <= 100; ++i) {
    const double x = 0.35 * i;
    text += fmt::format("G1 X{:.2f} Y{:.4f}\n", x, 0.00004 * x * x + 0.001 * std::sin(x));
  }
  const OneRun run(text);
  const SmoothedRun all = run.smooth(options_for("grbl"));
  EXPECT_TRUE(std::ranges::none_of(all.candidates, &Candidate::has_vertices));
}

// They are what is left to do where no form is better than the run.
TEST(CurveForms, HaveVerticesMovedWhereNothingElseWillDo) {
  const OneRun run(wave_program({.noise = 0.001}));
  for (const char* target : {"grbl", "linuxcnc"}) {
    const SmoothedRun all = run.smooth(options_for(target));
    EXPECT_FALSE(choose(all, options_for(target), Among::kFormsAlone).order.empty());
    EXPECT_TRUE(std::ranges::none_of(all.candidates, &Candidate::has_vertices));
  }
}

// A wing section (NACA 2412) of 80 mm, its vertices rounded to 0.001 mm.
std::string wing_program(int count) {
  const auto half = [](double x, double side) {
    constexpr double kCamber = 0.02;
    constexpr double kAt = 0.4;
    const double thick = 0.6 * (0.2969 * std::sqrt(x) - 0.126 * x - 0.3516 * x * x +
                                0.2843 * x * x * x - 0.1036 * x * x * x * x);
    const double from = x < kAt ? 0 : 1 - 2 * kAt;
    const double over = kCamber / std::pow(x < kAt ? kAt : 1 - kAt, 2);
    const double middle = over * (from + 2 * kAt * x - x * x);
    const double angle = std::atan(2 * over * (kAt - x));
    return std::pair(80 * (x - side * thick * std::sin(angle)),
                     80 * (middle + side * thick * std::cos(angle)));
  };
  std::string text = "G21 G90 G17 G64\nG0 X80 Y0 Z5\nG1 Z-1 F300\nF500\n";
  for (int i = 1 - count; i <= count; ++i) {
    const double x = 0.5 * (1 - std::cos(geometry::kPi * std::abs(i) / count));
    const auto [px, py] = half(x, i < 0 ? 1 : -1);
    text += fmt::format("G1 X{:.3f} Y{:.3f}\n", px, py);
  }
  return text + "G0 Z5\nM2\n";
}

// Arcs of its nose are slower than its chords by more than is allowed. Without the run there
// it would be lines, seven for ten of the chords.
TEST(CurveForms, HaveTheRunWhereTheyAreSlower) {
  SmoothOptions options = options_for("linuxcnc");
  options.machine = find_machine("linuxcnc");
  const SmoothResult result = smoothed(wing_program(150), options);
  EXPECT_TRUE(result.proved);
  EXPECT_LE(result.blocks_out, 0.6 * result.blocks_in);
  EXPECT_LE(result.runs_after_s, result.runs_before_s + options.machine->servo_period);
}

// A plunge, a part of a circle in chords about the origin, and up again.
std::string round_program(double radius, double sweep, int chords) {
  std::string text = fmt::format("G21 G90 G17\nG0 X{:.3f} Y0 Z5\nG1 Z-1 F600\nF1500\n", radius);
  for (int i = 1; i <= chords; ++i) {
    text += fmt::format("G1 X{:.3f} Y{:.3f}\n", radius * std::cos(sweep * i / chords),
                        radius * std::sin(sweep * i / chords));
  }
  return text + "G0 Z5\nM2\n";
}

// One for each third of a turn. LinuxCNC starts an arc slowly after a plunge: it gets some chords
// there, and a short arc.
TEST(CurveForms, OfPartsOfCirclesAreArcs) {
  for (const char* target : {"linuxcnc", "fanuc", "grbl", "siemens"}) {
    SmoothOptions options = options_for(target);
    const bool is_linuxcnc = std::string_view(target) == "linuxcnc";
    if (is_linuxcnc) options.machine = find_machine(target);
    for (const auto& [radius, sweep, chords] :
         {std::tuple(10.0, 2 * geometry::kPi, 100), std::tuple(12.0, geometry::kPi / 2, 60),
          std::tuple(12.0, 3.49, 160), std::tuple(20.0, 4.0, 150), std::tuple(35.0, -3.0, 100),
          std::tuple(50.0, -2 * geometry::kPi, 200)}) {
      SCOPED_TRACE(testing::Message() << target << ", radius " << radius);
      const SmoothResult result = smoothed(round_program(radius, sweep, chords), options);
      EXPECT_TRUE(result.proved);
      const auto arcs = static_cast<std::size_t>(std::ceil(std::abs(sweep) / 2.0944));
      const std::size_t others = result.blocks_in - chords;
      if (is_linuxcnc) {
        EXPECT_LE(result.blocks_out, others + arcs + 10);
      } else {  // a comment, and for some the motion as it was
        EXPECT_GE(result.blocks_out, others + arcs + 1);
        EXPECT_LE(result.blocks_out, others + arcs + 2);
      }
      EXPECT_LE(result.runs_after_s, 1.001 * result.runs_before_s);
    }
  }
}

// Its vertices are rounded to more than its chords leave it, and the curve follows some of that:
// all of them are on one circle, and what is printed anew is no farther off than they are.
TEST(CurveForms, OfADenseCircleAreArcs) {
  for (const char* target : {"fanuc", "grbl", "linuxcnc"}) {
    for (const auto& [radius, chords] : {std::pair(10.0, 400), std::pair(25.0, 3000)}) {
      SCOPED_TRACE(testing::Message() << target << ", radius " << radius);
      const std::string text = round_program(radius, 2 * geometry::kPi, chords);
      const SmoothResult result = smoothed(text, options_for(target));
      EXPECT_TRUE(result.proved);
      const std::size_t ends = std::string_view(target) == "linuxcnc" ? 30 : 0;
      EXPECT_LE(result.blocks_out, result.blocks_in - chords + 5 + ends);
    }
  }
}

// Two lines and two half circles, in chords as CAM makes them: these come out, and the distance is
// that from them: chords with a sagitta of e are sqrt(8/15) e off an arc.
TEST(CurveForms, OfASlotAreItsLinesAndArcs) {
  constexpr double kRadius = 5;
  constexpr int kChords = 30;
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F600\nF1500\n";
  for (const int side : {1, -1}) {
    const double from = side > 0 ? 0 : 30;
    for (int i = 1; i <= 6; ++i) {
      text += fmt::format("G1 X{} Y{}\n", from + side * 5 * i, side > 0 ? 0 : 2 * kRadius);
    }
    for (int i = 1; i <= kChords; ++i) {
      const double angle = geometry::kPi * i / kChords;
      text += fmt::format("G1 X{:.3f} Y{:.3f}\n", 30 - from + side * kRadius * std::sin(angle),
                          kRadius - side * kRadius * std::cos(angle));
    }
  }
  text += "G0 Z5\nM2\n";
  const double arcs = 2 * geometry::kPi * kRadius;
  const double sagitta = kRadius * (1 - std::cos(geometry::kPi / kChords / 2));
  const double off = std::sqrt(8.0 / 15 * arcs / (arcs + 60)) * sagitta;
  for (const char* target : {"linuxcnc", "fanuc", "grbl", "siemens"}) {
    SCOPED_TRACE(target);
    SmoothOptions options = options_for(target);
    const bool is_linuxcnc = std::string_view(target) == "linuxcnc";
    if (is_linuxcnc) options.machine = find_machine(target);
    const SmoothResult result = smoothed(text, options);
    EXPECT_TRUE(result.proved);
    EXPECT_LE(result.blocks_out, is_linuxcnc ? 18U : 16U);
    EXPECT_LE(result.runs_after_s, result.runs_before_s + options.machine->servo_period);
    const Figures& before = OneRun(text).smooth(options).facts.scale.original;
    EXPECT_NEAR(before.distance, off, 0.02 * off);
  }
}

// CAM made its chords for the tolerance that they are smoothed within: they leave their arcs by
// nearly all of it.
TEST(CurveForms, OfChordsAsHighAsTheToleranceAreTheirArcs) {
  constexpr double kRadius = 3;
  constexpr int kChords = 10;
  std::string text = "G21 G90 G17\nG0 X3 Y0 Z5\nG1 Z-1 F600\nF1500\n";
  for (int corner = 0; corner < 4; ++corner) {
    const double x = corner == 0 || corner == 1 ? 50 - kRadius : kRadius;
    const double y = corner == 0 || corner == 3 ? kRadius : 30 - kRadius;
    for (int i = 0; i <= kChords; ++i) {
      const double angle = geometry::kPi / 2 * (corner - 1 + static_cast<double>(i) / kChords);
      text += fmt::format("G1 X{:.3f} Y{:.3f}\n", x + kRadius * std::cos(angle),
                          y + kRadius * std::sin(angle));
    }
  }
  text += "G0 Z5\nM2\n";
  for (const char* target : {"linuxcnc", "siemens"}) {
    SCOPED_TRACE(target);
    SmoothOptions options = options_for(target);
    options.machine = find_machine(std::string_view(target) == "linuxcnc" ? target : "mill");
    const SmoothResult result = smoothed(text, options);
    EXPECT_TRUE(result.proved);
    EXPECT_LE(result.blocks_out, 19U);
  }
}

// What is left of a circle by a control that cuts arcs coarsely is chords, and those are off it.
TEST(CurveForms, SayHowFarChordsOfACircleAreOffIt) {
  SmoothOptions options = options_for("klipper");
  options.output = Form::kArcs;
  const SmoothedRun all =
      OneRun(round_program(4, 2 * geometry::kPi, 100)).smooth(options, CandidateScope::kAll);
  ASSERT_FALSE(all.candidates.empty());
  std::size_t chords = 0;
  for (const Candidate& each : all.candidates) {
    if (!each.arcs_as_chords) continue;
    ++chords;
    EXPECT_GT(each.figures.distance, 2 * all.facts.scale.printed);
  }
  EXPECT_GT(chords, 0U);
}

// Pixels of 0.1 mm with ramps between them: what rounds each corner takes twice as many blocks.
TEST(CurveForms, AmongCornersHaveVerticesMovedThatTurnLess) {
  std::string text = "G21 G90 G17 G64 P0.01\nG0 X0 Y0 Z0\nF1800\n";
  double x = 0;
  double z = 0;
  for (int i = 0; i < 60; ++i) {
    text += fmt::format("G1 X{:.3f} Z{:.3f}\n", x += 0.1, z += i % 20 < 10 ? 0.1 : -0.1);
    text += fmt::format("G1 X{:.3f} Z{:.3f}\n", x += 0.1 + 0.1 * (i % 3), z);
  }
  const OneRun run(text + "G0 Z5\nM2\n");
  const SmoothOptions options = options_for("linuxcnc");
  const SmoothedRun all = run.smooth(options, CandidateScope::kToChoose);
  const Selection selection = choose(all, options);
  ASSERT_FALSE(selection.order.empty());
  const Candidate& chosen = all.candidates[selection.order.front()];
  EXPECT_TRUE(chosen.has_vertices);
  EXPECT_LT(chosen.figures.times.programmed, 0.95 * all.facts.scale.original.times.programmed);
  EXPECT_LE(chosen.figures.blocks, all.facts.scale.original.blocks);
}

}  // namespace
}  // namespace batten::postproc
