// What becomes of programs of curves: kinked chains of them are smoothed, whole curves or none, and
// proved against the curves themselves; those that are fair stay.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "gcode/curves/curve_format.h"
#include "gcode/state/reason.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/runs/run_path.h"
#include "tests/support/curve_programs.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using tests::CurvePath;
using tests::CurveWord;

struct CurveCase {
  const char* name;
  CurveWord word;
  const char* target;
};

constexpr CurveCase kCases[] = {
    {"G5", CurveWord::kG5, "linuxcnc"},
    {"G51", CurveWord::kG51, "linuxcnc"},
    {"G52", CurveWord::kG52, "linuxcnc"},
    {"G5OfGrblHal", CurveWord::kG5, "grblhal"},
    {"G52Weights", CurveWord::kG52Weights, "linuxcnc"},
    {"G062", CurveWord::kG062, "fanuc"},
    {"G062Weights", CurveWord::kG062Weights, "fanuc"},
    {"Poly", CurveWord::kPoly, "siemens"},
    {"PolyRational", CurveWord::kPolyRational, "siemens"},
    {"Bspline", CurveWord::kBspline, "siemens-bspline"},
    {"BsplineWeights", CurveWord::kBsplineWeights, "siemens-bspline"},
    {"Spl", CurveWord::kSpl, "itnc530"},
};

// As the control reads it.
ReadText read_by(const gcode::Control& target, const std::string& text) {
  return ReadText(text, target.language, target.curves);
}

Verification verdict_by(const gcode::Control& target, const std::string& before,
                        const std::string& after, double tolerance) {
  const ReadText old_text = read_by(target, before);
  const ReadText new_text = read_by(target, after);
  return verify(old_text.read(), new_text.read(), tolerance);
}

class CurvesInRuns : public testing::TestWithParam<CurveCase> {
 protected:
  [[nodiscard]] std::string program(const CurvePath& path = {}) const {
    return tests::curve_program(path, GetParam().word);
  }

  // Few blocks are always a gain.
  [[nodiscard]] SmoothOptions options(Form form = Form::kAuto) const {
    SmoothOptions options = options_for(GetParam().target);
    options.prefer = Prefer::kSize;
    options.output = form;
    // LinuxCNC that joined the arcs of kinked curves would run them as fast as fair ones.
    static const Machine kJoinsNothing = [] {
      Machine machine = *find_machine("linuxcnc");
      machine.naive_cam_tolerance = 0;
      return machine;
    }();
    if (options.target->name == "linuxcnc") options.machine = &kJoinsNothing;
    return options;
  }

  [[nodiscard]] std::vector<Section> sections(const std::string& text) const {
    const ReadText read = read_by(target_, text);
    return group_runs(read.program, read.meaning, {});
  }

  const gcode::Control& target_ = *gcode::find_control(GetParam().target);
};

TEST_P(CurvesInRuns, AreOneRunOfAllTheirBlocks) {
  const CurvePath path;
  const std::string text = program(path);
  const auto found = sections(text);
  std::vector<const Section*> runs;
  for (const Section& section : found) {
    if (std::holds_alternative<postproc::Run>(section.content)) runs.push_back(&section);
  }
  ASSERT_EQ(runs.size(), 1U);
  const auto lines = static_cast<std::uint32_t>(lines_of(text).size());
  const auto head = static_cast<std::uint32_t>(
      lines_of(tests::curve_head(GetParam().word, geometry::Point3::Zero())).size());
  EXPECT_EQ(runs[0]->first_block, head);
  EXPECT_EQ(runs[0]->last_block, lines - 3);  // two are behind them
  const postproc::Run& run = std::get<postproc::Run>(runs[0]->content);
  EXPECT_EQ(std::ranges::count(run.bends, false, &RunBend::goes_on), path.pieces);
  EXPECT_EQ(run.decimals, GetParam().word == CurveWord::kPolyRational ? 6 : 3);
  EXPECT_LE(run.chord_error, 0.03 * GroupingOptions{}.tolerance_mm * (1 + 1e-9));
  const auto pieces = tests::curve_pieces(path);
  EXPECT_LT((run.points.front() - pieces.front().control[0]).norm(), 1e-9);
  EXPECT_LT((run.points.back() - pieces.back().control[3]).norm(), 1e-9);
}

