// What a program says of how exact its parts have to be, block by block.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gcode/interpreter/called_programs.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/part_reading.h"
#include "tests/support/interpreted.h"
#include "tests/support/klartext_programs.h"

namespace batten::gcode {
namespace {

using tests::Interpreted;
using tests::KlartextProgram;

std::optional<double> stated_after(const Interpreted& it, std::size_t line) {
  return stated_tolerance_mm(it.state_after_line(line));
}

struct SiemensText {
  explicit SiemensText(std::string text, const ReadOptions& options = {})
      : program(parse(SourceText("part.mpf", std::move(text)),
                      Reading{.language = Language::kSiemens}, found)),
        read(interpret(program, options, found)) {}
  [[nodiscard]] std::optional<double> after(std::size_t line) const {
    return stated_tolerance_mm(read.states.at(read.blocks.at(line - 1).state_after));
  }
  Diagnostics found;
  Program program;
  Interpretation read;
};

TEST(StatedTolerance, HoldsFromItsBlockOnUntilTheNextOne) {
  const Interpreted it("G21\nG0 X0\n(TOLERANCE 0.02)\nG1 X1 F9\nM6 T2\nX2 (TOL: 0.005)\nX3\n");
  EXPECT_EQ(stated_after(it, 2), std::nullopt);
  EXPECT_EQ(stated_after(it, 3), 0.02);
  EXPECT_EQ(stated_after(it, 5), 0.02);
  EXPECT_EQ(stated_after(it, 6), 0.005);
  EXPECT_EQ(stated_after(it, 7), 0.005);
  ASSERT_EQ(it.read.stated.size(), 2U);
  EXPECT_EQ(it.read.stated[0].block, 2U);
  EXPECT_EQ(it.read.stated[1].block, 5U);
}

TEST(StatedTolerance, IsInTheUnitsOfTheProgramWhereItNamesNone) {
  EXPECT_DOUBLE_EQ(*stated_after(Interpreted("G20\n(TOLERANCE 0.001)\n"), 2), 0.0254);
  EXPECT_DOUBLE_EQ(*stated_after(Interpreted("G20\n(TOLERANCE 0.001 MM)\n"), 2), 0.001);
  EXPECT_DOUBLE_EQ(*stated_after(Interpreted("G21\n(TOLERANCE 0.001 IN)\n"), 2), 0.0254);
  // Before the first word of units: in those that follow, and those stay.
  const Interpreted header("(TOLERANCE 0.001)\nG20\nG0 X0\nG21\nG0 X1\n");
  EXPECT_DOUBLE_EQ(*stated_after(header, 3), 0.0254);
  EXPECT_DOUBLE_EQ(*stated_after(header, 5), 0.0254);
}

TEST(StatedTolerance, IsStillThereWhereNothingElseIsKnown) {
  const Interpreted it("G21\n(TOLERANCE 0.005)\nG777\nG1 X1 F9\n");
  EXPECT_EQ(it.state_after_line(3).units, Units::kUnknown);
  EXPECT_EQ(stated_after(it, 3), 0.005);
}

TEST(StatedTolerance, CanBeLeftUnread) {
  const Interpreted it("G21\n(TOLERANCE 0.005)\n(TOLERANCE SEE DRAWING)\n",
                       ReadOptions{.stated_tolerances = false});
  EXPECT_EQ(stated_after(it, 3), std::nullopt);
  EXPECT_TRUE(it.read.stated.empty());
  EXPECT_TRUE(it.found.empty());
}

TEST(StatedTolerance, IsNotedWhereItIsUncertainAndTheOneBeforeHolds) {
  const Interpreted it("G21\n(TOLERANCE 0.02)\n(TOLERANCE +/-0.1 ON DRAWING)\nG0 X1\n");
  EXPECT_EQ(stated_after(it, 4), 0.02);
  ASSERT_EQ(it.found.size(), 1U);
  EXPECT_EQ(it.found[0].id, "tolerance-uncertain");
  EXPECT_EQ(it.found[0].severity, Severity::kNote);
  EXPECT_EQ(it.program.source.place_of(it.found[0].where.begin).line, 3U);
  EXPECT_NE(it.found[0].message.find("(TOLERANCE +/-0.1 ON DRAWING)"), std::string::npos);
}

TEST(StatedTolerance, OfMessagesToTheOperatorIsNone) {
  const Interpreted it("G21\n(MSG, TOLERANCE 0.005)\nG0 X1\n");
  EXPECT_EQ(stated_after(it, 3), std::nullopt);
}

TEST(StatedTolerance, OfCycle832IsInMillimetresAndEndsWithIt) {
  const SiemensText it(
      "G71\nCYCLE832(0.005,_FINISH,1)\nG1 X1 F9\nCYCLE832()\nG1 X2\n"
      "; TOLERANCE "
      "0.02\nCYCLE832(0.01,_ROUGH,1)\nCYCLE832(0.05,_ROUGH,1)\nCYCLE832(_tol,_ROUGH)\n");
  EXPECT_EQ(it.after(3), 0.005);
  EXPECT_EQ(it.after(4), std::nullopt);
  EXPECT_EQ(it.after(7), 0.01);  // the lesser of both
  EXPECT_EQ(it.after(8), 0.02);
  EXPECT_EQ(it.after(9), 0.02);
  EXPECT_EQ(std::ranges::count(it.found, "tolerance-uncertain", &Diagnostic::id), 1);
  EXPECT_EQ(SiemensText("G70\nCYCLE832(0.005,_FINISH,1)\n").after(2), 0.005);
}

TEST(StatedTolerance, OfABlockThatMayBeLeftOutIsTheLesserOne) {
  const SiemensText it(
      "G71\n/CYCLE832(0.05,_ROUGH,1)\n/CYCLE832(0.01,_ROUGH,1)\n/CYCLE832(0.02)\n/CYCLE832()\n");
  EXPECT_EQ(it.after(2), 0.05);
  EXPECT_EQ(it.after(3), 0.01);
  EXPECT_EQ(it.after(4), 0.01);
  EXPECT_EQ(it.after(5), 0.01);
}

// What a called program tells the control is so behind it, what its comments say is not.
TEST(StatedTolerance, OfACalledProgramIsThatOfTheControl) {
  Diagnostics found;
  std::string why;
  auto sub = as_subprogram("L54",
                           parse(SourceText("L54", "; TOLERANCE 0.002\nCYCLE832(0.008)\nM17\n"),
                                 Language::kSiemens, found),
                           why);
  ASSERT_TRUE(sub) << why;
  std::vector<Subprogram> programs;
  programs.push_back(std::move(*sub));
  ReadOptions options;
  options.subprograms = std::make_shared<const Subprograms>(std::move(programs));
  const SiemensText it("G71\n; TOLERANCE 0.02\nG1 X1 F9\nL54\nG1 X2\nG1 X3\n", options);
  EXPECT_EQ(it.after(3), 0.02);
  EXPECT_EQ(it.after(4), 0.008);
  EXPECT_EQ(least_stated_mm(it.read, 4, 5), 0.008);  // as the list of changes has it, too
  ASSERT_EQ(it.read.stated.size(), 2U);
  EXPECT_EQ(it.read.stated[1].block, 3U);
}

// The jump may have come from before the cycle that loosened it.
TEST(StatedTolerance, BehindALabelIsTheLeastThatTheControlWasTold) {
  const SiemensText it(
      "G71\nCYCLE832(0.01,_FINISH,1)\nIF R1==1 GOTOF END1\nCYCLE832(0.05,_ROUGH,1)\nG1 X1 F9\n"
      "END1:\nG1 X2\n");
  EXPECT_EQ(it.after(5), 0.05);
  EXPECT_EQ(it.after(7), 0.01);
  EXPECT_EQ(it.read.stated.size(), 3U);
}

TEST(StatedTolerance, OfCycle32EndsWithoutAT) {
  const KlartextProgram p(
      "0 BEGIN PGM A MM\n1 CYCL DEF 32.0 TOLERANZ\n2 CYCL DEF 32.1 T0,005\n"
      "3 CYCL DEF 32.2 HSC-MODE:0 TA0.5\n4 L X+1 F9\n5 CYCL DEF 32.0 TOLERANCE\n"
      "6 CYCL DEF 32.1\n7 L X+2\n8 ; TOLERANCE 0.02\n9 L X+3\n");
  EXPECT_EQ(stated_tolerance_mm(p.state_after(5)), 0.005);
  EXPECT_EQ(stated_tolerance_mm(p.state_after(8)), std::nullopt);
  EXPECT_EQ(stated_tolerance_mm(p.state_after(10)), 0.02);
}

// Of a part that was read behind others, and of two that are put together, as of the whole.
TEST(StatedTolerance, IsTheSameForPartsAndForTheWhole) {
  const std::string text =
      "(TOLERANCE 0.001)\nG20\nG0 X0\nG1 X1 F9\n(TOL 0.0005)\nX2\nX3 (TOL 0.0007)\nX4\n";
  const Interpreted whole(text);
  const SourceText source("test.nc", text);
  Diagnostics found;
  TextCarry texts;
  ControlCarry control(Units::kUnknown);
  ReadPart all{{source, {}, {}, {}}, {}};
  for (;;) {
    Program part = parse_part(source, {.blocks = 2}, texts, found);
    if (part.blocks.empty()) break;
    Interpretation read = interpret_part(part, {}, control, found);
    append(all, {std::move(part), std::move(read)});
  }
  const auto stated_blocks = [](const Interpretation& read) {
    std::vector<std::pair<std::uint32_t, double>> blocks;
    for (const StatedAt& at : read.stated) {
      blocks.emplace_back(at.block, least_mm(at.stated, Units::kInch).value_or(-1));
    }
    return blocks;
  };
  EXPECT_EQ(stated_blocks(all.meaning), stated_blocks(whole.read));
  ASSERT_EQ(whole.read.stated.size(), 4U);  // the units of the first are known from line 2 on
  for (std::uint32_t first = 1; first < 8; ++first) {
    ReadPart front{whole.program, whole.read};
    const ReadPart rest = take_rest(front, first);
    for (std::uint32_t block = 0; block < 8; ++block) {
      if (whole.read.blocks[block].motion < 0) continue;
      const bool in_front = block < first;
      const Interpretation& read = in_front ? front.meaning : rest.meaning;
      const std::uint32_t at = in_front ? block : block - first;
      EXPECT_EQ(least_stated_mm(read, at, at), least_stated_mm(whole.read, block, block))
          << first << " " << block;
    }
    EXPECT_EQ(front.meaning.stated.size() + rest.meaning.stated.size(), 4U);
  }
}

}  // namespace
}  // namespace batten::gcode
