// What is known of a run and what could be written instead of it.
#include "postproc/smooth/run_smoother.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "gcode/state/reason.h"
#include "postproc/smooth/selection/selection.h"
#include "tests/support/kinked_arcs.h"
#include "tests/support/one_run.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// --- what is known of a run -------------------------------------------------------------------

// Chords are off by R (1 - cos(angle / 2)): 80 of them by 1.93 um. The circle through any three
// vertices has radius 10.
TEST(SmoothRun, KnowsTheCurvatureOfACircleAndHowFarChordsAreFromIt) {
  const RunFacts facts = OneRun(circle_program(80)).smooth(options_for("linuxcnc")).facts;
  const double height = 10 * (1 - std::cos(3.141592653589793 / 160));
  EXPECT_NEAR(facts.scale.original.distance, std::sqrt(8.0 / 15) * height, 0.05 * height);
  EXPECT_LT(facts.noise, 0.0001);
  EXPECT_NEAR(facts.max_curvature, 0.1, 0.001);
  EXPECT_NEAR(facts.fair_curvature, 0.1, 0.005);
}

// Uniform scatter within 3 um has an rms of 3 / sqrt(3) um = 1.73 um, nearly all of it in Y.
TEST(SmoothRun, KnowsHowMuchVerticesScatter) {
  const Wave wave{.height = 0.5, .length = 40, .noise = 0.003, .decimals = 4};
  const RunFacts facts = OneRun(wave_program(wave)).smooth(options_for("linuxcnc")).facts;
  EXPECT_GT(facts.noise, 0.0012);
  EXPECT_LT(facts.noise, 0.0022);
  EXPECT_GE(facts.scale.original.distance, 0.7 * facts.noise) << "as far as they scatter";
}

// 31.416 mm at 3000 mm/min take 0.628 s, and a little more to start and to stop.
TEST(SmoothRun, KnowsTheTimeOfTheRun) {
  const OneRun run(circle_program(100));
  const SmoothOptions options = options_for("linuxcnc");
  const Times times = run.smooth(options).facts.scale.original.times;
  const double at_feed = 3.141592653589793 * 10 / 50;
  EXPECT_GE(times.programmed, at_feed);
  EXPECT_LT(times.programmed, 1.3 * at_feed);
}

// --- what could be written --------------------------------------------------------------------

TEST(SmoothRun, MakesEveryCandidateGoodEnoughToBeProved) {
  for (const char* target : {"linuxcnc", "grbl"}) {
    for (const std::string& text : {circle_program(100, 3), wave_program()}) {
      const OneRun run(text);
      const SmoothedRun smoothed = run.smooth(options_for(target));
      EXPECT_EQ(smoothed.reason, "");
      EXPECT_GE(smoothed.candidates.size(), 2u);
      for (const Candidate& candidate : smoothed.candidates) {
        EXPECT_TRUE(verdict(text, run.with(candidate), 0.01).proved());
        EXPECT_EQ(candidate.method, "fair");
        EXPECT_GT(candidate.figures.distance, 0);
        EXPECT_LE(candidate.figures.distance, 0.01);
        EXPECT_GT(candidate.figures.times.programmed, 0);
      }
    }
  }
}

