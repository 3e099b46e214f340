// Whole programs as posts for Siemens controls write them, and what comes out of them byte for
// byte.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/constructs.h"
#include "tests/support/places.h"

namespace batten::postproc {
namespace {

std::string case_file(const std::string& name) {
  std::ifstream file(BATTEN_SOURCE_DIR "/tests/cases/siemens_programs/" + name, std::ios::binary);
  EXPECT_TRUE(file) << name;
  return {std::istreambuf_iterator<char>(file), {}};
}

struct SiemensCase {
  std::string name;
  std::size_t runs = 0;  // rewritten
  Form output = Form::kAuto;
  Prefer prefer = Prefer::kTime;
  std::string allowed = {};
};
void PrintTo(const SiemensCase& test, std::ostream* out) { *out << test.name; }

SmoothOptions options_of(const SiemensCase& test) {
  SmoothOptions options = options_for("siemens");
  options.output = test.output;
  options.prefer = test.prefer;
  if (!test.allowed.empty()) options.allowed = {test.allowed};
  return options;
}

class SiemensCases : public testing::TestWithParam<SiemensCase> {};

TEST_P(SiemensCases, ComeOutByteForByte) {
  const std::string before = case_file(GetParam().name + ".mpf");
  const SmoothResult result = smoothed(before, options_of(GetParam()));
  EXPECT_TRUE(result.understood);
  EXPECT_TRUE(result.proved);
  EXPECT_TRUE(result.diagnostics.empty());
  EXPECT_EQ(rewritten_runs(result), GetParam().runs);
  EXPECT_LE(result.deviation_mm, 0.01);
  EXPECT_EQ(result.text, case_file(GetParam().name + ".smoothed.mpf"));
  expect_rest_copied(before, result);
  EXPECT_EQ(smoothed(result.text, options_of(GetParam())).text, result.text);
}

INSTANTIATE_TEST_SUITE_P(Programs, SiemensCases,
                         testing::Values(SiemensCase{"surface", 3}, SiemensCase{"plate", 2},
                                         SiemensCase{"compressor", 1, Form::kLines, Prefer::kSize,
                                                     "control-smoothing"}),
                         [](const auto& test) { return test.param.name; });

TEST(SiemensCasesUnallowed, CompressedPointsStayAsTheyAre) {
  const std::string before = case_file("compressor.mpf");
  const SmoothResult result = smoothed(before, options_for("siemens"));
  EXPECT_EQ(result.text, before);
  EXPECT_EQ(reason_at(inspected(before, options_for("siemens")), 100), "control-smoothing");
}

}  // namespace
}  // namespace batten::postproc
