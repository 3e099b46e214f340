// Runs of one shape get one form, and a run that differs in anything is none of them.
#include "postproc/smooth/repeated_runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "postproc/smooth/part_runs.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

struct Pass {
  double x = 0;
  double z = -1;
  std::string feed = "2000";
  std::string before = {};         // lines before its first cut
  std::string comment = {};        // of a line in it
  double last_height = 0;          // of its last vertex, off the wave
  std::string rest = "G4 P0.1\n";  // between its plunge and its first cut
  std::string plunge_feed = "300";
  std::string lift = "";  // behind its last cut
};

std::string lines_of_pass(const Pass& pass) {
  std::string text =
      pass.before +
      fmt::format("G0 X{:.4f} Y0\nG1 Z{:.3f} F{}\n", pass.x, pass.z, pass.plunge_feed) + pass.rest;
  for (int i = 1; i <= 80; ++i) {
    const double y = 3 * std::sin(0.12 * i) + (i == 80 ? pass.last_height : 0);
    text += fmt::format("{}X{:.4f} Y{:.4f}{}{}\n", i == 1 ? "G1 " : "", pass.x + 0.4 * i, y,
                        i == 1 ? " F" + pass.feed : "", i == 40 ? pass.comment : "");
  }
  return text + pass.lift + "G0 Z5\n";
}

ProgramPart part_of(const std::vector<Pass>& passes) {
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\n";
  for (const Pass& pass : passes) text += lines_of_pass(pass);
  gcode::Diagnostics found;
  gcode::Program program = gcode::parse(gcode::SourceText("passes.nc", text + "M2\n"), found);
  gcode::Interpretation meaning = gcode::interpret(program, {}, found);
  return {std::move(program), std::move(meaning), {}};
}

std::vector<RunInContext> runs_in(const PartRuns& runs) {
  std::vector<RunInContext> all;
  for (const RunState& work : runs.works) {
    all.push_back({&std::get<Run>(runs.sections[work.section].content), &work.context});
  }
  return all;
}

std::vector<std::size_t> firsts_in(const std::vector<Pass>& passes,
                                   const std::string& target = "linuxcnc") {
  const ProgramPart part = part_of(passes);
  const SmoothOptions options = options_for(target);
  const PartRuns runs = find_runs(part, options);
  EXPECT_EQ(runs.works.size(), passes.size());
  return firsts_of_shapes(runs_in(runs), options);
}

using Firsts = std::vector<std::size_t>;

TEST(RepeatedRuns, AreFoundInOtherDepthsAndPlaces) {
  EXPECT_EQ(firsts_in({{}, {.z = -2}, {.x = 50}, {.x = 50.25, .z = -3.5}}), (Firsts{0, 0, 0, 0}));
}

// What the program says beyond the tolerance of the user, 0.01 mm, is none.
TEST(RepeatedRuns, AreFoundWhereTheSameToleranceHolds) {
  EXPECT_EQ(firsts_in({{},
                       {.before = "(TOLERANCE 0.005)\n"},
                       {.before = "(TOLERANCE 0.05)\n"},
                       {.before = "(TOL 0.005)\n"}}),
            (Firsts{0, 1, 0, 1}));
}

// Each differs in what a form of the first would be wrong or worse for.
TEST(RepeatedRuns, AreOnesThatDifferInNothingElse) {
  EXPECT_EQ(firsts_in({{}, {.feed = "1500"}, {.feed = "1500"}}), (Firsts{0, 1, 2}))
      << "only the first of a shape is asked";
  EXPECT_EQ(firsts_in({{}, {.comment = " (here)"}}), (Firsts{0, 1}));
  EXPECT_EQ(firsts_in({{}, {.last_height = 0.0002}}), (Firsts{0, 1}));
  EXPECT_EQ(firsts_in({{}, {.before = "G18\n"}}), (Firsts{0, 1}));
  EXPECT_EQ(firsts_in({{}, {.x = 50.0002}}), (Firsts{0, 0}));
  EXPECT_EQ(firsts_in({{}, {.x = 50.0002}}, "grbl"), (Firsts{0, 1})) << "it has steps of 0.001 mm";
}

// A plunge from farther above ends alike; one that ends faster takes another time with the run.
TEST(RepeatedRuns, MayFollowFromPlungesOfOtherDepths) {
  EXPECT_EQ(firsts_in({{.rest = ""}, {.z = -2, .rest = ""}, {.x = 50, .z = -3.5, .rest = ""}}),
            (Firsts{0, 0, 0}));
  EXPECT_EQ(firsts_in({{.rest = ""}, {.rest = "", .plunge_feed = "600"}, {}}), (Firsts{0, 1, 2}));
}

// So does a lift to another height.
TEST(RepeatedRuns, MayBeFollowedByLiftsToOtherHeights) {
  EXPECT_EQ(firsts_in({{.lift = "G1 Z1 F300\n"}, {.z = -2, .lift = "G1 Z2 F300\n"}, {}}),
            (Firsts{0, 0, 2}));
}

// The words of a pass but for its depth.
std::vector<std::string> texts_in(const std::vector<Pass>& passes, const SmoothOptions& options) {
  const ProgramPart part = part_of(passes);
  PartRuns runs = find_runs(part, options);
  EXPECT_TRUE(smooth_runs(
      part, options, [](double) { return true; }, runs));
  std::vector<std::string> texts;
  for (const RunState& work : runs.works) {
    const Candidate* chosen = work.chosen();
    EXPECT_NE(chosen, nullptr);
    texts.push_back(chosen != nullptr ? chosen->text.text : "");
    for (const Candidate& candidate : work.smoothed.candidates) {
      EXPECT_FALSE(candidate.plan.has_value()) << "plans of long programs take much room";
    }
  }
  return texts;
}

// Fitted anew each would come out the same.
TEST(RepeatedRuns, GetTheFormThatTheyWouldGetAlone) {
  for (const char* target : {"linuxcnc", "grbl", "fanuc", "siemens", "heidenhain"}) {
    SCOPED_TRACE(target);
    SmoothOptions options = options_for(target);
    options.prefer = Prefer::kSize;
    const auto together = texts_in({{}, {.z = -2}, {.x = 50}}, options);
    ASSERT_EQ(together.size(), 3U);
    EXPECT_EQ(together[1], together[0]);
    EXPECT_EQ(texts_in({{.x = 50}}, options).at(0), together[2]);
  }
}

TEST(RepeatedRuns, AreFittedAnewWhereThePlanCannotBeSaidThere) {
  const ProgramPart part = part_of({{}, {.z = -2}});
  const SmoothOptions options = options_for("linuxcnc");
  const PartRuns runs = find_runs(part, options);
  const auto both = runs_in(runs);
  const SmoothedRun first =
      smooth_run(*both[0].run, *both[0].context, options, CandidateScope::kToRepeat);
  const geometry::Vector3 down(0, 0, -1);
  ASSERT_EQ(offset_of_repeat(both[0], both[1], options), down);
  EXPECT_TRUE(smooth_repeat(*both[1].run, *both[1].context, options, first, down).has_value());
  RunContext no_room = *both[1].context;
  no_room.numbers = {.first = 10, .blocks = 1};
  EXPECT_FALSE(smooth_repeat(*both[1].run, no_room, options, first, down).has_value());
}

}  // namespace
}  // namespace batten::postproc
