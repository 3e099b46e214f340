// Blocks that control can reach from elsewhere are found, and only those.
#include "gcode/interpreter/program_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "gcode/state/reason.h"
#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

using tests::Interpreted;
using Lines = std::vector<std::size_t>;

struct FlowCase {
  const char* text;
  Lines labels;   // lines whose N number is referenced
  Lines targets;  // lines that are jumped to
  Lines bodies;   // lines inside loops, subprograms, contours
};

const FlowCase kFlowRows[] = {
    {"N10 G1 X1\nN20 X2\nM98 P20\nG4 P10\n", {}, {}, {}},
    {"N10 X1\nN20 X2\nIF [#1 EQ 2] GOTO 20\n", {2}, {2}, {}},
    {"N10 X1\nGOTO N10\n", {1}, {1}, {}},
    {"GOTOF N30\nN20 X1\nn 30 X2\n", {3}, {3}, {}},
    {"GOTO 10\nN10 X1\nN20 X2\nGOTO 20\n", {2, 3}, {2, 3}, {}},
    {"N10 X1\nX2\nN20 X3\nGOTO #5\n", {1, 3}, {1, 3}, {}},
    {"M97 P50\nM30\nN50 X1\n", {3}, {3}, {}},
    {"M96 P50 Q5\nX1\nN50 X1\nM46 Q1 P60\nN60 X1\n", {3, 5}, {3, 5}, {}},
    {"M98 P1000 H30\nN30 X1\n", {2}, {2}, {}},
    {"N10 X1\nM30\nO5\nX1\nM99 P10\n", {1}, {1}, {3, 4, 5}},
    {"X1\nX2\nM99\n", {}, {}, {1, 2, 3}},
    {"O1\nX1\nM30\nO2\nX1\nM99\n", {}, {}, {4, 5, 6}},
    {"o<subdo> call\nX1\no<endif> call [1]\nX2\n", {}, {}, {}},
    {"o[#[1]+2] sub\nX1\no[#[1]+2] endsub\nX2\n", {}, {}, {1, 2, 3}},
    {"o##1 sub\nX1\no##1 endsub\nX2\n", {}, {}, {1, 2, 3}},
    {"o<call> sub\nX1\no<call> endsub\nX2\n", {}, {}, {1, 2, 3}},
    {"X1\nWHILE [#1 LT 3] DO1\nX2\nEND1\nX3\n", {}, {}, {2, 3, 4}},
    {"WHILE[#1LT3]DO1\nX1\nDO2\nX2\nEND2\nX3\nEND1\nX4\n", {}, {}, {1, 2, 3, 4, 5, 6, 7}},
    {"o<part> sub\nX1\no<part> endsub\nX2\n", {}, {}, {1, 2, 3}},
    {"o1 repeat [3]\nX1\no1 endrepeat\nX2\n", {}, {}, {1, 2, 3}},
    {"o1 if [#1 GT 2]\nX1\no1 else\nX2\no1 endif\nX3\n", {}, {}, {1, 2, 3, 4, 5}},
    {"o1 call [3]\nX1\n", {}, {}, {}},
    {"G71 P10 Q20\nN10 G0 X1\nX2\nN20 X3\nX4\n", {2, 4}, {}, {2, 3, 4}},
    {"N2 X1\nG73 X1 Z-2 R1 P1 Q2\nN1 X2\n", {}, {}, {}},
    {"%\nN10 X1\n%\nGOTO 10\n", {}, {}, {}}};

constexpr const char* kMain = "G90 G40 G80\nG17 G21\nM6 T1\nG0 X0\nG1 X1 F100\nX2\n";

bool is_body(const std::string& text) {
  Diagnostics found;
  const Program program = parse(SourceText("test.nc", text), found);
  const std::vector<BlockFlow> flow = follow_flow(program, Returns::kBehindCalls).blocks;
  return std::ranges::any_of(flow,
                             [](const BlockFlow& each) { return each.in_body || each.in_called; });
}

