// What is said of forms before they are made must hold for them.
#include "postproc/smooth/selection/candidate_bounds.h"

#include <gtest/gtest.h>

#include "tests/support/one_run.h"

namespace batten::postproc {
namespace {

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
