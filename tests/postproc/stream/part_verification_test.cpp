// Long programs that are compared part by part: proved only where the whole is, and with what the
// whole says.
#include "postproc/stream/part_verification.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "postproc/proof/verification.h"
#include "tests/support/in_windows.h"
#include "tests/support/random_passes.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

VerifiedTexts verified(const std::string& before, const std::string& after, const Promise& promise,
                       const VerifyLimits& limits = {}) {
  const gcode::SourceText old_source("old.nc", before);
  const gcode::SourceText new_source("new.nc", after);
  return verify_texts({old_source, {}}, {new_source, {}}, promise, {}, limits).value();
}

bool is_proved(const VerifiedTexts& found) {
  return found.understood() && found.verification.proved();
}

// Nothing where the whole was asked.
std::optional<VerifiedTexts> in_parts(const std::string& before, const std::string& after,
                                      const Promise& promise, std::size_t blocks,
                                      std::size_t longest) {
  const VerifyLimits limits{.parts = {.blocks = blocks, .least_text = 0}, .longest = longest};
  VerifiedTexts found = verified(before, after, promise, limits);
  return found.as_whole ? std::nullopt : std::optional(std::move(found));
}

std::string words_of(const ComparedSection& section) {
  const geometry::PathComparison& found = section.comparison;
  return fmt::format("{}-{} {}-{} {} {:a} {:a} {} {:a} {} {}", section.old_first_line,
                     section.old_last_line, section.new_first_line, section.new_last_line,
                     static_cast<int>(found.verdict), found.bounds.at_least, found.bounds.at_most,
                     found.certificate_size, section.corner_mm, section.old_worst_line,
                     section.new_worst_line);
}

std::vector<std::string> words_of(const Verification& verification) {
  std::vector<std::string> words = {
      fmt::format("{} events, {:a} near {}, {:a}", verification.events_compared,
                  verification.deviation_mm, verification.deviation_line, verification.corner_mm)};
  for (const ComparedSection& section : verification.sections) words.push_back(words_of(section));
  return words;
}

constexpr std::size_t kNeverCut = 1'000'000;  // no run has as many blocks

// Whether it is proved in parts of some size. What is proved there the whole proves, with the same
// bounds for the same sections.
bool compare_both_ways(const std::string& before, const std::string& after,
                       const Promise& promise) {
  const VerifiedTexts whole = verified(before, after, promise);
  bool any = false;
  for (const std::size_t blocks : {1, 4, 30}) {
    SCOPED_TRACE(testing::Message() << "parts of " << blocks);
    const auto parts = in_parts(before, after, promise, blocks, kNeverCut);
    if (!parts) continue;
    any = true;
    EXPECT_TRUE(is_proved(whole)) << before << "\n----\n" << after;
    EXPECT_EQ(words_of(parts->verification), words_of(whole.verification));
    EXPECT_EQ(postproc::words_of(parts->of_old), postproc::words_of(whole.of_old));
    EXPECT_EQ(postproc::words_of(parts->of_new), postproc::words_of(whole.of_new));
  }
  return any;
}

constexpr unsigned kVerifiedSeeds = 24;

// One change of one place.
std::string damaged(std::vector<std::string> lines, std::mt19937& random) {
  const std::size_t at = random() % lines.size();
  const auto line = lines.begin() + static_cast<std::ptrdiff_t>(at);
  static constexpr const char* kWords[] = {"M8", "G18", "G0 Z7", "F777"};
  const auto kind = random() % 7;
  if (kind < std::size(kWords)) {
    lines.insert(line, kWords[kind]);
  } else if (kind == 4) {
    lines.erase(line);
  } else if (kind == 5) {
    if (at + 1 < lines.size()) std::swap(lines[at], lines[at + 1]);
  } else if (const std::size_t point = line->find('.'); point != std::string::npos) {
    char& digit = (*line)[point + 1];
    digit = digit == '9' ? '0' : static_cast<char>(digit + 1);
  }
  return joined(lines, "\n");
}

