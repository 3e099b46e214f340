#include "postproc/report/compact_numbers.h"

#include <gtest/gtest.h>

#include <limits>

namespace batten::postproc {
namespace {

// The vectors of RFC 4648, section 10.
TEST(Base64, IsThatOfTheStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Base64, TakesBytesAbove127) { EXPECT_EQ(base64("\xff\xfe\xfd"), "//79"); }

// Zigzag 0, 1, 2, 126 are bytes 00, 01, 02, 7E; 64 is 128 and takes two: 80 01.
TEST(PackedNumbers, AreZigzagInGroupsOfSevenBits) {
  EXPECT_EQ(packed({0, -1, 1, 63, 64}), base64(std::string_view("\x00\x01\x02\x7e\x80\x01", 6)));
}

TEST(PackedNumbers, TakeTheGreatestAndTheLeast) {
  const auto most = std::numeric_limits<std::int64_t>::max();
  const auto least = std::numeric_limits<std::int64_t>::min();
  // 64 bits are nine groups of seven and one bit.
  EXPECT_EQ(packed({most}), base64("\xfe\xff\xff\xff\xff\xff\xff\xff\xff\x01"));
  EXPECT_EQ(packed({least}), base64("\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"));
}

TEST(PackedNumbers, AsStepsAreTheDifferences) {
  EXPECT_EQ(packed_steps({5, 7, 4}), packed({5, 2, -3}));
}

TEST(PackedNumbers, AsRunsAreValueAndCount) {
  EXPECT_EQ(packed_runs({4, 4, 4, 9}), packed({4, 3, 9, 1}));
  EXPECT_EQ(packed_runs({}), "");
}

TEST(PackedNumbers, AsRunsOfStepsSayALongCountInFourNumbers) {
  std::vector<std::int64_t> lines;
  for (std::int64_t line = 10; line < 1000; ++line) lines.push_back(line);
  EXPECT_EQ(packed_step_runs(lines), packed({10, 1, 1, 989}));
}

}  // namespace
}  // namespace batten::postproc