// A program for Centroid ends so. It says for itself what the end of the round before, or a caller,
// could have left; where it does not, its blocks are entered in states that are not seen.
TEST(AProgramThatStartsAgain, IsNoBodyWhereItSetsItsModesItself) {
  const std::string main = kMain;
  EXPECT_FALSE(is_body(main + "M5\nM99\n"));
  EXPECT_FALSE(is_body("%\nO1\n" + main + "M99\n(end)\n%\n"));
  EXPECT_TRUE(is_body(main + "M99 P10\n"));
  EXPECT_TRUE(is_body(main + "M99\nX1\n"));
  EXPECT_TRUE(is_body(main + "/M99\nX1\nM99\n"));
  EXPECT_TRUE(is_body(main + "M99\nO2\nX1\nM30\n"));
  EXPECT_TRUE(is_body(main + "TRANS X1\nM99\n"));
  for (const char* lasting :
       {"G68 X0 Y0 R30", "G51 X2", "G16", "G93", "G92 X1", "G10 L2 P1 X1", "G52 X1", "M98 P2000",
        "M97 P5", "M21", "M75", "M102", "M#1", "G5.1 Q2", "G66 P100", "G#1"}) {
    EXPECT_TRUE(is_body(main + lasting + "\nM99\n")) << lasting;
  }
  for (const std::string word : {"G90", "G40", "G17", "G21", "M6"}) {
    std::string without = main;
    without.replace(without.find(word), word.size(), "G94");
    EXPECT_TRUE(is_body(without + "M99\n")) << word;
    std::string may_skip = main;
    may_skip.insert(may_skip.rfind('\n', may_skip.find(word)) + 1, "/");
    EXPECT_TRUE(is_body(may_skip + "M99\n")) << word << " that may be skipped";
    EXPECT_TRUE(is_body(without + word + "\nM99\n")) << word << " behind the cut";
  }
}

TEST(Flow, IsFound) {
  for (const FlowCase& test : kFlowRows) {
    SCOPED_TRACE(test.text);
    Diagnostics found;
    const Program program = parse(SourceText("test.nc", test.text), found);
    const std::vector<BlockFlow> flow = follow_flow(program, Returns::kBehindCalls).blocks;
    Lines labels;
    Lines targets;
    Lines bodies;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      if (flow[i].label_referenced) labels.push_back(i + 1);
      if (flow[i].jump_target) targets.push_back(i + 1);
      if (flow[i].in_body || flow[i].in_called) bodies.push_back(i + 1);
    }
    EXPECT_EQ(labels, test.labels);
    EXPECT_EQ(targets, test.targets);
    EXPECT_EQ(bodies, test.bodies);
  }
}

struct CallCase {
  const char* text;
  Lines labels;  // that may be returned to
};

const CallCase kCallsRows[] = {{"N10 X1\nX2\nM98 P2000\nN20 X3\n", {1, 4}},
                               {"N10 X1\nG65 P9010 A1\n", {1}},
                               {"N10 X1\nG66 P9010 A1\n", {1}},
                               {"N10 X1\nM198 P1\n", {1}},
                               {"N10 X1\nM98 P#1\nM30\nO1\nX2\nM99\n", {1}},
                               {"N10 X1\nM98 <PART>\n", {1}},
                               {"N10 X1\nIF [#1 EQ 2] M98 P2000\n", {1}},
                               {"N10 X1\nPART(1,2)\n", {1}},
                               {"N10 X1\nM98 P2000 L3\nM30\nO2000\nX2\nM99\n", {}},
                               {"N10 X1\nM98 P32000\nM30\nO2000\nX2\nM99\n", {}},
                               {"N10 X1\no<part> call\n", {}},
                               {"N10 X1\nM6 T5\nG43 H5\nX2\n", {}}};

