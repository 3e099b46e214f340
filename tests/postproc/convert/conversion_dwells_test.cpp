// Dwells between languages and controls. What G4 means on each stands in gcode/text/language.h;
// every text is derived by hand from that: 1.5 s are P1.5, X1.5, P1500 or F1.5.
#include <gtest/gtest.h>

#include "gcode/controls/built_in.h"
#include "gcode/reading/source_kind.h"
#include "postproc/convert/conversion.h"
#include "tests/support/conversion_programs.h"

namespace batten::postproc {
namespace {

using gcode::DwellForm;
using gcode::Language;
using gcode::SourceKind;

struct Waiting {
  const char* name;
  SourceKind source;
  Language language;
  std::string block;
};

std::string around(Language language, const std::string& block) {
  const std::string plain = "G0 X0 Y0 Z5\n" + block + "G1 X1 F100\nM30\n";
  if (language == Language::kSiemens) return "%_N_TEST_MPF\nG710\nG17 G40 G90 G94\n" + plain;
  if (language == Language::kRs274) return "G21 G17 G40 G90 G94\n" + plain;
  return as_klartext("L X+0 Y+0 Z+5 R0 FMAX\n" + block + "L X+1 F100\nM30\n");
}

// A second and a half.
std::vector<Waiting> waitings() {
  return {
      {"Ngc", SourceKind::kNgc, Language::kRs274, "G4 P1.5\n"},
      {"Grbl", SourceKind::kGrbl, Language::kRs274, "G4 P1.5\n"},
      {"HaasWithPoint", SourceKind::kHaas, Language::kRs274, "G04 P1.5\n"},
      {"HaasWithout", SourceKind::kHaas, Language::kRs274, "G4 P1500\n"},
      {"FanucX", SourceKind::kFanuc, Language::kRs274, "G4 X1.5\n"},
      {"FanucP", SourceKind::kFanuc, Language::kRs274, "G04 P1500\n"},
      {"WhoeverReadsX", SourceKind::kAuto, Language::kRs274, "G4 X1.5\n"},
      {"Siemens", SourceKind::kAuto, Language::kSiemens, "G4 F1.5\n"},
      {"Klartext", SourceKind::kAuto, Language::kKlartext,
       "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5\n"},
      {"GermanKlartext", SourceKind::kAuto, Language::kKlartext,
       "CYCL DEF 9.0 VERWEILZEIT\nCYCL DEF 9.1 V.ZEIT 1.5\n"},
  };
}

struct Waited {
  const char* target;
  const char* begin;  // of plain words
  std::string block;
};

std::vector<Waited> waiteds() {
  return {{"linuxcnc", "", "G4 P1.5\n"},
          {"grbl", "", "G4 P1.5\n"},
          {"fluidnc", "", "G4 P1.5\n"},
          {"haas", "", "G4 P1.5\n"},
          {"fanuc", "", "G4 X1.5\n"},
          {"mitsubishi", "", "G4 X1.5\n"},
          {"beckhoff", "", "G4 X1.5\n"},
          {"siemens", "", "G4 F1.5\n"},
          {"heidenhain", "", "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5\n"}};
}

SmoothResult converted(const Waiting& from, const std::string& text, std::string_view target) {
  SmoothOptions options = ways_to(target);
  options.source = from.source;
  return smoothed(text, options);
}

// Without the numbers of its blocks.
std::string unnumbered(const std::string& text) {
  std::string bare;
  for (const std::string& line : lines_of(text)) {
    bare += line.substr(std::min(line.find_first_not_of("0123456789 "), line.size())) + "\n";
  }
  return bare;
}

TEST(ConversionDwells, WaitAsLongInEachLanguage) {
  for (const Waiting& from : waitings()) {
    for (const Waited& to : waiteds()) {
      const gcode::Control& target = *gcode::find_control(to.target);
      if (target.language == from.language) continue;
      SCOPED_TRACE(std::string(from.name) + " to " + to.target);
      const std::string text = around(from.language, from.block);
      const SmoothResult result = converted(from, text, to.target);
      ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, text));
      EXPECT_NE(unnumbered(result.text).find("\n" + to.block), std::string::npos) << result.text;
      const ReadText before(text, from.language, nullptr, gcode::dwells_of(from.source));
      const ReadText after(result.text, target.language, nullptr, target.dwell_form);
      EXPECT_TRUE(verify(before.read(), after.read(), 0.01).proved());
    }
  }
}

