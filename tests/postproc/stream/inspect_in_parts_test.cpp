// What is inspected part by part is what the whole is: the same sections to the last bit of each
// figure, the same messages.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "postproc/stream/inspect.h"
#include "tests/support/in_windows.h"
#include "tests/support/random_passes.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

std::string words_of(const InspectedSection& section) {
  const SegmentStatistics& segments = section.segments;
  return fmt::format("{}-{} {} {} {} {} {} {:a} {:a} | {} {:a} {:a} {:a} {:a} {:a} {}",
                     section.first_line, section.last_line, section.blocks, section.cutting_moves,
                     section.reason, section.closed, section.decimals, section.least_feed,
                     section.greatest_feed, segments.count, segments.shortest, segments.median,
                     segments.longest, segments.length, segments.greatest_turn_deg,
                     segments.turn_line);
}

std::vector<std::string> words_of(const std::vector<InspectedSection>& sections) {
  std::vector<std::string> words;
  for (const InspectedSection& section : sections) words.push_back(words_of(section));
  return words;
}

InspectedProgram whole(const std::string& text) {
  return inspect(gcode::SourceText("part.nc", text), {}, {});
}

// Nothing where the parts are not enough.
std::optional<InspectedProgram> in_parts(const std::string& text, std::size_t blocks,
                                         std::size_t longest) {
  const InspectLimits limits{.parts = {.blocks = blocks, .least_text = 0}, .longest = longest};
  InspectedProgram found = inspect(gcode::SourceText("part.nc", text), {}, {}, limits);
  return found.as_whole ? std::nullopt : std::optional(std::move(found));
}

// Returns whether it can be inspected in parts.
bool compare_both_ways(const std::string& text) {
  const InspectedProgram expected = whole(text);
  for (const std::size_t blocks : {1, 3, 10, 64}) {
    for (const std::size_t longest : {1, 20, 1000}) {
      SCOPED_TRACE(testing::Message() << "parts of " << blocks << ", chains of " << longest);
      const auto parts = in_parts(text, blocks, longest);
      if (!parts) return false;
      EXPECT_EQ(words_of(parts->sections), words_of(expected.sections)) << text;
      EXPECT_EQ(postproc::words_of(parts->found), postproc::words_of(expected.found));
      EXPECT_EQ(parts->blocks, expected.blocks);
      EXPECT_EQ(parts->unit_word_seen, expected.unit_word_seen);
      if (testing::Test::HasFailure()) return true;
    }
  }
  return true;
}

constexpr unsigned kInspectedSeeds = 40;

TEST(InspectInParts, SaysOfPassesWhatTheWholeSays) {
  std::size_t in_parts = 0;
  for (unsigned seed = 0; seed < kInspectedSeeds; ++seed) {
    SCOPED_TRACE(seed);
    in_parts += compare_both_ways(RandomPasses(seed).make()) ? 1 : 0;
    if (HasFailure()) return;
  }
  EXPECT_GE(in_parts, kInspectedSeeds / 2);
}

// One chain that nothing ends for long, of all that may stand in it: lines of any direction, of no
// length, along Z, arcs, feeds, comments, blocks that say nothing.
class RandomChain {
 public:
  explicit RandomChain(unsigned seed) : random_(seed), with_arcs_(seed % 3 == 2) {}

  std::string make() {
    text_ = "G21 G90 G17\nM3 S900\nG0 X0 Y0 Z5\nG1 F500\n";
    const int moves = 40 + pick(300);
    for (int i = 0; i < moves; ++i) add_block();
    if (chance(2)) text_ += "X0 Y0 Z5\n";
    text_ += chance(2) ? "M5\nM30\n" : "";
    return text_;
  }

 private:
  int pick(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }
  bool chance(int one_in) { return pick(one_in) == 0; }

  void add_block() {
    if (chance(25)) text_ += fmt::format("F{}\n", 300 + pick(500));
    if (chance(25)) text_ += chance(2) ? "\n" : "(a mark)\n";
    if (chance(30)) text_ += fmt::format("X{:.3f} Y{:.3f}\n", x_, y_);  // where it is
    if (chance(20)) plunge();
    if (with_arcs_ && chance(30)) return add_arc();
    if (chance(150)) text_ += chance(2) ? "M8\n" : "G61\nG64\n";
    x_ += pick(1000) / 500.0 - 0.7;
    y_ += pick(1000) / 500.0 - 1;
    const std::string z = chance(6) ? fmt::format(" Z{:.2f}", pick(30) / 10.0) : "";
    const std::string feed = chance(40) ? fmt::format(" F{}", 400 + pick(90)) : "";
    text_ += fmt::format("G1 X{:.3f} Y{:.{}f}{}{}\n", x_, y_, 3 + pick(2), z, feed);
  }