// M99 P100 in a program that stands in another file goes on at N100 of the one that called.
TEST(Calls, OfProgramsThatAreNotReadMayComeBackToAnyLabel) {
  for (const CallCase& test : kCallsRows) {
    SCOPED_TRACE(test.text);
    Diagnostics found;
    const Program program = parse(SourceText("test.nc", test.text), found);
    Lines labels;
    const ProgramFlow flow = follow_flow(program, Returns::kToAnyLabel);
    for (std::size_t i = 0; i < flow.blocks.size(); ++i) {
      EXPECT_EQ(flow.blocks[i].label_referenced, flow.blocks[i].jump_target);
      if (flow.blocks[i].label_referenced) labels.push_back(i + 1);
    }
    EXPECT_EQ(labels, test.labels);
    for (const BlockFlow& each : follow_flow(program, Returns::kBehindCalls).blocks)
      EXPECT_FALSE(each.label_referenced);
  }
}

TEST(ProgramFlow, CallsThatComeBackBehindThemselvesNameNoLabel) {
  const std::string text = "G21 F9\nG0 X1\nN10 G1 X2\nM98 P2000\n";
  EXPECT_TRUE(Interpreted(text).line(3).label_referenced);
  EXPECT_FALSE(Interpreted(text, ReadOptions{.calls_keep_modes = true}).line(3).label_referenced);
}

struct DefinitionCase {
  const char* text;
  Lines lines;  // of definitions
};

const DefinitionCase kDefinitionRows[] = {
    {"o<part> sub\nX1\no<part> endsub\nX2\n", {1, 2, 3}},
    {"X1\n N5 O 100 Sub (a)\nX1\no100 return\nX2\no100 endsub [5]\nX2\n", {2, 3, 4, 5, 6}},
    {"o1 sub\no2 if [1]\nM2\no2 endif\no<subs> call\no1 endsub\n", {1, 2, 3, 4, 5, 6}},
    {"o1 sub\nX1\no1 endsub\no2 sub\no2 endsub\n", {1, 2, 3, 4, 5}},
    // Where it ends is not certain, or whether it is one.
    {"o1 sub\nX1\no2 endsub\nX2\no1 endsub\n", {}},
    {"o1 sub\nX1\no[1] endsub\nX2\no1 endsub\n", {}},
    {"o1 sub\nX1\no01 endsub\nX2\no1 endsub\n", {}},
    {"o1 sub\no2 sub\nX1\no2 endsub\nX2\no1 endsub\n", {}},
    {"o1 sub\no1 if [1]\nX1\no1 endif\no1 endsub\n", {}},
    {"o1 sub\nX1\nG1 o1 endsub\nX2\no1 endsub\n", {}},
    {"%\no1 sub\nX1\n%\no1 endsub\n", {}},
    {"o1 sub\nX1\n/o1 endsub\nX2\no1 endsub\n", {}},
    {"/o1 sub\nX1\no1 endsub\n", {}},
    {"o#1 sub\nX1\no#1 endsub\n", {}},
    {"o9 while [1]\no1 sub\nX1\no1 endsub\no9 endwhile\n", {}},
    {"o1 sub\nN10 X1\no1 endsub\nGOTO 10\n", {}},
    {"o1 sub\nX1\n", {}}};

TEST(ProgramFlow, DefinitionsArePassedOverWhereTheyStand) {
  for (const DefinitionCase& row : kDefinitionRows) {
    SCOPED_TRACE(row.text);
    Diagnostics found;
    const Program program = parse(SourceText("test.ngc", row.text), found);
    const std::vector<BlockFlow> flow = follow_flow(program, Returns::kBehindCalls).blocks;
    Lines lines;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      if (flow[i].in_definition != InDefinition::kNo) lines.push_back(i + 1);
    }
    EXPECT_EQ(lines, row.lines);
  }
}

