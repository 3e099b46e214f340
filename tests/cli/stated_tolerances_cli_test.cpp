// What the commands say of parts for which the program names a tolerance, and --one-tolerance.
#include <gtest/gtest.h>

#include <string>

#include "batten_process.h"

namespace batten {
namespace {

const std::string kParts = "smooth part.nc -t linuxcnc --machine linuxcnc-fast --method fair ";

// Two waves; before the second one it says a tolerance.
std::string program_with(const std::string& comment) {
  const std::string wave = wave_program();
  const std::string again = wave.substr(wave.find("G0"));
  return wave.substr(0, wave.find("M2")) + comment + again;
}

TEST(StatedTolerances, AreToldInSummaryAndReport) {
  const BattenFolder folder;
  folder.put("part.nc", program_with("(TOLERANCE 0.002)\n"));
  expect_exit(folder.batten(kParts + "--json part.json"), 0,
              {"tolerance     0.01 mm; 0.002 mm in 1 part (line ", "), as the program says"});
  const std::string json = folder.text_of("part.json");
  EXPECT_TRUE(contains(json, "\"stated_tolerances\": [\n")) << json;
  EXPECT_TRUE(contains(json, "\"tolerance_mm\": 0.002,\n")) << json;
  expect_exit(folder.batten("verify part.nc part.smooth.nc --json v.json"), 0,
              {"proved", "2 changed sections, 1 of them within 0.002 mm as the old program says"});
  EXPECT_TRUE(contains(folder.text_of("v.json"), "\"tolerance_mm\": 0.002,\n"));
}

TEST(StatedTolerances, ThatAreNoLessAreTold) {
  const BattenFolder folder;
  folder.put("part.nc", program_with("(TOLERANCE 0.05)\n"));
  expect_exit(folder.batten(kParts), 0,
              {"tolerance     0.01 mm; what the program says in 1 part (line "});
}

TEST(StatedTolerances, ThatAreUncertainAreNoted) {
  const BattenFolder folder;
  folder.put("part.nc", program_with("(TOLERANCE SEE DRAWING)\n"));
  const ProcessResult result = expect_exit(
      folder.batten(kParts), 0,
      {"note: tolerance-uncertain: '(TOLERANCE SEE DRAWING)' names a tolerance, but no length"});
  EXPECT_FALSE(contains(result.err, "tolerance     0.01 mm;"));
}

TEST(StatedTolerances, AreNotReadWithOneTolerance) {
  const BattenFolder folder;
  folder.put("part.nc", program_with("(TOLERANCE 0.0005)\n(TOLERANCE SEE DRAWING)\n"));
  const ProcessResult result = expect_exit(
      folder.batten(kParts + "--one-tolerance --certificate part.cert --json p.json"), 0);
  EXPECT_FALSE(contains(result.err, "tolerance     "));
  EXPECT_FALSE(contains(result.err, "tolerance-uncertain"));
  EXPECT_TRUE(contains(folder.text_of("p.json"), "\"one_tolerance\": true"));
  expect_exit(folder.batten("verify part.nc part.smooth.nc"), 3, {"allowed 0.0005 mm"});
  expect_exit(folder.batten("verify part.nc part.smooth.nc --one-tolerance"), 0, {"proved"});
}

TEST(StatedTolerances, HoldInABatchAndOneToleranceInAConfiguration) {
  const BattenFolder folder;
  folder.put("in/part.nc", program_with("(TOLERANCE 0.0005)\n"));
  folder.put("part.nc", program_with("(TOLERANCE 0.0005)\n"));  // beside no configuration
  folder.put("in/batten.toml", "target = \"linuxcnc\"\none-tolerance = true\n");
  expect_exit(folder.batten("batch in out --jobs 1"), 0);
  expect_exit(folder.batten("verify part.nc out/part.nc"), 3, {"allowed 0.0005 mm"});
  expect_exit(folder.batten("verify in/part.nc out/part.nc"), 0, {"proved"});
  folder.put("in/batten.toml", "target = \"linuxcnc\"\n");
  expect_exit(folder.batten("batch in out --jobs 1 --force"), 0);
  expect_exit(folder.batten("verify part.nc out/part.nc"), 0, {"proved"});
}

}  // namespace
}  // namespace batten
