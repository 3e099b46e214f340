// Long paths are compared part by part (docs/algorithms/path_distance.md): what is wrong anywhere
// in one of them is found, and what is right is proved.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "postproc/proof/verification.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr int kWaveLines = 6000;
constexpr int kFirstOfWave = 4;  // line of the first of them

// A wave whose vertices are moved aside by up to `off`, but for each `kept`-th; `wrong`: by so much
// more the vertex before the end of line `at`.
std::string moved_wave(double off, int kept, unsigned seed, int at = -1, double wrong = 0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> aside(-off, off);
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\n";
  for (int i = 1; i <= kWaveLines; ++i) {
    const double x = 0.1 * i;
    double y = std::sin(x) + (i % kept == 0 || i == kWaveLines ? 0 : aside(random));
    if (i == at) y += wrong;
    text += fmt::format("G1 X{:.4f} Y{:.4f} F2000\n", x, y);
  }
  return text + "G0 Z5\nM2\n";
}

TEST(LongPathProof, HoldsInParts) {
  for (const int kept : {7, 100, 1000}) {
    const Verification found = verdict(moved_wave(0, 1, 1), moved_wave(0.006, kept, 2), 0.01);
    EXPECT_TRUE(found.proved()) << kept;
    EXPECT_GT(found.deviation_mm, 0.005);
    EXPECT_LE(found.deviation_mm, 0.0062);
  }
}

// Where no place is passed by both, it is compared as a whole.
TEST(LongPathProof, HoldsAtOnce) {
  EXPECT_TRUE(verdict(moved_wave(0, 1, 1), moved_wave(0.006, 10 * kWaveLines, 2), 0.01).proved());
}

TEST(LongPathProof, FailsWhereOneVertexIsWrong) {
  const std::string old = moved_wave(0, 1, 1);
  std::mt19937 random(5);
  for (int i = 0; i < 12; ++i) {
    const int at = 2 + static_cast<int>(random() % (kWaveLines - 4));
    const int kept = i % 2 == 0 ? 7 : 300;
    const double wrong = i % 3 == 0 ? -0.03 : 0.03;
    SCOPED_TRACE(testing::Message() << "line " << at + kFirstOfWave - 1 << ", kept " << kept);
    const Verification found = verdict(old, moved_wave(0.004, kept, 7, at, wrong), 0.01);
    ASSERT_FALSE(found.proved());
    EXPECT_NEAR(found.violations.front().new_line, at + kFirstOfWave - 1, 1);
    EXPECT_NEAR(found.violations.front().old_line, at + kFirstOfWave - 1, 1);
  }
}

// The greatest deviation is told where it is, in the whole.
TEST(LongPathProof, TellsWhereTheWholeIsFarthest) {
  const int at = 4697;  // where the wave turns
  const Verification found =
      verdict(moved_wave(0, 1, 1), moved_wave(0.001, 50, 7, at, 0.008), 0.01);
  ASSERT_TRUE(found.proved());
  EXPECT_NEAR(found.deviation_line, at + kFirstOfWave - 1, 1);
  EXPECT_NEAR(found.deviation_mm, 0.008, 0.0015);
}

}  // namespace
}  // namespace batten::postproc
