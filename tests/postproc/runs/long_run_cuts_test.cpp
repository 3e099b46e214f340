// Where long runs are cut is found while a program is read, and is the same for the whole and for
// its parts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <variant>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/part_reading.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/runs/run_grouping.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr LongRunLimits kSmall = {.whole_at_most = 300, .shortest = 40, .longest = 80};

// Lines that turn this way and that, now and then sharply, back, or not at all; between them what
// the seed allows.
class RandomLines {
 public:
  RandomLines(unsigned seed, bool with_others) : random_(seed), with_others_(with_others) {}

  std::string make(int lines) {
    text_ = "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\n";
    for (int i = 0; i < lines; ++i) {
      turn();
      x_ += 0.2 * std::cos(heading_);
      y_ += 0.2 * std::sin(heading_);
      if (with_others_) other(i, lines);
      text_ += fmt::format("{}X{:.4f} Y{:.4f}\n", i == 0 ? "G1 F2000 " : "", x_, y_);
    }
    return text_ + "G0 Z5\nM2\n";
  }

 private:
  bool chance(unsigned one_in) { return random_() % one_in == 0; }

  void turn() {
    straight_ = straight_ > 0 ? straight_ - 1 : 0;
    if (straight_ > 0) return;
    heading_ += 0.2 * (static_cast<double>(random_() % 1000) / 500 - 1);
    if (chance(50)) heading_ += 2;
    if (chance(100)) heading_ += 3.1415926;
    if (chance(60)) straight_ = 5;
  }

  void other(int i, int lines) {
    if (chance(15)) text_ += "(here)\n";
    if (chance(900))
      text_ += fmt::format("G1 Z{:.2f}\nG1 F{}\n", -1 - 0.01 * (i % 7), 1900 + i % 5);
    if (chance(70)) text_ += fmt::format("X{:.3f} Z{:.4f}\n", x_ - 0.01, -1.5);
    if (i == lines / 3 && chance(2)) text_ += "G0 Z5\nG0 X0\nG1 Z-1\n";
    if (i == lines / 2 && chance(2)) text_ += "M8\n";
  }

  std::mt19937 random_;
  bool with_others_;
  std::string text_;
  double x_ = 0;
  double y_ = 0;
  double heading_ = 0;
  int straight_ = 0;
};

// The rule for a run that is known as a whole is the independent one.
TEST(LongRunCuts, AreThoseOfTheWholeRun) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    const ReadText read(RandomLines(seed, false).make(299 + static_cast<int>(seed * 17 % 400)));
    const std::vector<Section> sections = group_runs(read.program, read.meaning, {});
    std::vector<std::uint32_t> expected;
    for (const Section& section : sections) {
      const auto* run = std::get_if<postproc::Run>(&section.content);
      if (run == nullptr || run->points.size() <= kSmall.whole_at_most) continue;
      for (const std::size_t place :
           cut_places(*run, {.shortest = kSmall.shortest, .longest = kSmall.longest})) {
        expected.push_back(section.first_block + static_cast<std::uint32_t>(place));
      }
    }
    EXPECT_EQ(find_long_runs(read.program, read.meaning, kSmall, {}).cuts, expected);
    EXPECT_EQ(expected.empty(), seed == 0);  // 300 points may be held, 301 and more not
  }
}

std::vector<std::uint32_t> lines_found_in_parts(const std::string& text, std::size_t blocks) {
  const gcode::SourceText source("part.nc", text);
  gcode::TextCarry carry;
  gcode::ControlCarry control(gcode::Units::kUnknown);
  gcode::Diagnostics found;
  LongRunCuts cuts(kSmall, {});
  std::vector<std::uint32_t> lines;
  while (carry.begin < text.size()) {
    const gcode::Program part = gcode::parse_part(source, {.blocks = blocks}, carry, found);
    const gcode::Interpretation meaning = gcode::interpret_part(part, {}, control, found);
    cuts.begin_part(part, meaning);
    for (std::uint32_t i = 0; i < part.blocks.size(); ++i) cuts.take(i);
    for (const LongRunCut& cut : cuts.found()) {
      // A place is told while it is near.
      EXPECT_LE(carry.blocks, cut.line + 4 * kSmall.whole_at_most + blocks);
      lines.push_back(cut.line);
    }
  }
  cuts.end_run();
  for (const LongRunCut& cut : cuts.found()) lines.push_back(cut.line);
  return lines;
}

