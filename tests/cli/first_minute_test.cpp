// From an empty home to a smoothed file: what options come from, and what is said of it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "batten_process.h"

namespace batten {
namespace {

std::string with_head(const std::string& head) { return head + wave_program(); }

class FirstMinute : public testing::Test {
 protected:
  [[nodiscard]] ProcessResult batten(const std::string& arguments) const {
    return folder_.batten(arguments);
  }

  BattenFolder folder_;
};

constexpr const char* kUserConfig = ".home/.config/batten/config.toml";

// --- what a rule costs ---------------------------------------------------------------------------

TEST_F(FirstMinute, TheSummarySaysWhatLiftingARuleWouldWin) {
  folder_.put("exact.ngc", "G61\n" + wave_program());
  const ProcessResult kept = batten("smooth exact.ngc --target linuxcnc");
  expect_exit(kept, 0, {"(exact-stop)", "found         --allow exact-stop: ", "% fewer blocks"});
  const ProcessResult lifted =
      batten("smooth exact.ngc --target linuxcnc --allow exact-stop -o lifted.ngc");
  expect_exit(lifted, 0, {"1 rewritten"});
  EXPECT_EQ((kept.out + kept.err).find("1 rewritten"), std::string::npos);
}

// --- the target ----------------------------------------------------------------------------------

TEST_F(FirstMinute, ProgramsOfAPostThatNamesItsControlNeedNoOption) {
  folder_.put("linuxcnc.ngc",
              with_head("(Exported by FreeCAD)\n(Post Processor: linuxcnc_post)\n"));
  folder_.put("grbl.nc", with_head("N10 (Exported by FreeCAD)\nN20 (Post Processor: grbl_post)\n"));
  expect_exit(batten("smooth linuxcnc.ngc"), 0,
              {"linuxcnc.smooth.ngc, for linuxcnc",
               "target: line 2 says (Post Processor: linuxcnc_post)", "1 rewritten"});
  expect_exit(batten("smooth grbl.nc"), 0,
              {"grbl.smooth.nc, for grbl", "target: line 2 says N20 (Post Processor: grbl_post)"});
}

TEST_F(FirstMinute, AProgramOfAShopTakesThreeMessages) {
  folder_.put("part.nc", "%\nO1234 (BRACKET)\n" + wave_program() + "%\n");
  expect_exit(batten("smooth part.nc"), 1,
              {"for which control is part.nc? likely fanuc or haas or mazak", "batten setup"});
  expect_exit(batten("setup --target haas"), 0, {"config.toml: written"});
  expect_exit(batten("smooth part.nc"), 0, {"part.smooth.nc, for haas"});
  EXPECT_TRUE(folder_.has("part.smooth.nc"));
}

// A post for many controls, a name in a title, and words that several controls have are no proof.
TEST_F(FirstMinute, WhatIsNotCertainIsAsked) {
  const auto expect_likely = [&](const std::string& name, const std::string& head,
                                 const std::string& likely) {
    folder_.put(name, with_head(head));
    const ProcessResult asked =
        expect_exit(batten("smooth " + name), 1, {name + "? likely " + likely});
    EXPECT_FALSE(contains(asked.err, "fagor")) << "not all of them: " << asked.err;
  };
  expect_likely("a.nc", "(POST PROCESSOR: FANUC_POST)\n", "fanuc or haas or mazak (line 1 says");
  expect_likely("b.nc", "(FOR THE HAAS)\n", "haas");
  expect_likely("c.nc", "(Post Processor: my_grbl_post)\n", "grbl");
  expect_likely("d.nc", "G64 P0.01\n", "linuxcnc or edingcnc or planetcnc (line 1 has G64");
  expect_likely("e.ngc", "", "linuxcnc");
  expect_likely("f.mpf", "", "siemens");
  expect_likely("g.nc", "X1 (grbl_post)\n", "grbl");
}

TEST_F(FirstMinute, StandardInputNeedsATarget) {
  folder_.put("part.nc", with_head("(Post Processor: grbl_post)\n"));
  expect_exit(batten("smooth - < part.nc"), 1, {"--target: no target given"});
}

// --- files of configuration
// ------------------------------------------------------------------------

TEST_F(FirstMinute, TheNearestFileGoesFirst) {
  folder_.put("shop/job/part.nc", wave_program());
  folder_.put(kUserConfig,
              "target = \"linuxcnc\"\ntolerance = \"0.04\"\nprefer = \"size\"\n"
              "side = \"left\"\nstrict = true\n");
  folder_.put("named.toml", "tolerance = \"0.03\"\nprefer = \"accuracy\"\nside = \"right\"\n");
  folder_.put("shop/batten.toml", "tolerance = \"0.02\"\nprefer = \"time\"\n");
  const ProcessResult printed = expect_exit(
      folder_.shell("BATTEN_CONFIG=named.toml batten smooth shop/job/part.nc --tolerance 0.01 "
                    "--print-config"),
      0);
  for (const char* const each :
       {"# from the command line\ntolerance = \"0.01\"", "shop/batten.toml\nprefer = \"time\"",
        "# from named.toml\nside = \"right\"", ".config/batten/config.toml\ntarget = \"linuxcnc\"",
        ".config/batten/config.toml\nstrict = true"}) {
    EXPECT_TRUE(contains(printed.out, each)) << each << "\n" << printed.out;
  }
}

TEST_F(FirstMinute, OnlyTheNearestOfTheFoldersAboveCounts) {
  folder_.put("shop/job/part.nc", wave_program());
  folder_.put("batten.toml", "target = \"linuxcnc\"\nprefer = \"size\"\n");
  folder_.put("shop/job/batten.toml", "target = \"grbl\"\n");
  const ProcessResult printed = expect_exit(batten("smooth shop/job/part.nc --print-config"), 0);
  EXPECT_TRUE(contains(printed.out, "target = \"grbl\"")) << printed.out;
  EXPECT_TRUE(contains(printed.out, "prefer = \"time\"")) << printed.out;
}

// Else a router's program would be planned, and its arcs judged, for the mill of another file.
TEST_F(FirstMinute, AMachineStaysWithTheTargetOfItsFile) {
  folder_.put("part.nc", wave_program());
  folder_.put(kUserConfig, "target = \"fanuc\"\nmachine = \"mill\"\n");
  expect_exit(batten("smooth part.nc -t grbl"), 0, {"machine router"});
  folder_.put("batten.toml", "target = \"linuxcnc\"\n");
  expect_exit(batten("smooth part.nc --force"), 0, {"machine linuxcnc"});
  folder_.put("batten.toml", "tolerance = 0.02\n");
  expect_exit(batten("smooth part.nc --force"), 0, {"for fanuc", "machine mill"});
}

TEST_F(FirstMinute, FilesThatAConfigurationNamesAreSoughtFromItsFolder) {
  folder_.put("shop/job/part.nc", wave_program());
  folder_.put("shop/own.toml", "based-on = \"router\"\n");
  folder_.put("shop/batten.toml", "target = \"grbl\"\nmachine = \"own.toml\"\n");
  expect_exit(batten("smooth shop/job/part.nc"), 0, {"machine own"});
}

TEST_F(FirstMinute, WhatIsWrongInAConfigurationIsToldByItsLine) {
  folder_.put("part.nc", wave_program());
  folder_.put("batten.toml", "tolerence = 1\n");
  expect_exit(batten("smooth part.nc -t grbl"), 1,
              {"batten.toml:1: there is no option 'tolerence', did you mean 'tolerance'?"});
  expect_exit(
      folder_.shell("rm batten.toml; BATTEN_CONFIG=none.toml batten smooth part.nc -t grbl"), 1,
      {"none.toml"});
}

TEST_F(FirstMinute, TheSummaryAndTheReportSayWhereOptionsComeFrom) {
  folder_.put("part.nc", wave_program());
  folder_.put("batten.toml", "target = \"linuxcnc\"\ntolerance = 0.02\n");
  expect_exit(batten("smooth part.nc --json part.json"), 0,
              {"options       target, tolerance: ", "/batten.toml\n"});
  const auto report = nlohmann::json::parse(folder_.text_of("part.json"));
  EXPECT_TRUE(contains(report["options_from"]["tolerance"].get<std::string>(), "/batten.toml"));
  EXPECT_EQ(report["options_from"].size(), 2u);
}

TEST_F(FirstMinute, OtherCommandsTakeWhatTheyHave) {
  folder_.put("part.nc", wave_program());
  folder_.put("batten.toml", "target = \"linuxcnc\"\ntolerance = 0.012\nmachine = \"linuxcnc\"\n");
  expect_exit(batten("smooth part.nc"), 0);
  expect_exit(batten("verify part.nc part.smooth.nc"), 0, {"keeps 0.012 mm", "/batten.toml"});
  expect_exit(batten("time part.nc"), 0, {"machine", "/batten.toml"});
  expect_exit(batten("batch . out --jobs 1 --suffix nc"), 1);  // out is inside
  folder_.put("tree/a.nc", wave_program());
  expect_exit(batten("batch tree out --jobs 1"), 0, {"target", "/batten.toml"});
  // A profile is another thing to each of the two.
  folder_.put("batten.toml", "profile = \"mine.toml\"\n");
  expect_exit(batten("time part.nc --machine mill"), 0);
  EXPECT_FALSE(folder_.has("mine.toml"));
}

// --- setup
// -----------------------------------------------------------------------------------------

TEST_F(FirstMinute, SetupAsksAndAsksAgain) {
  folder_.put("settings.txt",
              "$11=0.010\n$12=0.002\n$110=3000.000\n$111=3000.000\n$112=800.000\n"
              "$120=200.000\n$121=200.000\n$122=90.000\n");
  const ProcessResult asked = expect_exit(
      folder_.shell("printf 'grble\\ngrbl\\nsettings.txt\\n0.02\\n\\n' | batten setup"), 0,
      {"Which control", "did you mean 'grbl'?", "[router]", "[0.01mm]", "config.toml: written"});
  const std::string config = folder_.text_of(kUserConfig);
  EXPECT_TRUE(contains(config, "target = \"grbl\"\n")) << config;
  EXPECT_TRUE(contains(config, "/settings.txt\"\n")) << config;
  EXPECT_TRUE(contains(config, "tolerance = \"0.02\"\n")) << config;
  EXPECT_FALSE(contains(config, "units")) << config;
  folder_.put("deep/part.nc", wave_program());
  expect_exit(folder_.shell("cd deep && batten smooth part.nc"), 0, {"for grbl"});
}

TEST_F(FirstMinute, SetupWithOptionsAsksNothing) {
  folder_.put("job/mill.toml", "based-on = \"linuxcnc\"\n");
  expect_exit(folder_.shell("batten setup -t linuxcnc --machine job/mill.toml --units mm "
                            "-o job/batten.toml < /dev/null"),
              0);
  folder_.put("job/part.nc", wave_program());
  expect_exit(batten("smooth job/part.nc"), 0, {"machine mill"});
  expect_exit(batten("setup -t grbl -o job/batten.toml"), 4, {"exists already", "--force"});
  expect_exit(batten("setup -t grbl -o job/batten.toml --force"), 0);
  EXPECT_TRUE(contains(folder_.text_of("job/batten.toml"), "machine = \"router\""));
}

TEST_F(FirstMinute, SetupWritesNothingThatIsWrong) {
  expect_exit(batten("setup --target grble --tolerance 3,5"), 1,
              {"there is no 'grble'", "--tolerance: '3,5'"});
  expect_exit(folder_.shell("batten setup < /dev/null"), 1, {"--target: no answer"});
  EXPECT_FALSE(folder_.has(kUserConfig));
}

// --- several programs
// ------------------------------------------------------------------------------

TEST_F(FirstMinute, SeveralProgramsEachHaveTheirOutput) {
  folder_.put("a.nc", wave_program());
  folder_.put("b.nc", with_head("(Post Processor: grbl_post)\n"));
  folder_.put("sub/c.nc", wave_program());
  folder_.put("sub/batten.toml", "target = \"linuxcnc\"\n");
  expect_exit(batten("smooth b.nc sub/c.nc"), 0,
              {"b.smooth.nc, for grbl", "c.smooth.nc, for linuxcnc", "2 programs: 2 done, 0 not"});
  expect_exit(batten("smooth a.nc -t grbl"), 0);
  EXPECT_EQ(expect_exit(batten("smooth a.nc -t grbl -o -"), 0).out, folder_.text_of("a.smooth.nc"));
  // As a shell has them for *.nc: what was made of one of them is not smoothed again.
  expect_exit(folder_.shell("batten smooth *.nc -t grbl --force"), 0,
              {"a.smooth.nc: left out", "b.smooth.nc: left out", "2 programs: 2 done"});
  EXPECT_FALSE(folder_.has("a.smooth.smooth.nc"));
}

TEST_F(FirstMinute, TheExitCodeOfSeveralProgramsIsTheWorst) {
  folder_.put("a.nc", wave_program());
  folder_.put("units.nc", "G1 X1 F100\nX2\n");
  expect_exit(batten("smooth units.nc a.nc -t grbl"), 2, {"2 programs: 1 done, 1 not"});
  EXPECT_TRUE(folder_.has("a.smooth.nc"));
  expect_exit(batten("smooth none.nc units.nc -t grbl --quiet"), 4, {"2 programs: 0 done, 2 not"});
}

TEST_F(FirstMinute, OptionsForOneProgramAreRefusedForSeveral) {
  folder_.put("a.nc", wave_program());
  folder_.put("b.nc", wave_program());
  for (const char* option : {"-o c.nc", "--json c.json", "--report c.html"}) {
    expect_exit(batten(std::string("smooth a.nc b.nc -t grbl ") + option), 1,
                {"is for one program; 2 are given"});
  }
  expect_exit(batten("smooth a.nc ./a.nc -t grbl"), 1, {"./a.nc: is given twice"});
  expect_exit(batten("smooth a.nc - -t grbl"), 1, {"standard input is a program by itself"});
  const ProcessResult wrong = expect_exit(batten("smooth a.nc b.nc -t grbl --prefer speed"), 1);
  EXPECT_EQ(wrong.err.find("there is no 'speed'"), wrong.err.rfind("there is no 'speed'"));
  EXPECT_FALSE(folder_.has("a.smooth.nc"));
}

}  // namespace
}  // namespace batten