// What is left out for being dear would not have been chosen.
TEST(SmoothRun, ChoosesAmongFewerCandidatesAsAmongAll) {
  std::size_t left_out = 0;
  std::vector<std::string> programs = {circle_program(40), circle_program(1000, 4), bend_program(),
                                       wave_program()};
  for (const double deflection : {0.002, 0.01}) {
    programs.push_back(
        tests::kinked_arc_program(tests::three_leaves, {.deflection = deflection, .decimals = 4}));
  }
  for (const auto& [height, length] :
       {std::pair{0.05, 300.0}, {0.05, 6.0}, {0.5, 40.0}, {4.0, 6.0}, {4.0, 300.0}}) {
    programs.push_back(wave_program({.lines = 400, .height = height, .length = length}));
  }
  programs.push_back(wave_program({.height = 0.5, .length = 40, .noise = 0.003, .decimals = 4}));
  programs.push_back(wave_program({.lines = 400, .step = 0.5, .height = 5, .length = 900}));
  for (const std::string& text : programs) {
    const bool is_quick = &text - programs.data() < 8;
    for (const auto& [target, prefer] : {std::pair{"linuxcnc", Prefer::kTime},
                                         {"grbl", Prefer::kTime},
                                         {"grbl", Prefer::kSize},
                                         {"fanuc", Prefer::kAccuracy}}) {
      if (!is_quick && prefer != Prefer::kTime) continue;
      const OneRun run(text);
      SmoothOptions options = options_for(target);
      options.prefer = prefer;
      const SmoothedRun few = run.smooth(options, CandidateScope::kToChoose);
      if (few.left_out) ++left_out;
      const SmoothedRun all = run.smooth(options, CandidateScope::kAll);
      const bool kept = choose(all, options).order.empty();
      EXPECT_EQ(choose(few, options).order.empty(), kept);
      if (kept && few.left_out) continue;  // what is told of it may be of one that was left out
      EXPECT_EQ(OneRun::chosen_of(few, options), OneRun::chosen_of(all, options));
    }
  }
  EXPECT_GE(left_out, 4u);
}

TEST(SmoothRun, WritesTheFormThatWasAskedFor) {
  const OneRun run(circle_program(100));
  SmoothOptions options = options_for("linuxcnc");
  for (const auto& [asked, written] :
       {std::pair{Form::kArcs, Form::kArcs}, std::pair{Form::kLines, Form::kLines}}) {
    options.output = asked;
    const std::vector<Candidate> candidates = run.smooth(options).candidates;
    EXPECT_FALSE(candidates.empty());
    for (const Candidate& candidate : candidates) {
      EXPECT_EQ(candidate.form, written);
      EXPECT_EQ(candidate.text.arcs > 0, written == Form::kArcs);
    }
  }
}

std::size_t curves_of(const std::string& text, const SmoothOptions& options) {
  const std::vector<Candidate> candidates = OneRun(text).smooth(options).candidates;
  return static_cast<std::size_t>(std::ranges::count(candidates, Form::kCurves, &Candidate::form));
}

// Curves of nearly as many blocks as there are lines are made for who asks, or to win time.
TEST(SmoothRun, MakesCurvesWhereTheyAreFewOrMayWinTime) {
  const Wave fine{.step = 0.1, .decimals = 5, .feed = 500};
  const Wave noisy{.step = 0.6, .noise = 0.005, .feed = 500};
  SmoothOptions options = options_for("siemens");
  EXPECT_GE(curves_of(wave_program(fine), options), 1U);
  EXPECT_EQ(curves_of(wave_program(noisy), options), 0U);
  Wave fast = noisy;
  fast.feed = 20000;
  EXPECT_GE(curves_of(wave_program(fast), options), 1U);
  options.output = Form::kCurves;
  EXPECT_GE(curves_of(wave_program(noisy), options), 1U);
}

// Arcs of the path that was meant are slower than 60 lines about a circle; those of the curve that
// rounds corners are not.
TEST(SmoothRun, TriesASimplerCurveWhereFarFewerBlocksAreSlower) {
  const SmoothOptions options = options_for("grbl");
  const SmoothedRun smoothed = OneRun(circle_program(60, 2)).smooth(options);
  const Selection selection = choose(smoothed, options);
  ASSERT_FALSE(selection.order.empty()) << selection.reason;
  EXPECT_LE(smoothed.candidates[selection.order.front()].figures.blocks, 30);
}

// Forms of chords as coarse as the tolerance are larger than the program, and so would be those of
// a curve that rounds corners, although a part of the time is left.
TEST(SmoothRun, TriesNoOtherCurveWhereAllFormsAreLarger) {
  SmoothOptions options = options_for("linuxcnc");
  const OneRun run(
      wave_program({.lines = 120, .step = 0.3, .height = 1.2, .length = 7.2, .feed = 6000}));
  const auto curves_of = [&] {
    std::set<double> curvatures;
    for (const Candidate& each : run.smooth(options).candidates) {
      curvatures.insert(each.max_curvature);
    }
    return curvatures.size();
  };
  EXPECT_EQ(choose(run.smooth(options), options, Among::kFormsAlone).reason,
            gcode::reason::kLarger);
  EXPECT_EQ(curves_of(), 1u);
  options.prefer = Prefer::kSize;
  EXPECT_GT(curves_of(), 1u);
}

