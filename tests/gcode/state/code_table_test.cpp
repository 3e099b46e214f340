// The table of codes, row by row. What the rows mean is tested where they are read (interpreter,
// proof, program time, conversion); here, that each code has the row that it should have.
#include "gcode/state/code_table.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

// A trait is said by its letter.
constexpr std::string_view kLetters = "raqfspncuxltEoAeCSkhdwz";

struct Expected {
  std::string_view group;
  int value;
  std::string_view why;
  std::string_view traits;
  std::string_view act;
  std::vector<Code> codes;
};

constexpr std::string_view kGroups[] = {
    "unknown",     "none",      "axis user", "motion",  "cycle end", "plane",  "distance",
    "arc",         "feed",      "units",     "cutter",  "length",    "return", "work offset",
    "path",        "spindle",   "diameter",  "scaling", "rotation",  "mirror", "polar",
    "cylindrical", "smoothing", "macro",     "stop",    "turning"};
constexpr std::string_view kActs[] = {
    "",       "dwell",     "machine place", "home", "stores home", "sets place", "data",
    "origin", "drills",    "calls",         "on",   "tool",        "switches",   "stops",
    "ends",   "overrides", "mirrors",       "tip",  "builder's"};

const std::vector<Expected> kG = {
    {"motion", 1, "", "ACS", "", {0}},
    {"motion", 2, "", "ACS", "", {10}},
    {"motion", 3, "", "ACS", "", {20}},
    {"motion", 4, "", "ACS", "", {30}},
    {"motion", 5, "spline", "", "", {50, 52, 53, 60, 61, 62, 63}},
    {"motion", 5, "probe", "", "", {310, 382, 383, 384, 385}},
    {"motion", 5, "threading", "", "", {320, 330, 331, 340, 760}},
    {"motion", 5, "canned-cycle", "", "", {120, 130, 740, 870, 880}},
    {"motion", 5, "canned-cycle", "", "drills", {810, 841, 842, 843}},
    {"motion", 5, "canned-cycle", "k", "drills", {730}},
    {"motion", 5, "canned-cycle", "kh", "drills", {830}},
    {"motion", 5, "canned-cycle", "d", "drills", {820}},
    {"motion", 5, "canned-cycle", "w", "drills", {840, 850}},
    {"motion", 5, "canned-cycle", "dz", "drills", {860}},
    {"motion", 5, "canned-cycle", "dw", "drills", {890}},
    {"cycle end", 5, "state-change", "rAeCS", "", {800}},
    {"none", 0, "dwell", "raqfsnl", "dwell", {40}},
    {"none", 0, "exact-stop", "rx", "", {90}},
    {"none", 0, "state-change", "rq", "", {110, 1870}},
    {"none", 0, "coordinate-change", "raqn", "machine place", {530}},
    {"axis user", 0, "coordinate-change", "raqp", "data", {100}},
    {"axis user", 0, "coordinate-change", "raq", "home", {280, 300}},
    {"axis user", 0, "coordinate-change", "raq", "stores home", {281, 301}},
    {"axis user", 0, "coordinate-change", "raqp", "origin", {520, 921, 922, 923}},
    {"axis user", 0, "coordinate-change", "raqfsn", "sets place", {920}},
    {"axis user", 0, "subprogram", "raqcl", "calls", {650}},
    {"macro", 1, "modal-macro", "raqul", "calls", {660, 661}},
    {"macro", 0, "modal-macro", "rq", "", {670}},
    {"plane", 1, "state-change", "ACS", "", {170}},
    {"plane", 2, "state-change", "ACS", "", {180}},
    {"plane", 3, "state-change", "ACS", "", {190}},
    {"units", 2, "state-change", "ACS", "", {200}},
    {"units", 1, "state-change", "ACS", "", {210}},
    {"units", 2, "state-change", "oAS", "", {700}},
    {"units", 1, "state-change", "oAS", "", {710}},
    {"distance", 1, "state-change", "ACS", "", {900}},
    {"distance", 2, "state-change", "ACS", "", {910}},
    {"arc", 1, "state-change", "AS", "", {901}},
    {"arc", 2, "state-change", "AS", "", {911}},
    {"feed", 2, "state-change", "rAe", "", {930}},
    {"feed", 1, "state-change", "rAeCS", "", {940}},
    {"feed", 3, "state-change", "rAe", "", {950}},
    {"cutter", 0, "state-change", "ACS", "", {400}},
    {"cutter", 1, "cutter-compensation", "rqA", "", {410, 411, 420, 421}},
    {"length", 2, "tool-change", "rqpAeC", "", {430}},
    {"length", 2, "tool-change", "raqpAe", "", {431, 432}},
    {"length", 2, "tool-change", "rqpAe", "", {440}},
    {"length", 1, "tool-change", "rqpAe", "", {434, 435}},
    {"length", 0, "tool-change", "rqpAeC", "", {490}},
    {"work offset", 0, "coordinate-change", "rqAeC", "", {540, 550, 560, 570, 580, 590}},
    {"work offset", 0, "coordinate-change", "rqEAe", "", {541}},
    {"work offset", 0, "coordinate-change", "rqAe", "", {591, 592, 593}},
    {"path", 3, "state-change", "A", "", {600, 611}},
    {"path", 2, "state-change", "A", "", {610}},
    {"path", 0, "state-change", "rq", "", {620, 630}},
    {"path", 1, "state-change", "rqAe", "", {640}},
    {"spindle", 1, "spindle", "qA", "", {960}},
    {"spindle", 0, "spindle", "qAS", "", {970}},
    {"return", 1, "state-change", "rAS", "", {980}},
    {"return", 0, "state-change", "rAS", "", {990}},
    {"diameter", 1, "state-change", "A", "", {70}},
    {"diameter", 0, "state-change", "A", "", {80}},
    {"scaling", 0, "scaling", "asA", "", {500}},
    {"scaling", 1, "scaling", "aA", "", {510}},
    {"mirror", 0, "mirror", "aA", "", {501}},
    {"mirror", 1, "mirror", "aA", "", {511}},
    {"rotation", 1, "rotation", "aA", "", {680}},
    {"rotation", 1, "tilted-plane", "atA", "", {682, 683, 684}},
    {"rotation", 0, "rotation", "A", "", {690}},
    {"polar", 1, "polar-coordinates", "A", "", {121, 160, 1120}},
    {"polar", 0, "polar-coordinates", "A", "", {131, 150, 1130}},
    {"cylindrical", 1, "cylindrical", "aA", "", {71, 1070}},
    {"smoothing", 0, "control-smoothing", "l", "", {51}},
    {"smoothing", 0, "control-smoothing", "", "", {1300}},
    {"smoothing", 1, "control-smoothing", "", "", {1310}},
};