// One run, in the new program in another plane for a while.
TEST(PartVerification, CutsRunsWhereBothAreInOnePlane) {
  const auto run = [](int first, int last) {
    std::string text = "G21 G90 G17\nM3 S900\nG0 X0 Y0\nF900\n";
    for (int i = 1; i <= 60; ++i) {
      text += i == first ? "G18 " : i == last ? "G17 " : "";
      text += fmt::format("G1 X{} Y{}\n", i, i % 2);
    }
    return text + "M5\nM30\n";
  };
  EXPECT_TRUE(in_parts(run(0, 0), run(0, 0), {0.01}, 4, 16));
  EXPECT_TRUE(in_parts(run(0, 0), run(10, 20), {0.01}, 4, 16));
  EXPECT_TRUE(in_parts(run(0, 0), run(2, 58), {0.01}, 4, 16));
  EXPECT_FALSE(in_parts(run(0, 0), run(10, 70), {0.01}, 4, 16)) << "it ends in another plane";
}

TEST(PartVerification, SaysTheSameForAnyThreads) {
  std::mt19937 random(8);
  std::size_t refused = 0;
  for (unsigned seed = 0; seed < kVerifiedSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const std::string before = RandomPasses(seed).make();
    const SmoothOptions options = options_of_seed(seed);
    const std::string smoothed = as_a_whole(before, options).text;
    const std::string after = seed % 3 == 0 ? smoothed : damaged(lines_of(smoothed), random);
    const auto found_by = [&](int threads) {
      return verified(before, after, options.tolerance_mm,
                      {.threads = threads, .least_for_threads = 0});
    };
    const VerifiedTexts one = found_by(1);
    refused += is_proved(one) ? 0 : 1;
    for (const int threads : {2, 5}) {
      const VerifiedTexts more = found_by(threads);
      EXPECT_EQ(words_of(more.verification), words_of(one.verification));
      ASSERT_EQ(more.verification.violations.size(), one.verification.violations.size());
      for (std::size_t i = 0; i < one.verification.violations.size(); ++i) {
        EXPECT_EQ(more.verification.violations[i].message, one.verification.violations[i].message);
      }
      EXPECT_EQ(postproc::words_of(more.of_old), postproc::words_of(one.of_old));
      EXPECT_EQ(postproc::words_of(more.of_new), postproc::words_of(one.of_new));
    }
  }
  EXPECT_GE(refused, kVerifiedSeeds / 4);
}

// A lost line, a swapped pair, another word, place, state or feed: anywhere.
TEST(PartVerification, SaysWhatTheWholeSaysAndProvesNothingThatItRefuses) {
  std::mt19937 random(7);
  std::size_t proved = 0;
  std::size_t refused = 0;
  for (unsigned seed = 0; seed < kVerifiedSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const std::string before = RandomPasses(seed).make();
    const SmoothOptions options = options_of_seed(seed);
    const Promise promise(options.tolerance_mm, options.tolerance_kind, options.side);
    const SmoothResult smoothed = as_a_whole(before, options);
    if (!smoothed.understood) continue;
    proved += compare_both_ways(before, smoothed.text, promise) ? 1 : 0;
    const std::vector<std::string> lines = lines_of(smoothed.text);
    for (int i = 0; i < 5; ++i) {
      refused += compare_both_ways(before, damaged(lines, random), promise) ? 0 : 1;
      if (HasFailure()) return;
    }
  }
  EXPECT_GE(proved, kVerifiedSeeds / 3);
  EXPECT_GE(refused, std::size_t{kVerifiedSeeds} * 3);
}

std::string passes(int count, const std::string& at_pass_three = "") {
  std::string text = "G21 G90 G17\nM3 S900\n";
  for (int i = 0; i < count; ++i) {
    text += fmt::format("G0 X{} Y0 Z5\nG1 Z-1 F300\n", i);
    if (i == 3) text += at_pass_three;
    text += fmt::format("G1 Y5 F800\nX{}.5\nG0 Z5\n", i);
  }
  return text + "M5\nM30\n";
}

// The plane is not asked for by lines: it differs at the next event, or at the end.
TEST(PartVerification, ProvesPassesOfAnyNumberOfBlocksAndSeesAStateThatDiffersInOnePart) {
  for (const std::size_t blocks : {1, 2, 3, 5, 6, 7, 8, 11, 100}) {
    const auto parts = in_parts(passes(8), passes(8), {0.01}, blocks, kNeverCut);
    ASSERT_TRUE(parts) << blocks;
    EXPECT_TRUE(parts->verification.sections.empty());
    for (const char* words : {"G18\n", "M8\n", "G91 G1 X0\nG90\n", "G61\n", "S901\n", "/ M1\n"}) {
      EXPECT_FALSE(in_parts(passes(8), passes(8, words), {0.01}, blocks, kNeverCut)) << words;
    }
  }
}

