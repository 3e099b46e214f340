// Which forms of a curve are made.
#include "postproc/smooth/curve_forms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/one_run.h"

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

}  // namespace
}  // namespace batten::postproc
