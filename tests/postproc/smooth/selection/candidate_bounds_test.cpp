// What is said of forms before they are made must hold for them.
#include "postproc/smooth/selection/candidate_bounds.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "tests/support/one_run.h"

namespace batten::postproc {
namespace {

// Chords of a millimetre are 30 um away from where the wave bends most, and at 300 mm/min no corner
// costs time: nothing within 10 um could be faster or smaller, or nearer in as few blocks. Within
// 16 um the path that was meant is nearly in reach, for who wants to be near to it.
TEST(CandidateBounds, GiveUpARunOfCoarseChords) {
  const auto is_hopeless = [](double step, Form output = Form::kAuto, Prefer prefer = Prefer::kTime,
                              double tolerance = 0.01) {
    const OneRun run(
        wave_program({.lines = 100, .step = step, .height = 2, .length = 18, .feed = 300}));
    SmoothOptions options = options_for("linuxcnc");
    options.output = output;
    options.prefer = prefer;
    options.tolerance_mm = tolerance;
    const RunContext context = run.context();
    SmoothOptions none = options;
    none.method = Method::kNone;
    SmoothedRun so_far = run.smooth(none);
    so_far.facts.scale.alone = so_far.facts.scale.original.times.programmed;
    return CandidateBounds({run.run(), context, options}, so_far).is_hopeless();
  };
  EXPECT_TRUE(is_hopeless(1));
  EXPECT_FALSE(is_hopeless(0.1));
  EXPECT_FALSE(is_hopeless(1, Form::kArcs)) << "what is asked for by name is tried";
  EXPECT_TRUE(is_hopeless(1, Form::kAuto, Prefer::kAccuracy));
  EXPECT_TRUE(is_hopeless(1, Form::kAuto, Prefer::kTime, 0.016));
  EXPECT_FALSE(is_hopeless(1, Form::kAuto, Prefer::kAccuracy, 0.016));
}

// Chords of 1 mm of a circle of radius 10 are 1 / 80 mm high. Corners of 90 degrees are meant.
TEST(CandidateBounds, KnowHowFarChordsAreFromACurveThroughThem) {
  const std::size_t chords = 63;
  std::string text = "G21 G90 G17\nG0 X10 Y0\nF1000\n";
  for (std::size_t i = 1; i <= chords; ++i) {
    const double angle = 2 * geometry::kPi * static_cast<double>(i) / chords;
    text += fmt::format("G1 X{:.4f} Y{:.4f}\n", 10 * std::cos(angle), 10 * std::sin(angle));
  }
  const OneRun circle(text + "M2\n");
  EXPECT_NEAR(chord_height_beyond(circle.run(), 0), 0.0125, 0.0002);
  EXPECT_NEAR(chord_height_beyond(circle.run(), 0.01), 0.0025, 0.0002);
  EXPECT_EQ(chord_height_beyond(circle.run(), 0.013), 0);
  const OneRun square("G21 G90 G17\nG0 X0 Y0\nG1 X9 F900\nY9\nX0\nY0\nX9\nY9\nM2\n");
  EXPECT_EQ(chord_height_beyond(square.run(), 0), 0);
}

// The bound against every form that is made, by each model of a control. Joints are rounded by the
// control, steps round the ends: a percent is left for both.
TEST(CandidateBounds, NoFormIsFasterThanTheLeastTime) {
  std::size_t forms = 0;
  double nearest = 10;
  for (const std::string& text : {wave_program(), wave_program({.height = 0.5, .length = 40}),
                                  wave_program({.lines = 400, .height = 4.0, .length = 6.0}),
                                  circle_program(40), bend_program()}) {
    const OneRun run(text);
    const RunContext context = run.context();
    for (const std::string_view target : {"linuxcnc", "grbl", "grblhal", "klipper", "fanuc"}) {
      const SmoothOptions options = options_for(target);
      const SmoothedRun all = run.smooth(options, CandidateScope::kAll);
      const CandidateBounds bounds({run.run(), context, options}, all);
      const CostScale& scale = all.facts.scale;
      for (const Candidate& form : all.candidates) {
        const double alone =
            scale.alone + form.figures.times.programmed - scale.original.times.programmed;
        EXPECT_GE(alone, 0.99 * bounds.least_time()) << target << ' ' << form.method;
        nearest = std::min(nearest, alone / bounds.least_time());
        ++forms;
      }
    }
  }
  EXPECT_GT(forms, 100U);
  EXPECT_LT(nearest, 1.01) << "a bound that nothing comes near to leaves nothing out";
}

// Blocks of a form that there is already tell how long those of another one like it are.
TEST(CandidateBounds, KnowTheBytesOfABlockByThoseOfItsForm) {
  const OneRun run(wave_program());
  const RunContext context = run.context();
  SmoothOptions options = options_for("linuxcnc");
  options.prefer = Prefer::kSize;
  SmoothedRun so_far = run.smooth(options);
  const CostScale& scale = so_far.facts.scale;
  Candidate known = so_far.candidates.front();
  known.form = Form::kLines;
  known.figures = scale.original;
  known.figures.blocks = 0.5 * scale.original.blocks;
  known.figures.bytes = 0.5 * scale.original.bytes;
  so_far.candidates = {known};
  const CandidateBounds bounds({run.run(), context, options}, so_far);
  const auto is_beaten = [&](Form form, double blocks) {
    return bounds.is_beaten(form, blocks * scale.original.blocks / kBounds.fewer,
                            scale.original.distance);
  };
  EXPECT_TRUE(is_beaten(Form::kLines, 0.54));
  EXPECT_FALSE(is_beaten(Form::kLines, 0.5));
  EXPECT_FALSE(is_beaten(Form::kArcs, 0.54)) << "whose blocks are not known";
}

// Where noise is smoothed the path may be shorter than the bound of the time knows: a form that has
// shown it rules out none that may take as long.
TEST(CandidateBounds, KnowThatAnotherFormMayBeAsFast) {
  const OneRun run(wave_program());
  const RunContext context = run.context();
  const SmoothOptions options = options_for("linuxcnc");
  SmoothedRun so_far = run.smooth(options);
  const Figures old = so_far.facts.scale.original;
  Candidate faster = so_far.candidates.front();
  faster.figures = old;
  faster.figures.times.programmed =
      0.5 * CandidateBounds({run.run(), context, options}, so_far).least_time();
  so_far.candidates = {faster};
  const CandidateBounds bounds({run.run(), context, options}, so_far);
  EXPECT_FALSE(bounds.is_beaten(Form::kLines, 0.5 * old.blocks, 0));
  EXPECT_TRUE(bounds.is_beaten(Form::kLines, 2 * old.blocks, 2 * old.distance));
}

// What goes on faster from its neighbours is in its place faster than the bound from rest to rest.
TEST(CandidateBounds, KnowWhatMayBeWonBesideTheRun) {
  const OneRun run(wave_program());
  RunContext context = run.context();
  const SmoothOptions options = options_for("linuxcnc");
  const SmoothedRun so_far = run.smooth(options);
  const Figures& old = so_far.facts.scale.original;
  const auto is_beaten = [&] {
    const RunTask task{run.run(), context, options};
    return CandidateBounds(task, so_far).is_beaten(Form::kLines, 2 * old.blocks, 2 * old.distance);
  };
  EXPECT_TRUE(is_beaten());
  context.may_win = 0.5 * old.times.programmed;
  EXPECT_FALSE(is_beaten());
}

// A control that joins lines may be faster than the directions of single ones allow.
TEST(CandidateBounds, KnowNoDirectionsWhereTheRunItselfIsFasterThanThose) {
  const OneRun run(wave_program());
  const RunContext context = run.context();
  const SmoothOptions options = options_for("linuxcnc");
  const double along =
      least_time(run.run(), options.tolerance_mm, *options.machine, {}, options.tolerance_kind);
  const auto least_where_it_takes = [&](double seconds) {
    SmoothedRun so_far = run.smooth(options);
    so_far.facts.scale.alone = seconds;
    return CandidateBounds({run.run(), context, options}, so_far).least_time();
  };
  EXPECT_EQ(least_where_it_takes(1.01 * along), along);
  EXPECT_LT(least_where_it_takes(0.99 * along), along);
}

}  // namespace
}  // namespace batten::postproc