// A section that has moves in one program only is told with the line of the rapid before it, which
// is in another part.
TEST(PartVerification, NamesALineWhereAProgramHasNoMoves) {
  const std::string head = "G21 G90 G17\nM3 S900\nG0 X1 Y0 Z0\nG0 X0\n";
  const std::string before = head + "G1 X0.004 F100\nX0\nG0 Z5\nM30\n";
  const std::string after = head + "G0 Z5\nM30\n";
  EXPECT_TRUE(compare_both_ways(before, after, {0.01}));
  const auto parts = in_parts(before, after, {0.01}, 1, kNeverCut);
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->verification.sections.size(), 1U);
  const ComparedSection& section = parts->verification.sections[0];
  EXPECT_TRUE(words_of(section).starts_with("5-6 4-4 ")) << words_of(section);
}

// What stands behind the mark that ends the program is copied, and is asked for line by line.
TEST(PartVerification, SeesWhatStandsBehindTheMarks) {
  const std::string program = "%\n" + passes(4) + "%\n";
  for (const std::size_t blocks : {1, 3, 100}) {
    const auto proved = [&](const char* before, const char* after) {
      return in_parts(program + before, program + after, {0.01}, blocks, kNeverCut).has_value();
    };
    EXPECT_TRUE(proved("(the end)\n\n", "(the end)\n\n"));
    EXPECT_FALSE(proved("(the end)\n", "(an end)\n"));
    EXPECT_FALSE(proved("(the end)\n\n", "(the end)\n"));
    EXPECT_FALSE(proved("(the end)\n", ""));
  }
}

TEST(PartVerification, StopsWhereItIsToldTo) {
  const std::string text = passes(8);
  const gcode::SourceText source("part.nc", text);
  int asked = 0;
  const VerifyLimits limits{.parts = {.blocks = 3, .least_text = 0}};
  const auto stopped = [&] { return ++asked > 2; };
  EXPECT_FALSE(verify_texts({source, {}}, {source, {}}, {0.01}, stopped, limits));
  EXPECT_EQ(asked, 4);  // for three parts and before the whole
}

// Rows to and fro, half a millimetre apart, `points` on each.
std::vector<std::pair<double, double>> rows(int count, int points, double apart = 0.5) {
  std::vector<std::pair<double, double>> places;
  for (int row = 0; row < count; ++row) {
    for (int i = 0; i < points; ++i) {
      const double x = 0.25 * (row % 2 == 0 ? i : points - 1 - i);
      places.emplace_back(x, apart * row + 0.05 * std::sin(x));
    }
  }
  return places;
}

std::string one_run(const std::vector<std::pair<double, double>>& places,
                    const std::string& end = "M30\n") {
  std::string text = fmt::format("G21 G90 G17\nM3 S900\nG0 X{:.4f} Y{:.4f} Z0\nG1 F900\n",
                                 places.front().first, places.front().second);
  for (std::size_t i = 1; i < places.size(); ++i) {
    text += fmt::format("X{:.4f} Y{:.4f}\n", places[i].first, places[i].second);
  }
  return text + end;
}

// As the whole, but for where the run is listed in pieces: the tolerance is then kept by each, and
// the greatest deviation is that of the whole within what bounds may be apart.
TEST(PartVerification, ProvesALongRunInPieces) {
  const std::string before = one_run(rows(40, 60));
  SmoothOptions options = options_for("linuxcnc");
  options.method = Method::kFair;
  const LongRunLimits long_runs{.whole_at_most = 500, .shortest = 150, .longest = 300};
  const SmoothResult smoothed = as_a_whole(before, options, long_runs);
  ASSERT_GT(rewritten_runs(smoothed), 5U);
  const Promise promise(options.tolerance_mm);
  const VerifiedTexts whole = verified(before, smoothed.text, promise);
  ASSERT_TRUE(is_proved(whole));
  for (const std::size_t blocks : {40, 100, 333}) {
    const auto parts = in_parts(before, smoothed.text, promise, blocks, 700);
    ASSERT_TRUE(parts) << blocks;
    const Verification& found = parts->verification;
    EXPECT_GT(found.sections.size(), 2U);
    EXPECT_EQ(found.events_compared, whole.verification.events_compared);
    EXPECT_LE(found.deviation_mm, promise.tolerance_mm);
    EXPECT_NEAR(found.deviation_mm, whole.verification.deviation_mm, 0.02 * promise.tolerance_mm);
    const std::vector<ComparedSection>& all = found.sections;
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      EXPECT_EQ(all[i].comparison.verdict, geometry::Verdict::kProved);
      EXPECT_LT(all[i].old_last_line, all[i + 1].old_first_line);
      EXPECT_LT(all[i].new_last_line, all[i + 1].new_first_line);
    }
  }
}