const std::vector<Expected> kM = {
    {"stop", 0, "program-end", "rqC", "stops", {0, 10}},
    {"stop", 0, "program-end", "rquC", "ends", {20, 300}},
    {"stop", 0, "program-end", "rqp", "stops", {600}},
    {"turning", 0, "spindle", "rqC", "on", {30, 40}},
    {"turning", 0, "spindle", "rqC", "switches", {50}},
    {"none", 0, "spindle", "rq", "switches", {190}},
    {"none", 0, "tool-change", "rqpC", "tool", {60}},
    {"none", 0, "tool-change", "rqp", "switches", {610}},
    {"none", 0, "coolant", "rq", "switches", {70}},
    {"none", 0, "coolant", "rqC", "switches", {80, 90}},
    {"none", 2, "misc-function", "rq", "mirrors", {210, 220}},
    {"none", 0, "misc-function", "rq", "mirrors", {230}},
    {"none", 0, "misc-function", "rq", "overrides", {480, 490}},
    {"none", 0, "misc-function", "rqu", "builder's", {720}},
    {"none", 0, "subprogram", "rqc", "calls", {970, 980, 1980}},
    {"none", 0, "subprogram", "rqu", "calls", {990}},
    {"none", 1, "misc-function", "rqp", "tip", {1280}},
    {"none", 0, "misc-function", "rqp", "tip", {1290}},
};
const Expected kUnknownG = {"unknown", 0, "not-understood", "rqx", "", {}};
const Expected kOtherM = {"none", 0, "misc-function", "rq", "builder's", {}};
const Expected kUserM = {"none", 0, "misc-function", "rqp", "builder's", {}};