// Nor where the control is told curves, and each form costs more than the blocks as they are.
TEST(SmoothRun, TriesNoSimplerCurveWhereAllFormsAreLargerAndCostMore) {
  const SmoothOptions options = options_for("siemens");
  ASSERT_TRUE(options.target->curves_in_auto);
  const OneRun run(
      "G21 G17 G90\nG0 X0 Y0 Z0\nG1 F1800\n"
      "G2 X1.168 Y-0.133 I0.023 J-5.000\nG2 X2.893 Y-0.639 I-1.375 J-7.881\n"
      "G2 X4.100 Y-1.523 I-1.113 J-2.786\nG2 X6.127 Y-5.227 I-5.756 J-5.556\nG0 Z5\nM30\n");
  const SmoothedRun smoothed = run.smooth(options);
  EXPECT_FALSE(smoothed.candidates.empty());
  EXPECT_EQ(choose(smoothed, options, Among::kFormsAlone).reason, gcode::reason::kLarger);
  EXPECT_TRUE(std::ranges::all_of(smoothed.candidates, [&](const Candidate& c) {
    const CostScale& scale = smoothed.facts.scale;
    return cost_of(c.figures, scale, options.prefer) >=
           cost_of(scale.original, scale, options.prefer);
  }));
  EXPECT_TRUE(std::ranges::none_of(
      smoothed.tried, [](const TriedForm& form) { return form.key.role == CurveRole::kRounding; }));
}

// A zigzag of chords of 4 mm, each turned by 40 degrees: all of its vertices are corners.
std::string zigzag_of_corners(int feed) {
  std::string text = head("G21") + fmt::format("F{}\n", feed);
  for (int i = 1; i <= 60; ++i)
    text += fmt::format("G1 X{:.4f} Y{:.4f}\n", 3.76 * i, 1.368 * (i % 2));
  return text + tail();
}

// Lines of fewest links are counted before they are made: not all that could be are laid.
TEST(SmoothRun, LaysLinksOnlyWhereTheirCountMayWin) {
  SmoothOptions options = options_for("linuxcnc");
  options.prefer = Prefer::kSize;
  const auto lines_of = [&](const OneRun& run, CandidateScope scope) {
    return std::ranges::count(run.smooth(options, scope).candidates, Form::kLines,
                              &Candidate::form);
  };
  std::ptrdiff_t chosen = 0;
  std::ptrdiff_t all = 0;
  for (const std::string& text : {wave_program(), wave_program({.height = 0.5, .length = 40}),
                                  wave_program({.lines = 400, .height = 4.0, .length = 6.0})}) {
    const OneRun run(text);
    chosen += lines_of(run, CandidateScope::kToChoose);
    all += lines_of(run, CandidateScope::kAll);
  }
  EXPECT_LE(chosen, 18);  // 26 by what the curvature says alone
  EXPECT_GT(all, 26);
}

// At 500 mm/min 4 % of the time are left to win, at 1000 mm/min 10 %.
TEST(SmoothRun, RoundsCornersByAnotherCurveWhereThatMayWinMuch) {
  SmoothOptions options = options_for("siemens");
  options.machine = find_machine("high-speed");
  const auto forms = [&](int feed) {
    return OneRun(zigzag_of_corners(feed)).smooth(options).candidates.size();
  };
  EXPECT_GT(forms(500), 0U);
  EXPECT_LT(forms(500), forms(1000));
  EXPECT_EQ(forms(2000), forms(1000));
}

// Half a circle, in chords that are all on it.
TEST(SmoothRun, SaysACircleInFewArcs) {
  SmoothOptions options = options_for("linuxcnc");
  options.output = Form::kArcs;
  const std::vector<Candidate> candidates =
      OneRun(circle_program(200, 3)).smooth(options).candidates;
  ASSERT_FALSE(candidates.empty());
  std::size_t fewest = 200;
  for (const Candidate& candidate : candidates) {
    EXPECT_EQ(candidate.form, Form::kArcs);
    EXPECT_LE(candidate.text.arcs, 20u) << "those that are nearer than it is printed";
    fewest = std::min(fewest, candidate.text.arcs);
  }
  EXPECT_LE(fewest, 2u) << "two halves: those in the whole band";
}

