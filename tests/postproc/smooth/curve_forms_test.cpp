// Which forms of a curve are made.
#include "postproc/smooth/curve_forms.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
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

}  // namespace
}  // namespace batten::postproc