  void plunge() {
    for (int i = pick(4); i >= 0; --i) text_ += fmt::format("G1 Z{:.2f}\n", pick(50) / 10.0);
  }

  void add_arc() {
    x_ += 1;
    text_ += fmt::format("G2 X{:.3f} Y{:.3f} I0.5 J0\n", x_, y_);
  }

  std::mt19937 random_;
  bool with_arcs_;
  std::string text_;
  double x_ = 0;
  double y_ = 0;
};

TEST(InspectInParts, SaysOfOneChainWhatTheWholeSays) {
  for (unsigned seed = 0; seed < 3 * kInspectedSeeds; ++seed) {
    SCOPED_TRACE(seed);
    EXPECT_TRUE(compare_both_ways(RandomChain(seed).make()));
    if (HasFailure()) return;
  }
}

TEST(InspectInParts, SaysOfEverySampleWhatTheWholeSays) {
  std::size_t in_parts = 0;
  for (const auto& [file, text] : sample_programs()) {
    SCOPED_TRACE(file);
    in_parts += compare_both_ways(text) ? 1 : 0;
    if (HasFailure()) return;
  }
  EXPECT_GE(in_parts, 8U);
}

// The longest turn, the shortest and the longest segment lie where the chain is cut or nowhere
// near.
TEST(InspectInParts, CountsARunAcrossItsCuts) {
  const std::string start = "G21 G90\nG0 X0 Y0 Z0\nG1 F100\n";
  for (int corner = 1; corner < 40; ++corner) {
    std::string text = start;
    for (int i = 1; i <= 40; ++i) {
      text += i <= corner ? fmt::format("X{}\n", i) : fmt::format("Y{}\n", i - corner);
    }
    const auto parts = in_parts(text + "M30\n", 5, 1);
    ASSERT_TRUE(parts);
    ASSERT_EQ(parts->sections.size(), 5U);  // modes, the rapid, the feed, the run, the end
    const InspectedSection& run = parts->sections[3];
    EXPECT_EQ(run.first_line, 4U);
    EXPECT_EQ(run.last_line, 43U);
    EXPECT_EQ(run.segments.count, 40U);
    EXPECT_DOUBLE_EQ(run.segments.length, 40);
    EXPECT_DOUBLE_EQ(run.segments.greatest_turn_deg, 90);
    EXPECT_EQ(run.segments.turn_line, 3U + static_cast<std::uint32_t>(corner));
  }
}

// Whether arcs are pieces of a curve is judged by the finest digits of their chain, which stand in
// its first lines here: three arcs of 6 degrees whose radius is a tenth less than that of the
// circle that they go along turn by 0.7 degrees where they meet, which two digits would not tell.
TEST(InspectInParts, JudgesArcsByAllOfTheirChain) {
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z0\nG1 F100\n";
  for (int i = 1; i <= 40; ++i) {
    text += fmt::format("G1 X{:.{}f} Y0\n", -10 + 0.5 * i, i < 10 ? 4 : 2);
  }
  for (int i = 1; i <= 3; ++i) {
    const double angle = 2 * 3.141592653589793 * 6 * i / 360;
    text += fmt::format("G3 X{:.2f} Y{:.2f} R9\n", 10 + 10 * std::sin(angle),
                        10 - 10 * std::cos(angle));
  }
  text += "M30\n";
  EXPECT_TRUE(compare_both_ways(text));
}

TEST(InspectInParts, ReadsNothingBehindTheMarkThatEndsTheProgram) {
  for (const char* behind : {"(MSG,look)\n", "(the end)\n\n", "\n\n", "%\n(MSG,look)\n"}) {
    for (const char* before : {"%\n", "", "(MSG,look)\n%\n"}) {
      const std::string text =
          std::string(before) + "G21 G90\nG0 X0 Y0 Z0\nG1 F100 X5\nM30\n%\n" + behind;
      EXPECT_TRUE(compare_both_ways(text)) << text;
    }
  }
}

TEST(InspectInParts, LeavesToTheWholeWhatNeedsIt) {
  const std::string lines = joined(wave_lines({.lines = 30}), "\n");
  for (const std::string_view end :
       {"M99\n", "GOTO 5\n", "o1 while [#1 lt 2]\n", "M30\n%\nG1 X5\n", "DEF REAL DEPTH\n"}) {
    const std::string head = end.find('%') != std::string_view::npos ? "%\n" : "";
    EXPECT_FALSE(in_parts(head + "G21 G90\nN5 G0 X0 Y0 Z0\n" + lines + std::string(end), 4, 1))
        << end;
  }
  EXPECT_FALSE(in_parts("G90\nG0 X0 Y0 Z0\n" + lines, 4, 1)) << "no units";
}

}  // namespace
}  // namespace batten::postproc