// A part's tolerance that the program states in the midst of a chain, also within a curve of many
// blocks: both parts keep theirs, and no curve is torn apart.
TEST_P(CurvesInRuns, KeepTheTolerancesOfTheirParts) {
  const std::vector<std::string> lines = lines_of(program());
  const bool brackets = target_.language == gcode::Language::kRs274;
  const std::string stated = brackets ? "(TOLERANCE 0.004)" : "; TOLERANCE 0.004";
  for (std::size_t at = lines.size() / 2; at < lines.size() / 2 + 6; ++at) {
    SCOPED_TRACE(testing::Message() << "before line " << at);
    std::string text;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (i == at) text += stated + "\n";
      text += lines[i] + "\n";
    }
    const SmoothResult result = smoothed(text, options());
    ASSERT_TRUE(result.understood);
    EXPECT_TRUE(result.proved);
    expect_rest_copied(text, result);
    EXPECT_TRUE(verdict_by(target_, text, result.text, 0.01).proved());
    for (const RunReport& run : result.runs) {
      if (run.first_line <= at) continue;
      EXPECT_LE(run.deviation_mm, 0.004) << run.first_line;
    }
  }
}

// Where the control says curves itself, and where they become arcs or lines.
TEST_P(CurvesInRuns, AreSmoothedInEachFormWithinTheTolerance) {
  const std::string text = program();
  for (const Form form : {Form::kAuto, Form::kArcs, Form::kLines, Form::kCurves}) {
    SCOPED_TRACE(testing::Message() << "form " << static_cast<int>(form));
    const SmoothResult result = smoothed(text, options(form));
    ASSERT_TRUE(result.understood);
    EXPECT_TRUE(result.proved);
    EXPECT_LE(result.deviation_mm, 0.01);
    expect_rest_copied(text, result);
    EXPECT_TRUE(verdict_by(target_, text, result.text, 0.01).proved());
    if (form == Form::kCurves) continue;
    EXPECT_EQ(rewritten_runs(result), 1U) << result.runs.back().reason;
  }
}

TEST_P(CurvesInRuns, StayWhereTheyAreFair) {
  CurvePath path;
  path.kink = 0;
  path.pieces = 12;
  path.step = 5;
  path.length = 60;
  SmoothOptions fair = options();
  fair.prefer = Prefer::kTime;
  std::string text = program(path);
  if (GetParam().word == CurveWord::kG52 || GetParam().word == CurveWord::kG52Weights) {
    // Five blocks for each piece are no fair way to say them: one curve of all.
    const auto pieces = tests::curve_pieces(path);
    const int weight = GetParam().word == CurveWord::kG52 ? 1 : 2;
    std::string curve = "G5.2 P1 L3\n";
    for (const geometry::CubicBezier& piece : pieces) {
      curve +=
          fmt::format("X{:.3f} Y{:.3f} P{}\n", piece.control[3].x(), piece.control[3].y(), weight);
    }
    text = tests::curve_head(CurveWord::kG52, geometry::Point3::Zero()) + curve + "G5.3\n" +
           tests::curve_tail(CurveWord::kG52);
  }
  EXPECT_EQ(smoothed(text, fair).text, text);
}

TEST_P(CurvesInRuns, ComeOutAlikeWithAnyThreadsAndOnASecondPass) {
  const std::string text = program();
  SmoothOptions few = options();
  const std::string once = smoothed(text, few).text;
  ASSERT_NE(once, text);
  EXPECT_EQ(smoothed(once, few).text, once);
  few.threads = 2;
  EXPECT_EQ(smoothed(text, few).text, once);
}

// A place in the midst of the old curve, or of the new one, is moved by 0.05 mm.
TEST_P(CurvesInRuns, AreProvedAgainstTheCurvesThemselves) {
  const std::string text = program();
  const std::string after = smoothed(text, options(Form::kLines)).text;
  ASSERT_NE(after, text);
  const auto pieces = tests::curve_pieces({.quadratic = GetParam().word == CurveWord::kG51});
  auto moved = pieces;
  const std::size_t middle = pieces.size() / 2;
  moved[middle].control[1] += geometry::Vector3(0, 0.15, 0);
  if (GetParam().word == CurveWord::kG51) {
    moved[middle].control[2] += geometry::Vector3(0, 0.15, 0);
  }
  const std::string word = tests::words_of(pieces[middle], GetParam().word, false);
  const std::string damaged =
      replaced(text, word, tests::words_of(moved[middle], GetParam().word, false));
  EXPECT_TRUE(verdict_by(target_, text, after, 0.01).proved());
  const Verification found = verdict_by(target_, damaged, after, 0.01);
  EXPECT_FALSE(found.proved());
  ASSERT_FALSE(found.violations.empty());
}

