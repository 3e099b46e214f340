// What may be rewritten together, and why the rest may not.
#include "postproc/runs/run_grouping.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "gcode/state/reason.h"
#include "postproc/runs/run_path.h"
#include "tests/support/interpreted.h"
#include "tests/support/kinked_arcs.h"

namespace batten::postproc {
namespace {

using geometry::Point3;
namespace reason = gcode::reason;

struct Grouped {
  explicit Grouped(const std::string& text, GroupingOptions options = {})
      : it(text), sections(group_runs(it.program, it.read, options)) {}

  [[nodiscard]] std::vector<const Section*> runs() const {
    std::vector<const Section*> found;
    for (const Section& section : sections) {
      if (std::holds_alternative<Run>(section.content)) {
        found.push_back(&section);
      }
    }
    return found;
  }
  [[nodiscard]] const Run& only_run() const { return std::get<Run>(runs().at(0)->content); }

  // "1-3 state-change; 4-9 run; .." with lines that count from 1.
  [[nodiscard]] std::string outline() const {
    std::string text;
    for (const Section& section : sections) {
      const auto* verbatim = std::get_if<Verbatim>(&section.content);
      text += text.empty() ? "" : "; ";
      text += std::to_string(section.first_block + 1) + "-" +
              std::to_string(section.last_block + 1) + " " +
              (verbatim != nullptr ? std::string(verbatim->reason) : "run");
    }
    return text;
  }