TEST(LongRunCuts, AreTheSameForAnyParts) {
  std::size_t all = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::string text = RandomLines(seed, true).make(1500);
    const ReadText read(text);
    std::vector<std::uint32_t> whole;
    for (const std::uint32_t block : find_long_runs(read.program, read.meaning, kSmall, {}).cuts) {
      whole.push_back(read.program.blocks[block].line);
    }
    all += whole.size();
    for (const std::size_t blocks : {std::size_t{1}, std::size_t{7}, std::size_t{400}}) {
      EXPECT_EQ(lines_found_in_parts(text, blocks), whole) << "seed " << seed;
    }
  }
  EXPECT_GE(all, 100U);
}

// A run that is not long, but not short, is cut at its sharp corners alone, into parts of half as
// many motions and more as it may have uncut.
TEST(LongRunCuts, OfRunsThatAreNotLongAreSharpCorners) {
  constexpr LongRunLimits kCorners = {
      .whole_at_most = 2000, .uncut_at_most = 300, .shortest = 100, .longest = 200};
  std::size_t all = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const ReadText read(RandomLines(seed, false).make(1500));
    const auto cuts = find_long_runs(read.program, read.meaning, kCorners, {}).cuts;
    const auto& motions = read.meaning.motions;
    std::uint32_t before = 3;  // the first block of the run
    for (const std::uint32_t block : cuts) {
      const auto motion = static_cast<std::size_t>(read.meaning.blocks[block].motion);
      const geometry::Vector3 in =
          motions[motion - 1].piece.end() - motions[motion - 1].piece.start();
      const geometry::Vector3 out = motions[motion].piece.end() - motions[motion].piece.start();
      EXPECT_LT(in.normalized().dot(out.normalized()), 0.5) << "60 degrees and more";
      EXPECT_GE(block - before, kCorners.uncut_at_most / 2);
      before = block;
    }
    EXPECT_GE(read.program.blocks.size() - 2 - before, kCorners.uncut_at_most / 2);
    all += cuts.size();
    const ReadText shorter(RandomLines(seed, false).make(299));
    EXPECT_TRUE(find_long_runs(shorter.program, shorter.meaning, kCorners, {}).cuts.empty());
  }
  EXPECT_GE(all, 40U);
}

// What stands on both sides of a cut is a run: no plunge, nothing that is copied.
TEST(LongRunCuts, HaveRunsOnBothSides) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const ReadText read(RandomLines(seed, true).make(1500));
    const auto cuts = find_long_runs(read.program, read.meaning, kSmall, {}).cuts;
    const auto sections = group_runs(read.program, read.meaning, {}, cuts);
    std::size_t found = 0;
    for (std::size_t i = 1; i < sections.size(); ++i) {
      if (!std::ranges::binary_search(cuts, sections[i].first_block)) continue;
      ++found;
      EXPECT_TRUE(std::holds_alternative<postproc::Run>(sections[i].content));
      EXPECT_TRUE(std::holds_alternative<postproc::Run>(sections[i - 1].content));
      EXPECT_EQ(sections[i - 1].last_block + 1, sections[i].first_block);
    }
    EXPECT_EQ(found, cuts.size());
  }
}

TEST(LongRunCuts, AreNotMadeWhereNothingFollowsInTheNextBlock) {
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\n";
  for (int i = 1; i <= 1000; ++i) text += fmt::format("G1 X{:.1f} Y{}\n(mark)\n", 0.1 * i, i % 2);
  const ReadText read(text + "G0 Z5\nM2\n");
  EXPECT_TRUE(find_long_runs(read.program, read.meaning, kSmall, {}).cuts.empty());
}

}  // namespace
}  // namespace batten::postproc