TEST(ConversionDwells, AreSaidToTheMillisecond) {
  const auto said = [](const char* seconds, std::string_view target) {
    const std::string text = around(Language::kSiemens, std::string("G4 F") + seconds + "\n");
    const SmoothResult result = smoothed(text, ways_to(target));
    EXPECT_TRUE(result.proved) << testing::PrintToString(told(result, text));
    const std::string bare = unnumbered(result.text);
    const std::size_t begin = std::min({bare.find("G4 "), bare.find("CYCL DEF 9.1"), bare.size()});
    return bare.substr(begin, bare.find('\n', begin) - begin);
  };
  EXPECT_EQ(said("2", "linuxcnc"), "G4 P2");
  EXPECT_EQ(said("2", "haas"), "G4 P2.");
  EXPECT_EQ(said("2", "fanuc"), "G4 X2.");
  EXPECT_EQ(said("2", "heidenhain"), "CYCL DEF 9.1 DWELL 2");
  EXPECT_EQ(said(".001", "fanuc"), "G4 X0.001");
  EXPECT_EQ(said("10.05", "linuxcnc"), "G4 P10.05");
  EXPECT_EQ(said("3600", "heidenhain"), "CYCL DEF 9.1 DWELL 3600");
}

// --- what is refused ----------------------------------------------------------------------------

struct NoTime {
  SourceKind source;
  Language language;
  const char* block;
  const char* target;
  std::string told;  // behind the block
};

TEST(ConversionDwells, AreRefusedWhereATimeIsNotCertain) {
  const std::string unit =
      " waits for seconds on some controls and for milliseconds on others; --source ngc, grbl, "
      "fanuc or haas says which";
  const std::string uncertain = " waits for a time that is not certain";
  const NoTime kCases[] = {
      {SourceKind::kAuto, Language::kRs274, "G4 P1.5", "heidenhain", unit},
      {SourceKind::kAuto, Language::kRs274, "G4 P1.5", "siemens", unit},
      {SourceKind::kAuto, Language::kRs274, "G4 X1500", "siemens", uncertain},
      {SourceKind::kFanuc, Language::kRs274, "G4 P1.5", "siemens", uncertain},
      {SourceKind::kNgc, Language::kRs274, "G4 X1.5", "siemens", uncertain},
      {SourceKind::kNgc, Language::kRs274, "G4 P1 M8", "siemens", uncertain},
      {SourceKind::kNgc, Language::kRs274, "G4 P1 X2", "siemens", uncertain},
      {SourceKind::kNgc, Language::kRs274, "G4 P0", "siemens", uncertain},
      {SourceKind::kNgc, Language::kRs274, "G4", "siemens", uncertain},
      {SourceKind::kNgc, Language::kRs274, "G4 P0.0005", "siemens", uncertain},
      {SourceKind::kNgc, Language::kRs274, "G4 P3600.001", "siemens", uncertain},
      {SourceKind::kAuto, Language::kSiemens, "G4 S20", "linuxcnc",
       " waits for turns of the spindle, which is no time"},
      {SourceKind::kAuto, Language::kSiemens, "G4 F1.5", "mazak",
       " waits for 1.5 s, and how that is said there is not certain"},
      {SourceKind::kAuto, Language::kSiemens, "G4 F1.5", "mach3",
       " waits for 1.5 s, and how that is said there is not certain"},
  };
  for (const NoTime& each : kCases) {
    SCOPED_TRACE(std::string(each.block) + " for " + each.target);
    const std::string text = around(each.language, std::string(each.block) + "\n");
    const SmoothResult result = converted({"", each.source, each.language, ""}, text, each.target);
    EXPECT_FALSE(result.understood);
    EXPECT_EQ(result.text, "");
    const std::string line = each.language == Language::kSiemens ? "5:1: " : "3:1: ";
    EXPECT_EQ(told(result, text),
              std::vector<std::string>{
                  fmt::format("{}{}{} (target {})", line, each.block, each.told, each.target)});
  }
}