std::string letters_of(trait::Traits traits) {
  std::string letters;
  for (std::size_t i = 0; i < kLetters.size(); ++i) {
    if ((traits >> i & 1U) != 0) letters += kLetters[i];
  }
  return letters;
}

void expect_row(const CodeRow& row, Code code, const Expected& expected) {
  SCOPED_TRACE(code);
  EXPECT_EQ(row.code, code);
  EXPECT_EQ(kGroups[static_cast<std::size_t>(row.group)], expected.group);
  EXPECT_EQ(static_cast<int>(row.value.as<std::uint8_t>()), expected.value);
  EXPECT_EQ(row.why, expected.why);
  EXPECT_EQ(letters_of(row.traits), expected.traits);
  EXPECT_EQ(kActs[static_cast<std::size_t>(row.act)], expected.act);
}

void expect_rows(const CodeRow& (*row_of)(Code), const std::vector<Expected>& rows,
                 const Expected& other, const Expected& from_1000) {
  std::map<Code, const Expected*> known;
  for (const Expected& each : rows) {
    for (const Code code : each.codes) EXPECT_TRUE(known.emplace(code, &each).second) << code;
  }
  for (Code code = -1; code < 99990; ++code) {
    const auto row = known.find(code);
    if (row != known.end()) {
      expect_row(row_of(code), code, *row->second);
    } else if (row_of(code).code != kNoCode || code % 999 == 0) {
      expect_row(row_of(code), kNoCode, code < 1000 ? other : from_1000);
    }
  }
}

TEST(CodeTable, EachGHasItsRow) { expect_rows(row_of_g, kG, kUnknownG, kUnknownG); }

TEST(CodeTable, EachMHasItsRow) { expect_rows(row_of_m, kM, kOtherM, kUserM); }

// In a program that has said nothing else, a code that ends a run does so for the reason of its
// row.
TEST(CodeTable, TheReasonOfTheRowStandsInTheBlock) {
  for (const auto* rows : {&kG, &kM}) {
    for (const Expected& each : *rows) {
      for (const Code code : each.codes) {
        const std::string word = (rows == &kG ? "G" : "M") + std::to_string(code / 10) +
                                 (code % 10 == 0 ? "" : "." + std::to_string(code % 10));
        SCOPED_TRACE(word);
        const tests::Interpreted it("X1\n" + word + "\n");
        // G69 ends a tilted plane, too, and that first. G0 .. G3 alone change the mode.
        const std::string_view why = code == 690 && rows == &kG ? "tilted-plane"
                                     : each.why.empty()         ? "state-change"
                                                                : each.why;
        EXPECT_EQ(it.line(2).barrier.id(), why);
      }
    }
  }
}

TEST(CodeTable, AWordHasACodeOfAtMostOneDecimal) {
  const auto code = [](double value, bool is_number = true) {
    Word word;
    word.value = value;
    word.is_number = is_number;
    return code_of(word);
  };
  EXPECT_EQ(code(1), 10);
  EXPECT_EQ(code(38.2), 382);
  EXPECT_EQ(code(0), 0);
  EXPECT_EQ(code(1.25), kNoCode);
  EXPECT_EQ(code(-3), kNoCode);
  EXPECT_EQ(code(10000), kNoCode);
  EXPECT_EQ(code(1, false), kNoCode);
}

}  // namespace
}  // namespace batten::gcode