// Random chains, in the band and with their ends exact.
TEST_P(CurvesInRuns, StayInTheBandOrAsTheyAre) {
  constexpr unsigned kPaths = 6;
  std::size_t rewritten = 0;
  for (unsigned seed = 0; seed < kPaths; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const CurvePath path{.pieces = 5 + static_cast<int>(7 * seed),
                         .step = 0.4 * (1 + seed % 4),
                         .height = 1.0 * (seed % 3),
                         .kink = 0.02 * (1 + seed % 5),
                         .from = 1.3 * seed,
                         .seed = seed};
    const std::string text = program(path);
    SmoothOptions any = options();
    any.prefer = seed % 2 == 0 ? Prefer::kSize : Prefer::kTime;
    const SmoothResult result = smoothed(text, any);
    EXPECT_TRUE(result.proved);
    EXPECT_TRUE(verdict_by(target_, text, result.text, 0.01).proved());
    expect_rest_copied(text, result);
    rewritten += rewritten_runs(result);
    if (rewritten_runs(result) == 0) {
      EXPECT_EQ(result.text, text);
    }
    const ReadText read = read_by(target_, result.text);
    const gcode::Motion& last = read.meaning.motions.at(read.meaning.motions.size() - 2);
    const geometry::Point3 end = tests::curve_pieces(path).back().control[3];
    EXPECT_LT((last.piece.end() - end).norm(), 1e-9);
  }
  EXPECT_GE(rewritten, kPaths / 3);
}

INSTANTIATE_TEST_SUITE_P(Words, CurvesInRuns, testing::ValuesIn(kCases),
                         [](const auto& test) { return std::string(test.param.name); });

// A weight of the old curve is twice as great.
TEST(CurvesInRuns, WithWeightsAreProvedWithThem) {
  const gcode::Control& fanuc = *gcode::find_control("fanuc");
  const std::string text = tests::curve_program({.step = 3}, CurveWord::kG062Weights);
  SmoothOptions options = options_for("fanuc");
  options.output = Form::kLines;
  options.prefer = Prefer::kSize;
  const std::string after = smoothed(text, options).text;
  ASSERT_NE(after, text);
  const std::string heavier = replaced(text, "R1.250000", "R2.500000");
  EXPECT_TRUE(verdict_by(fanuc, text, after, 0.01).proved());
  EXPECT_FALSE(verdict_by(fanuc, heavier, after, 0.01).proved());
}

// The same curve by weights that only move its parameter: known to kReadWithin on each side.
TEST(CurvesInRuns, WithWeightsAreProvedToNoLessThanTheyAreRead) {
  const gcode::Control& fanuc = *gcode::find_control("fanuc");
  constexpr const char* kCurve =
      "G21 G90 G17 G94\nG0 X0 Y0 Z0\nG06.2 P3 K0 X0 Y0 R{}\nK0 X0 Y10 R{}\nK0 X10 Y10 R{}\nK1\n"
      "K1\nK1\nG1 X20 F900\nM30\n";
  const std::string once = fmt::format(fmt::runtime(kCurve), "1.", ".5", "1.");
  const std::string moved = fmt::format(fmt::runtime(kCurve), "1.", ".55", "1.21");
  EXPECT_TRUE(verdict_by(fanuc, once, moved, 5 * gcode::kReadWithin).proved());
  EXPECT_FALSE(verdict_by(fanuc, once, moved, 1.5 * gcode::kReadWithin).proved());
}

// --- beside lines and arcs ----------------------------------------------------------------------

// "3-5 run; 6-6 rapid": lines count from 1.
std::string outline(const std::string& text, std::string_view target) {
  const gcode::Control& control = *gcode::find_control(target);
  const ReadText read = read_by(control, text);
  std::string said;
  for (const Section& section : group_runs(read.program, read.meaning, {})) {
    const auto* verbatim = std::get_if<Verbatim>(&section.content);
    said += fmt::format("{}{}-{} {}", said.empty() ? "" : "; ", section.first_block + 1,
                        section.last_block + 1,
                        verbatim != nullptr ? std::string(verbatim->reason) : "run");
  }
  return said;
}

constexpr const char* kCurvesHead = "G21 G90 G17 G94\nG0 X0 Y0 Z-1\nF2000\n";