// As LinuxCNC passes over them: modes, position, feed and kind of motion are as before.
TEST(ProgramFlow, WhatADefinitionSaysChangesNothingBehindIt) {
  const std::string head = "G21 G17 G90 G94 G40 G64\nG0 X1 Y1 Z1\nG1 X2 F100\n";
  const std::string body = "o100 sub\nG20 G91 G18 G0 X5 F7 S9\nM2\no100 endsub\n";
  const Interpreted it(head + body + "X3\n");
  const Motion* cut = it.motion_of_line(8);
  ASSERT_NE(cut, nullptr);
  EXPECT_EQ(cut->kind, MotionKind::kLine);
  EXPECT_TRUE(cut->start_known);
  EXPECT_EQ(cut->piece.start().x(), 2);
  EXPECT_EQ(it.last_state(), Interpreted(head).last_state());
  EXPECT_TRUE(it.found.empty()) << "no word of modes that are not known";
  EXPECT_FALSE(it.read.blocks[4].barrier.empty()) << "what it defines is kept";
  EXPECT_FALSE(is_known(Interpreted(head + body + "o100 call\nX3\n").last_state()));
  EXPECT_FALSE(is_known(Interpreted(head + "M2\n" + body + "X3\n").last_state()));
}

TEST(ProgramFlow, JumpTargetsAreEnteredWithNothingKnown) {
  const Interpreted it("G21 G90 F9\nG0 X1 Y1 Z1\nG1 X2\nN10 G1 X3\nG1 X4\nIF [#1 LT 3] GOTO 10\n");
  EXPECT_TRUE(it.line(4).entered_from_elsewhere);
  EXPECT_TRUE(it.line(4).label_referenced);
  EXPECT_EQ(it.state_after_line(4).units, Units::kUnknown);
  EXPECT_FALSE(it.line(3).entered_from_elsewhere);
}

TEST(ProgramFlow, BarriersNameTheLabelAndTheBody) {
  const Interpreted it("G21 F9\nG0 X1\nG73 P10 Q20\nN10 G1 X3\nX4\nN20 X5\nX6\n");
  EXPECT_EQ(it.line(5).barrier, reason::kLoopBody);
  EXPECT_EQ(it.line(7).barrier, std::string_view());
  const Interpreted jump("G21 F9\nG0 X1\nN10 F9\nGOTO 10\n");
  EXPECT_EQ(jump.line(3).barrier, reason::kReferencedLabel);
}

// Who calls it says under which modes it runs; M98 P1 H5 begins at N5.
TEST(ProgramFlow, ProgramsThatOthersCallAreEnteredWithTheModesOfTheirCaller) {
  const std::string text = "O1\nG21 G90 F9\nG0 X1\nG1 X2\nX3\nN5 X4\nG1 X5\nM99\n";
  const Interpreted unknown(text);
  EXPECT_EQ(unknown.line(5).barrier, reason::kCallerModes);
  const Interpreted usual(text, ReadOptions{.usual_caller_modes = true});
  EXPECT_EQ(usual.line(5).barrier, std::string_view());
  EXPECT_TRUE(usual.line(6).entered_from_elsewhere);
  EXPECT_FALSE(is_known(usual.state_after_line(7)));
  const Interpreted whole(text, ReadOptions{.calls_keep_modes = true, .usual_caller_modes = true});
  EXPECT_FALSE(whole.line(6).entered_from_elsewhere);
  EXPECT_TRUE(is_known(whole.state_after_line(7)));
}

// A subprogram behind a main program is called under modes that stand in the text, if anywhere.
TEST(ProgramFlow, ProgramsBehindTheirCallerStayBodies) {
  const Interpreted it("O1\nG21 F9\nM98 P2\nM30\nO2\nG21\nG1 X1\nM99\n",
                       ReadOptions{.usual_caller_modes = true});
  EXPECT_FALSE(it.line(7).barrier.empty());
  EXPECT_NE(it.line(7).barrier, reason::kCallerModes);
}

TEST(ProgramFlow, LinesWithACheckSumAreCounted) {
  // The exclusive or of the bytes of "N5 G1 X1".
  const int sum = 0x4e ^ 0x35 ^ 0x20 ^ 0x47 ^ 0x31 ^ 0x20 ^ 0x58 ^ 0x31;
  const Interpreted it("G21 F9\nG0 X0\nN5 G1 X1*" + std::to_string(sum) + "\n");
  EXPECT_EQ(it.line(3).barrier, reason::kChecksum);
}

}  // namespace
}  // namespace batten::gcode