  tests::Interpreted it;
  std::vector<Section> sections;
};

// The first arcs of a curve, the first `rising` of which go down.
std::string arcs_program(std::size_t arcs, std::size_t rising = 0) {
  const std::vector<std::string> blocks = tests::arc_blocks(tests::three_leaves, {});
  std::string text = "G21 G90 G94 G17\nG0 X36.0 Y0 Z0\n";
  for (std::size_t i = 0; i < arcs; ++i) {
    text += blocks[i] + (i < rising ? " Z-0." + std::to_string(i + 1) : "") + "\n";
  }
  return text;
}

constexpr const char* kStart = "G21 G90 G94 G17 S500\nG0 X0 Y0 Z0 F100\n";  // 2 lines
constexpr const char* kThree = "G1 X1\nX2 Y1\nX3\n";
constexpr const char* kThreeMore = "G1 X4\nX5 Y2\nX6\n";

struct BetweenCase {
  const char* name;
  const char* block;     // between two chains of three motions
  const char* why = "";  // it ends the run; empty: it does not
};
void PrintTo(const BetweenCase& test, std::ostream* out) { *out << test.block; }

class BetweenTwoChains : public testing::TestWithParam<BetweenCase> {};

TEST_P(BetweenTwoChains, EndsTheRunForItsReasonOrGoesWithIt) {
  const Grouped grouped(std::string(kStart) + kThree + GetParam().block + "\n" + kThreeMore);
  const std::string why = GetParam().why;
  EXPECT_EQ(grouped.outline(), "1-1 state-change; 2-2 rapid; " +
                                   (why.empty() ? "3-9 run" : "3-5 run; 6-6 " + why + "; 7-9 run"));
}

INSTANTIATE_TEST_SUITE_P(
    RunGrouping, BetweenTwoChains,
    testing::Values(
        BetweenCase{"EmptyLine", ""}, BetweenCase{"Comment", "(text)"},
        BetweenCase{"Number", "N60"}, BetweenCase{"Feed", "F200"},
        BetweenCase{"RepeatedModes", "G1 G90 G21 F100 S500"},
        BetweenCase{"MotionWithFeed", "X3.5 F300"}, BetweenCase{"MotionWithoutLength", "X3"},
        BetweenCase{"Rapid", "G0 Z5", "rapid"},
        BetweenCase{"Arc", "G2 X3 Y2 I0 J.5", "intended-arc"},
        BetweenCase{"ArcWithCoolant", "G2 X3 Y2 J.5 M8", "coolant"},
        BetweenCase{"Coolant", "M8", "coolant"}, BetweenCase{"Spindle", "S600", "spindle"},
        BetweenCase{"SpindleBesideMotion", "X3.5 S600", "spindle"},
        BetweenCase{"Dwell", "G4 P1", "dwell"}, BetweenCase{"OtherM", "M62 P0", "misc-function"},
        BetweenCase{"Plane", "G18", "state-change"},
        BetweenCase{"ActiveComment", "(MSG, hi)", "active-comment"},
        BetweenCase{"Rotary", "A30", "other-axis"}, BetweenCase{"Extruder", "X3.5 E1", "extruder"},
        BetweenCase{"Assignment", "#1=2", "parameter-assignment"},
        BetweenCase{"Jump", "IF [#1 GT 2] GOTO 99", "program-flow"}),
    [](const auto& test) { return test.param.name; });

struct OutlineCase {
  const char* name;
  std::string text;
  const char* outline;
};
void PrintTo(const OutlineCase& test, std::ostream* out) { *out << test.text; }

class Outline : public testing::TestWithParam<OutlineCase> {};

TEST_P(Outline, CoversTheProgram) {
  EXPECT_EQ(Grouped(GetParam().text).outline(), GetParam().outline);
}

INSTANTIATE_TEST_SUITE_P(
    RunGrouping, Outline,
    testing::Values(
        // What it runs may move the axes: both have to be named again.
        OutlineCase{"StartsAnewAfterAFunctionOfTheUser",
                    std::string(kStart) + kThree + "M101\n" + kThreeMore,
                    "1-1 state-change; 2-2 rapid; 3-5 run; 6-6 misc-function; "
                    "7-8 position-unknown; 9-9 too-short"},
        OutlineCase{"StartsAfterTheMotionThatMakesThePositionKnown",
                    "G21\nG1 X0 Y0 F9\nX1\nX2\nX3\n",
                    "1-1 state-change; 2-2 position-unknown; 3-5 run"},
        OutlineCase{"ZIsNamedForTheFirstTimeInTheMiddle",
                    "G21\nG0 X0 Y0 F9\nG1 X1\nX2\nX3\nZ1\nX4\nX5\nX6\n",
                    "1-1 state-change; 2-2 rapid; 3-5 run; 6-6 position-unknown; 7-9 run"},
        OutlineCase{"KeepsWhatIsAroundARun",
                    "(head)\n\nG21\nG0 X0 Y0 F9\n(before)\nG1 X1\nX2\nX3\n(after)\n\nM30\n(end)\n",
                    "1-3 state-change; 4-5 rapid; 6-8 run; 9-12 program-end"},
        OutlineCase{"KeepsAFeedAfterARun", "G21\nG0 X0 Y0 F9\nG1 X1\nX2\nX3\nF20\n(end)\n",
                    "1-1 state-change; 2-2 rapid; 3-5 run; 6-7 comment"},
        OutlineCase{"KeepsComments", "(only)\n\n", "1-2 comment"}, OutlineCase{"Nothing", "", ""},
        OutlineCase{"CopiesMotionsWithoutLengthAtItsEnds",
                    std::string(kStart) + "G1 X0 F50\n" + kThree + "X3 F70\nM9\n",
                    "1-1 state-change; 2-2 rapid; 3-3 too-short; 4-6 run; 7-7 too-short; "
                    "8-8 coolant"},
        OutlineCase{"JoinsNeighboursThatAreKeptForOneReason", "G21\nG0 X0\nY0\n\nZ0\nM3\n",
                    "1-1 state-change; 2-5 rapid; 6-6 spindle"},
        OutlineCase{"NoFeed", "G21\nG0 X0 Y0 Z0\nG1 X1\nX2\nX3\n",
                    "1-1 state-change; 2-2 rapid; 3-5 feed-unknown"},
        OutlineCase{"CutsWhereARampMeetsItsFloor", arcs_program(8, 4),
                    "1-1 state-change; 2-2 rapid; 3-6 run; 7-10 run"},
        // A bare G2 is no block: an arc word that is needed after a run cannot be given back.
        OutlineCase{"TakesTheLastArc", arcs_program(8) + "M9\nG0 Z5\n",
                    "1-1 state-change; 2-2 rapid; 3-10 run; 11-11 coolant; 12-12 rapid"},
        OutlineCase{"EndsBeforeAnArcWhoseWordIsNeeded", arcs_program(8) + "M98 P5\n",
                    "1-1 state-change; 2-2 rapid; 3-9 run; 10-10 arc; 11-11 subprogram"}),
    [](const auto& test) { return test.param.name; });

TEST(RunGrouping, CopiesChainsThatAreTooShort) {
  EXPECT_EQ(Grouped(std::string(kStart) + "G1 X1\nX1\nX2\n").outline(),
            "1-1 state-change; 2-2 rapid; 3-5 too-short");
  GroupingOptions options;
  options.min_motions = 2;
  EXPECT_EQ(Grouped(std::string(kStart) + "G1 X1\nX1\nX2\n", options).outline(),
            "1-1 state-change; 2-2 rapid; 3-5 run");
}

TEST(Run, HasThePlacesInMillimetres) {
  const Grouped grouped("G20\nG0 X0 Y0 Z0 F10\nG1 X1 Z-.125\nY2\nX0 Y0 Z0\n");
  const postproc::Run& run = grouped.only_run();
  ASSERT_EQ(run.points.size(), 4U);
  EXPECT_LT((run.points[1] - Point3(25.4, 0, -3.175)).norm(), 1e-12);
  EXPECT_LT((run.points[2] - Point3(25.4, 50.8, -3.175)).norm(), 1e-12);
  EXPECT_TRUE(run.closed);
  EXPECT_EQ(run.decimals, 3);  // of -.125, as written
  ASSERT_EQ(run.feeds.size(), 1U);
  EXPECT_EQ(run.feeds[0].feed, 254.0);
  EXPECT_EQ(run.state, grouped.it.line(2).state_after);
}

TEST(Run, ChangesTheFeedWhereItsWordStood) {
  const Grouped grouped(std::string(kStart) +
                        "G1 X1 F100\nX2 F200\nX3 F200.0\nF300\nX4\nX4 F400\nX5\nX6 F100\n");
  const auto& feeds = grouped.only_run().feeds;
  ASSERT_EQ(feeds.size(), 5U);
  const std::vector<std::pair<std::size_t, double>> expected = {
      {0, 100}, {1, 200}, {3, 300}, {4, 400}, {5, 100}};
  for (std::size_t i = 0; i < feeds.size(); ++i) {
    EXPECT_EQ(feeds[i].vertex, expected[i].first);
    EXPECT_EQ(feeds[i].feed, expected[i].second);
  }
}

TEST(Run, DropsThePointsOfMotionsWithoutLengthButNotTheirComments) {
  const Grouped grouped(std::string(kStart) +
                        "G1 X1 (a)\nX2\n(b)\nX2 (c)\n; d\nX3 (e) (f)\n(after)\n");
  const postproc::Run& run = grouped.only_run();
  EXPECT_EQ(run.points.size(), 4U);
  std::string comments;
  for (const CommentAt& comment : run.comments) {
    comments += std::to_string(comment.vertex);
    comments += grouped.it.program.source.text(comment.text);
  }
  EXPECT_EQ(comments, "1(a)3(b)3(c)3; d3(e)3(f)");
}

TEST(Run, StandsAtZeroOnAxesThatItDoesNotName) {
  const Grouped grouped("G21\nG0 X0 Y0 Z7 F9\nG28 Z0\nG1 X1\nX2\nX3\n");
  for (const Point3& point : grouped.only_run().points) {
    EXPECT_EQ(point.z(), 0.0);
  }
}

TEST(ArcsInRuns, PiecesOfACurveAreARun) {
  const Grouped grouped(tests::kinked_arc_program(tests::three_leaves));
  ASSERT_EQ(grouped.runs().size(), 1U);
  const postproc::Run& run = grouped.only_run();
  EXPECT_TRUE(run.closed);
  EXPECT_EQ(run.bends.size(), motion_count(run));
  EXPECT_LE(run.chord_error, 0.05 * GroupingOptions{}.tolerance_mm);
  EXPECT_EQ(grouped.outline().find("arc"), std::string::npos);
}

TEST(ArcsInRuns, FeedsAndCommentsStayAtTheEndsOfMotions) {
  const std::vector<std::string> blocks = tests::arc_blocks(tests::three_leaves, {});
  std::string text = arcs_program(6) + "(note)\n" + blocks[6] + " (here)\n";
  for (std::size_t i = 7; i < 12; ++i) {
    text += blocks[i].substr(0, blocks[i].find(" F")) + (i == 9 ? " F300\n" : "\n");
  }
  const Grouped grouped(text);
  const postproc::Run& run = grouped.only_run();
  ASSERT_EQ(run.bends.size(), 12U);
  ASSERT_EQ(run.feeds.size(), 2U);
  EXPECT_EQ(run.feeds[1].vertex, run.bends[9].first);
  ASSERT_EQ(run.comments.size(), 2U);
  EXPECT_EQ(run.comments[0].vertex, run.bends[6].last);
  EXPECT_EQ(run.comments[1].vertex, run.bends[6].last);
}

constexpr const char* kFillet = "G1 X1\nX2\nX3\nG3 X4 Y1 J1\nG1 Y2\nY3\nY4\n";
constexpr const char* kFilletAway =  // 3 degrees from the line before it
    "G1 X1\nX2\nX3\nG3 X3.946 Y1.051 I-.0523 J.9986\nG1 Y2\nY3\nY4\n";

TEST(ArcsInRuns, EndARunWhereTheyAreIntended) {
  const std::pair<const char*, const char*> rows[] = {
      {kFillet, "3-5 run; 6-6 intended-arc; 7-9 run"},
      {kFilletAway, "3-9 run"},
      {"G1 X1\nX2\nX3\nG3 X3 Y0 I.02 J5\nG1 X4\nX5\nX6\n", "3-5 run; 6-6 intended-arc; 7-9 run"},
      {"G1 X9\nG3 X9 Y4 J2\nG1 X0\nG3 X0 Y0 J-2\n",
       "3-3 too-short; 4-4 intended-arc; 5-5 too-short; 6-6 intended-arc"},
      {"G2 X2 Y0 I1 J-5\nG2 X4 Y-.837 I-1.279 J-5.862\nG0 Z5\n", "3-4 too-short; 5-5 rapid"}};
  for (const auto& [blocks, outline] : rows) {
    EXPECT_EQ(Grouped(std::string(kStart) + blocks).outline(),
              std::string("1-1 state-change; 2-2 rapid; ") + outline);
  }
}

// All others, and what ends them: tests/postproc/stream/unsafe_states_test.cpp.
TEST(UnsafeStates, KeepTheirMotionsOrLetThemBeRewritten) {
  const std::pair<const char*, const char*> rows[] = {// words, and why the motions are kept
                                                      {"M128", "tool-center-point"},
                                                      {"M128\nM129", ""},
                                                      {"G60", "exact-stop"},
                                                      {"G63", "state-unknown"},
                                                      {"G99", "state-unknown"},
                                                      {"M98 P1", "state-unknown"},
                                                      {"/G20", "units-unknown"},
                                                      {"/G91", "state-unknown"},
                                                      {"G5.1 Q1", ""},
                                                      {"G18", ""},
                                                      {"G81 X0 Y0 Z-1 R1\nG80 G99\nG94", ""}};
  for (const auto& [words, why] : rows) {
    const Grouped grouped(std::string(kStart) + words + "\nF100\nG0 X0 Y0 Z0\nG1 X1 Y1 Z1\n" +
                          kThree);
    const auto* kept = std::get_if<Verbatim>(&grouped.sections.back().content);
    EXPECT_EQ(kept != nullptr ? kept->reason : "", why) << words;
    EXPECT_EQ(grouped.runs().size(), kept != nullptr ? 0U : 1U) << words;
  }
}

TEST(UnsafeStates, AModalMacroIsOne) {
  gcode::ModalState state;
  state.units = gcode::Units::kMillimetre;
  state.feed = 100;
  EXPECT_EQ(unsafe_state(state, {}), std::string_view());
  state.modal_macro = gcode::TriState::kOn;
  EXPECT_EQ(unsafe_state(state, {}), reason::kModalMacro);
}

TEST(UnsafeStates, AllowLiftsTheExactPathOnly) {
  GroupingOptions options;
  options.allowed = {reason::kExactStop, reason::kIncremental};
  const std::string motions = std::string("G0 X0 Y0 Z0\n") + kThree;
  EXPECT_EQ(Grouped(kStart + ("G61\n" + motions), options).runs().size(), 1U);
  EXPECT_EQ(Grouped(kStart + ("G61.1\n" + motions), options).runs().size(), 0U);
  EXPECT_EQ(Grouped(kStart + ("G91\n" + motions), options).runs().size(), 0U);
}

TEST(RunGrouping, CoversEveryBlockOnceAndRunsMeetTheirMotions) {
  static constexpr const char* kBlocks[] = {
      "G1 X1", "Y2",  "X3 Y1", "Z-1",      "G1 X4 F200", "(c)", "",       "G0 Z5", "M8",
      "X5",    "G91", "G90",   "G2 X1 R9", "G1 X6 Y6",   "T1",  "F300",   "G28",   "/X1",
      "X7",    "Y8",  "X9",    "N10 X10",  "G41",        "G40", "M98 P1", "#1=2",  "G61"};
  constexpr int kPrograms = 400;
  std::size_t runs = 0;
  for (int seed = 0; seed < kPrograms; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(static_cast<unsigned>(seed));
    // Cubed: early entries come more often, so that there are runs.
    std::uniform_real_distribution<double> pick(0, 1);
    std::string text = "G21 G90 G94\nG0 X0 Y0 Z0 F100\n";
    for (int i = 0; i < 80; ++i) {
      const double p = pick(random);
      text += kBlocks[static_cast<std::size_t>(p * p * p * std::size(kBlocks))];
      text += '\n';
    }
    const Grouped grouped(text);
    std::uint32_t next = 0;
    for (const Section& section : grouped.sections) {
      ASSERT_EQ(section.first_block, next);
      ASSERT_GE(section.last_block, section.first_block);
      next = section.last_block + 1;
      const auto* run = std::get_if<postproc::Run>(&section.content);
      if (run == nullptr) {
        continue;
      }
      ++runs;
      const auto motion_of = [&](std::uint32_t block) {
        const auto motion = grouped.it.read.blocks[block].motion;
        return motion < 0 ? nullptr : &grouped.it.read.motions[static_cast<std::size_t>(motion)];
      };
      ASSERT_NE(motion_of(section.first_block), nullptr);
      ASSERT_NE(motion_of(section.last_block), nullptr);
      ASSERT_EQ(run->points.front(), motion_of(section.first_block)->piece.start());
      ASSERT_EQ(run->points.back(), motion_of(section.last_block)->piece.end());
      ASSERT_GE(run->points.size(), 4U);
      ASSERT_EQ(run->feeds.front().vertex, 0U);
      for (std::size_t i = 1; i < run->points.size(); ++i) {
        ASSERT_NE(run->points[i - 1], run->points[i]);
      }
    }
    ASSERT_EQ(next, grouped.it.read.blocks.size());
  }
  EXPECT_GT(runs, 200U);
}

}  // namespace
}  // namespace batten::postproc