TEST(CurveGroups, AreCutAtCornersAndKeptWhereTheirWordIsNeeded) {
  const std::string lead = "1-1 state-change; 2-3 rapid; ";
  const std::pair<std::string, std::string> rows[] = {
      // Lines and curves that go on in one direction, or nearly so, are one run.
      {"G1 X1\nX2\nG5 X4 Y0 I.7 J.01 P-.7 Q.01\nG1 X5\nX6\n", lead + "4-8 run"},
      // A corner beside a curve divides them.
      {"G1 X1.000\nX2\nX3\nG5 X3 Y3 I0 J1 P0 Q-1\nG5 X3 Y6 I0 J1 P0 Q-1\nG1 Y7\n",
       lead + "4-6 run; 7-9 run"},
      // Two are fewer than a run needs.
      {"G5 X1 Y0 I.3 J0 P-.3 Q0\nG5 X2 Y0 I.3 J0 P-.3 Q0\nG0 Z5\n",
       lead + "4-5 too-short; 6-6 rapid"},
      // A block that goes on from the last one, with a feed: not read, and what is before it stays.
      {"G1 X1\nX2\nX3\nG5 X4 I.3 J0 P-.3 Q0\nG5 X5 P-.3 Q0 F300\nG0 Z5\n",
       lead + "4-6 run; 7-8 spline; 9-9 rapid"},
      // The same without one belongs to it.
      {"G1 X1\nX2\nX3\nG5 X4 I.3 J0 P-.3 Q0\n\nG5 X5 P-.3 Q0\nG1 X6\n", lead + "4-10 run"},
      // All of G5.2 .. G5.3, with what is between them.
      {"G1 X1\nX2\nG5.2 L3\nX3 Y0 P1\n(a)\nX4 Y.1 P1\nX5 Y0 P1\nG5.3\nG1 X6 Y-.1\n",
       lead + "4-12 run"},
      // An axis without a word behind G5: LinuxCNC moves at rapid.
      {"G5 X1 Y0 I.3 J0 P-.3 Q0\nG5 X2 Y0 I.3 J0 P-.3 Q0\nG5 X3 Y0 I.3 J0 P-.3 Q0\nX9\nG0 Z5\n",
       lead + "4-7 spline; 8-8 rapid"},
      // A plunge is no part of a curve.
      {"G1 Z-2\nG5 X1 Y0 I.3 J0 P-.3 Q0\nG5 X2 Y0 I.3 J0 P-.3 Q0\nG5 X3 Y0 I.3 J0 P-.3 Q0\nG1 Z5\n",
       lead + "4-4 plunge; 5-7 run; 8-8 plunge"},
  };
  for (const auto& [blocks, expected] : rows) {
    EXPECT_EQ(outline(kCurvesHead + blocks, "linuxcnc"), expected) << blocks;
  }
}

TEST(CurveGroups, OfPolyStayWhereALineTakesTheirMode) {
  const std::string head = "G71 G90 G17 G94\nG0 X0 Y0 Z-1\nG1 X0.1 F2000\nX0.2\n";
  const std::string poly = "POLY PO[X]=(1) PO[Y]=(0,.01)\nPO[X]=(2) PO[Y]=(0,-.01)\nX3 PO[Y]=(0)\n";
  EXPECT_EQ(outline(head + poly + "G1 X4\nG0 Z5\n", "siemens"),
            "1-1 state-change; 2-2 rapid; 3-8 run; 9-9 rapid");
  EXPECT_EQ(outline(head + poly + "X4 F500\nG0 Z5\n", "siemens"),
            "1-1 state-change; 2-2 rapid; 3-8 spline; 9-9 rapid");
}

// Pieces of no length belong to their curve, wherever the chain is cut.
TEST(CurveGroups, TakeTheirPiecesOfNoLengthWithThem) {
  const std::string head = "G71 G90 G17 G94\nG0 X0 Y0 Z5\n";
  const std::string poly =
      "POLY PO[X]=(0) PO[Y]=(0)\nPO[X]=(1) PO[Y]=(0,.01)\nPO[X]=(2) PO[Y]=(0,-.01)\nX3 PO[Y]=(0)\n"
      "PO[X]=(3)\n";
  EXPECT_EQ(outline(head + "G1 Z-1 F2000\n" + poly + "G1 Z5\n", "siemens"),
            "1-1 state-change; 2-2 rapid; 3-3 plunge; 4-8 run; 9-9 plunge");
  EXPECT_EQ(outline(head + "G1 F2000\n" + poly + "G0 Z9\n", "siemens"),
            "1-1 state-change; 2-2 rapid; 3-3 state-change; 4-8 run; 9-9 rapid");
}