// Each half of cycle 9 alone, other words, another order.
TEST(ConversionDwells, OfKlartextAreTwoBlocksThatFollowEachOther) {
  for (const char* blocks : {"CYCL DEF 9.0 DWELL TIME\n", "CYCL DEF 9.1 DWELL 1.5\n",
                             "CYCL DEF 9.1 DWELL 1.5\nCYCL DEF 9.0 DWELL TIME\n",
                             "CYCL DEF 9.0 DWELL TIME\n; and\nCYCL DEF 9.1 DWELL 1.5\n",
                             "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL\n",
                             "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL Q5\n",
                             "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5 S2\n",
                             "CYCL DEF 10.0 ROTATION\nCYCL DEF 9.1 DWELL 1.5\n"}) {
    const std::string text = around(Language::kKlartext, blocks);
    EXPECT_FALSE(smoothed(text, ways_to("linuxcnc")).understood) << text;
    const std::string plain = around(Language::kRs274, "G4 P1.5\n");
    const ReadText before(text, Language::kKlartext);
    const ReadText after(plain, Language::kRs274, nullptr, DwellForm::kSecondsP);
    EXPECT_FALSE(verify(before.read(), after.read(), 0.01).proved()) << text;
  }
}

// --- between controls that read the same words --------------------------------------------------

TEST(ConversionDwells, AreCopiedWhereTheyLastAsLong) {
  const auto first_told = [](DwellForm source, const char* block, std::string_view target) {
    const ReadText read(std::string(block) + "\n", Language::kRs274, nullptr, source);
    gcode::Diagnostics found;
    tell_what_cannot_be_said(read.program, *gcode::find_control(target), found);
    return found.empty() ? std::string("taken") : found.front().message;
  };
  EXPECT_EQ(first_told(DwellForm::kSecondsP, "G4 P2", "grbl"), "taken");
  EXPECT_EQ(first_told(DwellForm::kSecondsP, "G4 P2.5", "haas"), "taken");
  EXPECT_EQ(first_told(DwellForm::kSecondsXOrMsP, "G4 X2.5", "fanuc"), "taken");
  EXPECT_EQ(first_told(DwellForm::kUnknown, "G4 X2.5", "beckhoff"), "taken");
  EXPECT_EQ(first_told(DwellForm::kSecondsXOrMsP, "G4 P500", "haas"), "taken");
  EXPECT_EQ(first_told(DwellForm::kSecondsP, "G4 P2", "haas"),
            "G4 waits for another time there (target haas)");
  EXPECT_EQ(first_told(DwellForm::kSecondsByPoint, "G4 P500", "linuxcnc"),
            "G4 waits for another time there (target linuxcnc)");
  EXPECT_EQ(first_told(DwellForm::kSecondsP, "G4 P2", "fanuc"),
            "G4 waits for another time there (target fanuc)");
  EXPECT_EQ(first_told(DwellForm::kSecondsP, "G4 P2.5", "fanuc"),
            "G4 waits for a time that is not certain there (target fanuc)");
  EXPECT_EQ(first_told(DwellForm::kSecondsP, "G4 P2", "mach3"),
            "G4 waits for a time that is not certain there (target mach3)");
}