// One vertex of the new run is off: in the first, a middle and the last piece.
TEST(PartVerification, ProvesNoLongRunThatLeavesTheToleranceAnywhere) {
  const auto places = rows(20, 50);
  const std::string before = one_run(places);
  ASSERT_TRUE(in_parts(before, one_run(places, "(end)\nM30\n"), {0.01}, 50, 100));
  for (std::size_t at = 1; at < places.size(); at += 37) {
    auto moved = places;
    moved[at].second += 0.03;
    EXPECT_FALSE(in_parts(before, one_run(moved), {0.01}, 50, 100)) << at;
  }
}

// Two feeds that are one when they are compared, but that are two in one program only.
TEST(PartVerification, SeesAFeedThatBeginsWhereARunIsCut) {
  const auto places = rows(20, 50);
  const std::string before = one_run(places);
  std::vector<std::string> lines = lines_of(before);
  std::size_t refused = 0;
  for (std::size_t at = 10; at + 10 < lines.size(); ++at) {
    std::vector<std::string> other = lines;
    other[at] += " F900.0005";
    const std::string after = joined(other, "\n");
    EXPECT_FALSE(in_parts(before, after, {0.01}, 50, 100)) << at;
    if (at % 50 == 0) refused += is_proved(verified(before, after, {0.01})) ? 0 : 1;
  }
  EXPECT_GT(refused, 0U);
}

// Rows 0.012 mm apart may come to lie on each other within the tolerance of 0.01: the new run
// crosses itself, between pieces that are proved each for itself.
TEST(PartVerification, SeesPiecesThatCrossEachOther) {
  const auto places = rows(6, 300, 0.012);
  auto crossed = places;
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    const std::size_t row = i / 300;
    const std::size_t along = i % 300;
    if (along < 100 || along > 200) continue;
    if (row == 1) crossed[i].second += 0.008;
    if (row == 2) crossed[i].second -= 0.008;
  }
  const std::string before = one_run(places);
  const std::string after = one_run(crossed);
  const VerifiedTexts whole = verified(before, after, {0.01});
  ASSERT_EQ(whole.verification.violations.size(), 2U) << "over, and back";
  for (const Violation& each : whole.verification.violations) {
    EXPECT_EQ(each.id, "crosses-itself");
  }
  for (const std::size_t longest : {60, 150, 400}) {
    EXPECT_FALSE(in_parts(before, after, {0.01}, 50, longest)) << longest;
    EXPECT_TRUE(in_parts(before, one_run(places, "(end)\nM30\n"), {0.01}, 50, longest)) << longest;
  }
}

// Rows to and fro on one line are no matter of the new program: but it meets itself, and how the
// old one did is known to the whole only.
TEST(PartVerification, LeavesARunThatMeetsItselfToTheWhole) {
  const auto places = rows(20, 50, 0);
  const std::string before = one_run(places);
  const std::string after = one_run(places, "(end)\nM30\n");
  EXPECT_TRUE(is_proved(verified(before, after, {0.01})));
  EXPECT_FALSE(in_parts(before, after, {0.01}, 50, 100));
}

// At a corner on the cut neither piece would say on which side the new path goes round it.
TEST(PartVerification, CutsNoRunWhoseSideIsAskedFor) {
  const auto places = rows(20, 50);
  const Promise left(0.01, geometry::ToleranceKind::kPath, geometry::Side::kLeft);
  const auto parts = in_parts(one_run(places), one_run(places, "(end)\nM30\n"), left, 50, 100);
  ASSERT_TRUE(parts);
  EXPECT_TRUE(parts->verification.sections.empty());
}

}  // namespace
}  // namespace batten::postproc