// Lines, a curve, lines and arcs: one run, in any form, with its feeds and comments.
TEST(CurveGroups, AreSmoothedWithTheLinesBesideThem) {
  const auto pieces = tests::curve_pieces({.pieces = 30});
  std::string text = tests::curve_head(CurveWord::kG5, geometry::Point3(-2, -1.3, 0)) +
                     "G1 X-1.5 Y-1.1\nX-1 Y-.8\nX-.5 Y-.4\nX0 Y0\n";
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    std::string block = tests::words_of(pieces[i], CurveWord::kG5, false);
    if (i == 9) block = replaced(block, "\n", " F1200 (slow)\n");
    if (i == 20) block = "(between)\n" + block;
    text += block;
  }
  const geometry::Point3 end = pieces.back().control[3];
  text += fmt::format("G1 X{:.3f} Y{:.3f}\nX{:.3f} Y{:.3f} F2000.\nG0 Z5.\nM2\n", end.x() + 0.3,
                      end.y() + 0.2, end.x() + 0.6, end.y() + 0.41);
  for (const Form form : {Form::kArcs, Form::kLines, Form::kCurves}) {
    SmoothOptions options = options_for("linuxcnc");
    options.prefer = Prefer::kSize;
    options.output = form;
    const SmoothResult result = smoothed(text, options);
    EXPECT_TRUE(result.proved);
    expect_rest_copied(text, result);
    EXPECT_TRUE(verdict_by(*options.target, text, result.text, 0.01).proved());
    if (form == Form::kCurves) continue;
    EXPECT_EQ(rewritten_runs(result), 1U);
    EXPECT_NE(result.text.find("(slow)"), std::string::npos);
    EXPECT_NE(result.text.find("(between)"), std::string::npos);
    EXPECT_NE(result.text.find("F1200"), std::string::npos);
  }
}

// The word of the curve is gone with it: what follows says its own, and the feed is what it was.
TEST(CurveGroups, LeaveTheStateThatWhatFollowsNeeds) {
  std::string text = tests::curve_program({}, CurveWord::kG5);
  text = replaced(text, "G0 Z5.", "M8\nG1 X40 Y0\nG0 Z5.");
  SmoothOptions options = options_for("linuxcnc");
  options.output = Form::kArcs;
  options.prefer = Prefer::kSize;
  const SmoothResult result = smoothed(text, options);
  ASSERT_EQ(rewritten_runs(result), 1U);
  const ReadText read = read_by(*options.target, result.text);
  const gcode::Motion& line = read.meaning.motions.at(read.meaning.motions.size() - 2);
  EXPECT_EQ(line.kind, gcode::MotionKind::kLine);
  EXPECT_EQ(read.meaning.states[read.meaning.blocks[line.block].state_after].feed, 2000);
}

// A control without curves gets arcs or lines of those that the user says LinuxCNC was meant to
// run.
TEST(CurveGroups, BecomeArcsForAControlWithoutCurves) {
  const std::string text = tests::curve_program({}, CurveWord::kG5);
  SmoothOptions options = options_for("grbl");
  options.source = gcode::SourceKind::kNgc;
  options.prefer = Prefer::kSize;
  const SmoothResult result = smoothed(text, options);
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(rewritten_runs(result), 1U);
  EXPECT_EQ(result.text.find("G5"), std::string::npos);
  const gcode::Control& linuxcnc = *gcode::find_control("linuxcnc");
  EXPECT_TRUE(verdict_by(linuxcnc, text, result.text, 0.01).proved());
  options.source = gcode::SourceKind::kAuto;
  EXPECT_EQ(smoothed(text, options).text, text);
}

// What the control makes of such blocks is not certain, whichever form is written for them.
TEST(CurveGroups, OfBsplineAreWarnedOf) {
  SmoothOptions options = options_for("siemens-bspline");
  options.prefer = Prefer::kSize;
  options.output = Form::kLines;
  const SmoothResult result = smoothed(tests::curve_program({}, CurveWord::kBspline), options);
  ASSERT_EQ(rewritten_runs(result), 1U);
  EXPECT_TRUE(std::ranges::any_of(result.diagnostics, [](const gcode::Diagnostic& found) {
    return found.id == "curves-unverified" && found.severity == gcode::Severity::kWarning;
  }));
}

// A weight that is not positive, a denominator that is not so everywhere, curves of another
// control: not read, so not touched.
TEST(CurveGroups, ThatAreNotReadAreCopied) {
  const std::pair<std::string, const char*> rows[] = {
      {replaced(tests::curve_program({}, CurveWord::kG52), " P1\nG5.3", " P0\nG5.3"), "linuxcnc"},
      {replaced(tests::curve_program({}, CurveWord::kPoly), ")\n", ") PO[]=(1,8)\n"), "siemens"},
      {tests::curve_program({}, CurveWord::kG5), "grbl"},
  };
  for (const auto& [text, target] : rows) {
    SmoothOptions options = options_for(target);
    options.prefer = Prefer::kSize;
    const SmoothResult result = smoothed(text, options);
    EXPECT_TRUE(result.proved) << target;
    EXPECT_EQ(result.text, text) << target;
  }
}

}  // namespace
}  // namespace batten::postproc