// P2 is 2 s on LinuxCNC and 0.002 s on Haas; P2.5 is the same on both.
TEST(ConversionDwells, MakeAProgramOneForOtherControls) {
  SmoothOptions options = options_for("haas");
  options.source = SourceKind::kNgc;
  const auto first_told = [&](const char* block) {
    const std::string text = std::string(block) + "\n" + wave_program();
    const SmoothResult result = smoothed(text, options);
    const auto errors = told(result, text);
    EXPECT_EQ(errors.empty(), result.understood);
    return errors.empty() ? std::string("taken") : errors.front();
  };
  EXPECT_EQ(first_told("G4 P2.5"), "taken");
  EXPECT_EQ(first_told("G4 P2"),
            "1:1: G4 P2 waits for 2 s on the control that --source names, and for 0.002 s on "
            "target haas; --convert lists which blocks could not be said there");
  options.convert = true;
  EXPECT_EQ(first_told("G4 P2"), "1:1: G4 waits for another time there (target haas)");
}

// --- the proof ----------------------------------------------------------------------------------

TEST(ConversionDwells, ProveNoOtherTime) {
  const std::string text =
      around(Language::kKlartext, "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5\n");
  const auto proved = [&](const std::string& block, DwellForm form) {
    const ReadText before(text, Language::kKlartext);
    const ReadText after(around(Language::kRs274, block), Language::kRs274, nullptr, form);
    return verify(before.read(), after.read(), 0.01).proved();
  };
  EXPECT_TRUE(proved("G4 P1.5\n", DwellForm::kSecondsP));
  EXPECT_TRUE(proved("G4 P1500\n", DwellForm::kSecondsByPoint));
  EXPECT_TRUE(proved("G4 P1500\n", DwellForm::kSecondsXOrMsP));
  EXPECT_FALSE(proved("", DwellForm::kSecondsP));
  EXPECT_FALSE(proved("G4 P1.501\n", DwellForm::kSecondsP));
  EXPECT_FALSE(proved("G4 P1.5\nG4 P1.5\n", DwellForm::kSecondsP));
  EXPECT_FALSE(proved("G4 P1500\n", DwellForm::kSecondsP));
  EXPECT_FALSE(proved("G4 P1.5\n", DwellForm::kUnknown));
  EXPECT_FALSE(proved("G4 P1.5 M8\n", DwellForm::kSecondsP));
  EXPECT_FALSE(proved("G4 X1500\n", DwellForm::kSecondsXOrMsP));
}

TEST(ConversionDwells, ProveNoDwellAtAnotherPlace) {
  const std::string text =
      "%_N_TEST_MPF\nG710\nG17 G40 G90 G94\nG0 X0 Y0 Z5\nG1 X1 F100\nG4 F2\nX2\nM30\n";
  const std::string right = "G21 G17 G40 G90 G94\nG0 X0 Y0 Z5\nG1 X1 F100\nG4 P2\nX2\nM30\n";
  const std::string late = "G21 G17 G40 G90 G94\nG0 X0 Y0 Z5\nG1 X1 F100\nX2\nG4 P2\nM30\n";
  const ReadText before(text, Language::kSiemens);
  const ReadText after(right, Language::kRs274, nullptr, DwellForm::kSecondsP);
  const ReadText other(late, Language::kRs274, nullptr, DwellForm::kSecondsP);
  EXPECT_TRUE(verify(before.read(), after.read(), 0.01).proved());
  EXPECT_FALSE(verify(before.read(), other.read(), 0.01).proved());
}

// Behind a dwell the place and the feed are as before it, where its word is a time for certain.
TEST(ConversionDwells, ChangeNeitherPlaceNorFeed) {
  const ReadText siemens("G710\nG0 X0 Y0 Z5\nG1 X1 F100\nG4 F2\nX2\n", Language::kSiemens);
  EXPECT_EQ(siemens.meaning.states[siemens.meaning.blocks[3].state_after].feed, 100);
  const ReadText plain("G21\nG0 X0 Y0 Z5\nG1 X1 F100\nG4 X2.\nX2\n", Language::kRs274);
  EXPECT_TRUE(plain.meaning.motions.back().start_known);
  const ReadText unsure("G21\nG0 X0 Y0 Z5\nG1 X1 F100\nG4 X2\nX2\n", Language::kRs274);
  EXPECT_FALSE(unsure.meaning.motions.back().start_known);
}

}  // namespace
}  // namespace batten::postproc
