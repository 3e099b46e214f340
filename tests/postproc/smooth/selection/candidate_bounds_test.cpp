// What is said of forms before they are made must hold for them.
#include "postproc/smooth/selection/candidate_bounds.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "postproc/smooth/selection/selection.h"
#include "tests/support/one_run.h"

namespace batten::postproc {
namespace {

std::vector<std::string> programs() {
  std::vector<std::string> all = {circle_program(40), circle_program(400), circle_program(2000)};
  for (const double height : {0.05, 0.5, 4.0}) {
    for (const double length : {6.0, 40.0, 300.0}) {
      all.push_back(wave_program({.lines = 600, .height = height, .length = length}));
      all.push_back(wave_program({.lines = 600, .height = height, .length = length, .feed = 300}));
    }
  }
  return all;
}

// No form costs less than is said of its blocks and its distance.
TEST(CandidateBounds, AreBelowWhatFormsCost) {
  int counted = 0;
  for (const std::string& text : programs()) {
    const OneRun run(text);
    for (const Prefer prefer : {Prefer::kTime, Prefer::kAccuracy, Prefer::kSize}) {
      SmoothOptions options = options_for("linuxcnc");
      options.prefer = prefer;
      const RunContext context = run.context();
      const SmoothedRun smoothed = run.smooth(options);
      for (const Candidate& c : smoothed.candidates) {
        SmoothedRun alone = smoothed;
        alone.candidates = {c};
        const RunTask task{run.run(), context, options};
        if (choose(alone, options).order.empty()) continue;
        ++counted;
        alone.candidates.clear();
        const CandidateBounds bounds(task, alone);
        EXPECT_FALSE(bounds.is_beaten(c.form, c.figures.blocks, c.figures.distance))
            << text.substr(0, 100);
      }
    }
  }
  EXPECT_GE(counted, 50);
}

// Chords of a millimetre are 30 um away from where the wave bends most, and at 300 mm/min no corner
// costs time: nothing within 10 um could be faster or smaller, or nearer in as few blocks.
TEST(CandidateBounds, GiveUpARunOfCoarseChords) {
  const auto is_hopeless = [](double step) {
    const OneRun run(
        wave_program({.lines = 100, .step = step, .height = 2, .length = 18, .feed = 300}));
    const SmoothOptions options = options_for("linuxcnc");
    const RunContext context = run.context();
    SmoothOptions none = options;
    none.method = Method::kNone;
    SmoothedRun so_far = run.smooth(none);
    so_far.facts.scale.alone = so_far.facts.scale.original.times.programmed;
    return CandidateBounds({run.run(), context, options}, so_far).is_hopeless();
  };
  EXPECT_TRUE(is_hopeless(1));
  EXPECT_FALSE(is_hopeless(0.1));
}

}  // namespace
}  // namespace batten::postproc
