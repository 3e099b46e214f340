// Whole programs as posts for Siemens controls write them, on the whole way: what comes out of them
// byte for byte, read as such, smoothed, proved on the written text.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

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

SmoothOptions options_of(const SiemensCase& test) {
  SmoothOptions options = options_for("siemens");
  options.output = test.output;
  options.prefer = test.prefer;
  if (!test.allowed.empty()) options.allowed = {test.allowed};
  return options;
}

TEST(SiemensCases, ComeOutByteForByte) {
  const SiemensCase cases[] = {{"surface", 3},
                               {"plate", 2},
                               {"compressor", 1, Form::kLines, Prefer::kTime, "control-smoothing"}};
  for (const SiemensCase& test : cases) {
    SCOPED_TRACE(test.name);
    const std::string before = case_file(test.name + ".mpf");
    const SmoothResult result = smoothed(before, options_of(test));
    EXPECT_TRUE(result.understood);
    EXPECT_TRUE(result.proved);
    EXPECT_TRUE(result.diagnostics.empty());
    EXPECT_EQ(rewritten_runs(result), test.runs);
    EXPECT_LE(result.deviation_mm, 0.01);
    EXPECT_EQ(result.text, case_file(test.name + ".smoothed.mpf"));
    expect_rest_copied(before, result);
    EXPECT_EQ(smoothed(result.text, options_of(test)).text, result.text);
  }
}

TEST(SiemensCasesUnallowed, CompressedPointsStayAsTheyAre) {
  const std::string before = case_file("compressor.mpf");
  const SmoothResult result = smoothed(before, options_for("siemens"));
  EXPECT_EQ(result.text, before);
  EXPECT_EQ(reason_at(inspected(before, options_for("siemens")), 100), "control-smoothing");
}

// Three hundred lines around a wavy circle, as CAM systems write them for these controls.
std::string wavy_contour() {
  std::string text;
  for (int i = 1; i <= 300; ++i) {
    const double angle = 2 * std::numbers::pi * i / 300;
    const double radius = 20 + 1.5 * std::sin(5 * angle);
    text += fmt::format("N{} G1 X{:.3f} Y{:.3f}{}\n", 70 + 10 * i, radius * std::cos(angle) - 20,
                        radius * std::sin(angle), i == 1 ? " F2000" : "");
  }
  return text;
}

std::string program_with(const std::string& before_contour) {
  return "%_N_WAVY_MPF\n;$PATH=/_N_MPF_DIR\nN10 G17 G90 G71 G54\nN20 T=\"MILL6\" D1\nN30 M6\n"
         "N40 S8000 M3\nN50 CYCLE832(0.02,1,1)\nN60 G0 X=0 Y=0 Z=5\n" +
         before_contour + "N70 G1 Z-1 F600\n" + wavy_contour() +
         "N9000 G0 Z50\nN9010 CYCLE832()\nN9020 M30\n";
}

TEST(SiemensPrograms, AreSmoothedProvedAndTheirOwnWordsCopied) {
  const std::string before = program_with("");
  for (const Form form : {Form::kAuto, Form::kCurves, Form::kArcs, Form::kLines}) {
    SCOPED_TRACE(name_of(form));
    SmoothOptions wanted = options_for("siemens");
    wanted.output = form;
    const SmoothResult result = smoothed(before, wanted);
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(rewritten_runs(result), 1U);
    // Lines may be as many, and nearer.
    const std::size_t most = form == Form::kLines ? result.blocks_in : result.blocks_in * 9 / 10;
    EXPECT_LE(result.blocks_out, most);
    EXPECT_TRUE(result.text.starts_with(before.substr(0, before.find("N80 "))));
    EXPECT_TRUE(result.text.ends_with("N9000 G0 Z50\nN9010 CYCLE832()\nN9020 M30\n"));
    EXPECT_EQ(smoothed(result.text, wanted).text, result.text);
  }
  const SmoothResult other = smoothed(before, options_for("linuxcnc"));
  EXPECT_FALSE(other.understood);
  ASSERT_FALSE(other.diagnostics.empty());
  EXPECT_EQ(other.diagnostics.front().id, "foreign-language");
}

// What the words in front say of the path is not what the blocks say.
TEST(SiemensProgramsUnder, FramesTransformationsAndCompressorsStayAsTheyAre) {
  for (const char* words : {"N65 TRANS X10\nN66 SCALE X2\n", "N65 ROT Z30\n", "N65 TRAORI\n",
                            "N65 COMPCAD\n", "N65 G41\n", "N65 MYCYCLE(1,2)\n"}) {
    SCOPED_TRACE(words);
    const std::string before = program_with(words);
    const SmoothResult result = smoothed(before, options_for("siemens"));
    EXPECT_EQ(result.text, before);
    EXPECT_EQ(rewritten_runs(result), 0U);
  }
}

}  // namespace
}  // namespace batten::postproc