// --- what is kept -----------------------------------------------------------------------------

TEST(SmoothRun, SaysWhyThereIsNoCandidate) {
  const OneRun run(wave_program());
  SmoothOptions none = options_for("linuxcnc");
  none.method = Method::kNone;
  EXPECT_EQ(run.smooth(none).reason, gcode::reason::kMethodNone);
  SmoothOptions tiny = options_for("linuxcnc");
  tiny.tolerance_mm = 0.00005;  // less than rounding to four decimals costs
  EXPECT_EQ(run.smooth(tiny).reason, gcode::reason::kNoFit);
  for (const SmoothOptions& options : {none, tiny}) {
    const SmoothedRun kept = run.smooth(options);
    EXPECT_TRUE(kept.candidates.empty());
    EXPECT_GT(kept.facts.scale.original.times.programmed, 0) << "its time is known all the same";
    EXPECT_GT(kept.facts.max_curvature, 0);
  }
}

// A run in space that is no helix, for a target that takes no helices, in arcs alone.
TEST(SmoothRun, SaysThatTheTargetCannot) {
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z0\nG1 X0 F3000\n";
  for (int i = 1; i <= 100; ++i) {
    text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", 0.2 * i, 2 * std::sin(0.1 * i),
                        std::sin(0.17 * i));
  }
  SmoothOptions options = options_for("linuxcnc");
  options.output = Form::kArcs;
  const SmoothedRun kept = OneRun(text + "G0 Z5\nM2\n").smooth(options);
  EXPECT_TRUE(kept.candidates.empty());
  EXPECT_EQ(kept.reason, gcode::reason::kTargetCannot);
}

// Chords a little higher than the tolerance, and slow: only the vertices can be moved.
TEST(RunSmoother, LeavesNothingOutWhenItStartsAgain) {
  const SmoothOptions options = options_for("grbl");
  const OneRun run(
      wave_program({.lines = 60, .step = 0.8, .height = 2, .length = 18, .feed = 600}));
  RunState state{0, run.context(), run.smooth(options, CandidateScope::kToChoose)};
  EXPECT_TRUE(state.smoothed.left_out);
  state.start_again(run.run(), options);
  EXPECT_FALSE(state.smoothed.left_out);
  ASSERT_NE(state.chosen(), nullptr);
  EXPECT_TRUE(state.chosen()->has_vertices);
}

// The curve through scattered vertices is itself off by some of the scatter, and so is every form
// along it; but what rounding makes is no scatter, and of a curve that the tolerance holds nothing
// is known.
TEST(SmoothRun, KnowsWhatScatterLeavesUnknown) {
  const auto smoothed_with = [](double noise, double tolerance) {
    SmoothOptions options = options_for("grbl");
    options.tolerance_mm = tolerance;
    return OneRun(wave_program({.noise = noise})).smooth(options);
  };
  const SmoothedRun noisy = smoothed_with(0.008, 0.05);
  EXPECT_GT(noisy.facts.scattered, 0.001);
  for (const Candidate& c : noisy.candidates) {
    EXPECT_GE(c.figures.distance, noisy.facts.scattered);
  }
  EXPECT_EQ(smoothed_with(0, 0.05).facts.scattered, 0);
  EXPECT_EQ(smoothed_with(0.008, 0.01).facts.scattered, 0);
}

// Its numbers are rounded anew, to thousandths: no vertex is so far from its own that this would be
// more than the tolerance.
TEST(RunSmoother, MovesVerticesByWhatTheirPrintingLeaves) {
  SmoothOptions options = options_for("grbl");
  options.prefer = Prefer::kAccuracy;
  const SmoothResult result = smoothed(
      "G21 G17 G90 G94\nG0 X25.6738 Y28.2651 Z5\nG1 Z-0.2 F1000\nG1 X25.5726 Y27.9429\n"
      "X25.3654 Y27.6826\nX25.0522 Y27.4844\nX24.633 Y27.3482\nG0 Z10\nM30\n",
      options);
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(rewritten_runs(result), 1U);
}

}  // namespace
}  // namespace batten::postproc
