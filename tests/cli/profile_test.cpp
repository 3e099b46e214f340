// Profiles and conversions as a user meets them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "batten_process.h"

namespace batten {
namespace {

constexpr const char* kProfile =
    "based-on = \"haas\"\nname = \"vf2\"\n[words]\nheader = [\"(vf2 {tolerance})\"]\n"
    "before-run = [\"G187 P3 E{tolerance}\"]\nafter-run = [\"G187\"]\n";

class Profiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_.put("part.nc", wave_program());
    folder_.put("vf2.toml", kProfile);
  }
  BattenFolder folder_;
};

TEST_F(Profiles, AreShownAndReadBackTheSame) {
  expect_exit(folder_.shell("batten targets --show haas > mine.toml"), 0);
  EXPECT_TRUE(folder_.text_of("mine.toml").starts_with("# A profile for batten"));
  const std::string smooth = "smooth part.nc --tolerance 0.01 -o ";
  ASSERT_EQ(folder_.batten(smooth + "a.nc --target haas").exit_code, 0);
  ASSERT_EQ(folder_.batten(smooth + "b.nc --target mine.toml").exit_code, 0);
  ASSERT_EQ(folder_.batten(smooth + "c.nc --profile mine.toml").exit_code, 0);
  ASSERT_EQ(folder_.batten(smooth + "d.nc --target haas --profile mine.toml").exit_code, 0);
  for (const char* other : {"b.nc", "c.nc", "d.nc"}) {
    EXPECT_EQ(folder_.text_of(other), folder_.text_of("a.nc"));
  }
}

TEST_F(Profiles, OfUnknownTargetsAreNotShown) {
  expect_exit(folder_.batten("targets --show hass"), 1, {"did you mean 'haas'?"});
}

TEST_F(Profiles, AddWordsThatVerifyWantsToBeTold) {
  expect_exit(
      folder_.batten(
          "smooth part.nc --target vf2.toml --tolerance 0.01 --output arcs -o new.nc --json "
          "report.json"),
      0, {"vf2.toml: 3 lines added", "before runs: G187 P3 E{tolerance}"});
  EXPECT_TRUE(contains(folder_.text_of("new.nc"), "\nG187 P3 E0.01\n"));
  EXPECT_TRUE(contains(folder_.text_of("new.nc"), "(vf2 0.01)\n"));
  const auto report = nlohmann::json::parse(folder_.text_of("report.json"));
  EXPECT_EQ(report["profile"]["lines_added"], 3);
  EXPECT_EQ(report["output"]["target"], "vf2");

  const std::string verify = "verify part.nc new.nc --tolerance 0.01";
  EXPECT_EQ(folder_.batten(verify).exit_code, 3);
  for (const std::string option : {" --profile vf2.toml", " --target vf2.toml"}) {
    expect_exit(folder_.batten(verify + option), 0,
                {"besides 3 lines that the profile vf2.toml adds"});
  }
  EXPECT_EQ(folder_.batten(verify + " --target vf2.toml --profile vf2.toml").exit_code, 1);

  folder_.put("changed.nc", [this] {
    std::string text = folder_.text_of("new.nc");
    return text.replace(text.find("E0.01"), 5, "E0.05");
  }());
  EXPECT_EQ(
      folder_.batten("verify part.nc changed.nc --tolerance 0.01 --profile vf2.toml").exit_code, 3);
}

TEST_F(Profiles, ThatAreWrongAreToldOfWithPlaceAndChoice) {
  folder_.put("bad.toml", "based-on = \"haas\"\n[lines]\ncomments = \"slashes\"\n");
  expect_exit(folder_.batten("smooth part.nc --target bad.toml -o new.nc"), 1,
              {"bad.toml:3:12: lines.comments: \"slashes\", expected one of none, "
               "parentheses, semicolon"});
  EXPECT_FALSE(folder_.has("new.nc"));
}

TEST_F(Profiles, OneTargetIsEnough) {
  expect_exit(folder_.batten("smooth part.nc --target vf2.toml --profile vf2.toml -o new.nc"), 1,
              {"--target names a profile already"});
}

TEST_F(Profiles, AProgramOfAnotherFamilyIsRefusedAndConvertTellsWhy) {
  folder_.put("lcnc.ngc", "G64 P0.01\n" + wave_program());
  const std::string smooth = "smooth lcnc.ngc --target haas --tolerance 0.01 -o new.nc";
  expect_exit(folder_.batten(smooth), 2, {"lcnc.ngc:1:1: error: other-family"});
  expect_exit(folder_.batten(smooth + " --convert"), 2,
              {"lcnc.ngc:1:1: error: cannot-convert: G64 may mean"});
  EXPECT_FALSE(folder_.has("new.nc"));
}

}  // namespace
}  // namespace batten
