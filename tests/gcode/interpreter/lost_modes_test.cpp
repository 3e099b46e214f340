#include "gcode/interpreter/lost_modes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/controls/built_in.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/mode_words.h"
#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

constexpr const char* kKnownModes = "G21 G90 G94 G17 G40 G49 G64\nG54\nG0 X1 Y1 Z1\nG1 X2 F100\n";

// The message of the warning; empty where there is none.
std::string lost_modes_told(const std::string& text) {
  const tests::Interpreted it(text);
  const auto found = std::ranges::find(it.found, "modes-unknown", &Diagnostic::id);
  return found == it.found.end() ? "" : found->message;
}

TEST(LostModes, AreToldWithTheBlockThatLostThem) {
  const std::string unknown =
      lost_modes_told(std::string(kKnownModes) + "G777 (odd)\nX3\nY4\nM3\n");
  EXPECT_NE(unknown.find("behind 'G777 (odd)' is not known, so 2 blocks with X, Y or Z are copied"),
            std::string::npos)
      << unknown;
  EXPECT_EQ(unknown.find("--allow subprogram"), std::string::npos);
  EXPECT_NE(unknown.find("--word"), std::string::npos);
  const std::string call = lost_modes_told(std::string(kKnownModes) + "M98 P1000\nX3\n");
  EXPECT_NE(call.find("so 1 block with X, Y or Z is copied"), std::string::npos) << call;
}

TEST(LostModes, AreToldOfCallsWithTheOptionThatLiftsThem) {
  const std::string call = lost_modes_told(std::string(kKnownModes) + "o100 call\nX3\nX4\n");
  EXPECT_NE(call.find("--allow subprogram"), std::string::npos) << call;
}

// What the message names is what is missing, no more and no less.
TEST(LostModes, AreToldWithTheWordsThatWereNotSaidAgain) {
  const std::string text = std::string(kKnownModes) + "G777\nG90 G94 G40 G49\nX3\nG17\nX4\nM30\n";
  EXPECT_NE(lost_modes_told(text).find(
                "not set again before the last of them: units (G20 or G21), centres of arcs "
                "(G91.1), path mode (G64), tilted plane (G69), scaling (G50), rotation (G69), "
                "mirroring (G50.1), polar coordinates (G15), polar interpolation (G13.1 or G113), "
                "cylindrical coordinates (G7.1 C0), "
                "smoothing by the control (G5.1 Q0, or --allow control-smoothing), modal macro "
                "(G67), constant surface speed "
                "(G97), diameter mode (G8). Set these after it"),
            std::string::npos)
      << lost_modes_told(text);
}

struct WordsRow {
  std::vector<std::string> targets;
  std::vector<std::string> words;  // that say all modes of these controls again
};

// Each word is one that the control has; what it lacks has none.
const WordsRow kWordsRows[] = {
    {{"grbl", "fluidnc", "smoothieware"}, {"G21", "G17", "G90", "G94"}},
    {{"marlin", "klipper"}, {"G21", "G17", "G90"}},
    {{"reprapfirmware"}, {"G21", "G17", "G90", "G94", "G69"}},
    {{"linuxcnc"}, {"G21", "G17", "G90", "G91.1", "G94", "G64", "G40", "G97", "G8"}},
    {{"g2core"}, {"G21", "G17", "G90", "G91.1", "G94", "G64"}},
    {{"grblhal"}, {"G21", "G17", "G90", "G94", "G50", "G67", "G97", "G8"}},
    {{"mach3", "mach4", "uccnc"},
     {"G21", "G17", "G90", "G91.1", "G94", "G64", "G40", "G49", "G50", "G69", "G15", "G67", "G97"}},
    {{"edingcnc", "planetcnc", "masso", "centroid"},
     {"G21", "G17", "G90", "G91.1", "G94", "G64", "G40", "G49", "G69", "G50", "G50.1", "G15", "G67",
      "G97", "G8"}},
    {{"haas"},
     {"G21", "G17", "G90", "G94", "G64", "G40", "G49", "G69", "G50", "G50.1", "G15", "G13.1",
      "G7.1 C0", "G67", "G97"}},
    {{"fanuc", "syntec", "mitsubishi", "mazak", "brother", "hurco", "fagor", "num", "philips"},
     {"G21", "G17", "G90", "G94", "G64", "G40", "G49", "G69", "G50", "G50.1", "G15", "G13.1",
      "G7.1 C0", "G5.1 Q0", "G67", "G97"}},
    {{"okuma"},
     {"G21", "G17", "G90", "G94", "G64", "G40", "G49", "G69", "G50", "G50.1", "G15", "G13.1",
      "G7.1 C0", "G130", "G67", "G97"}},
    {{"codesys"},
     {"G17", "G90", "G91.1", "G94", "G64", "G40", "G49", "G69", "G50", "G50.1", "G15", "G13.1",
      "G7.1 C0", "G5.1 Q0", "G67", "G97", "G8"}},
    {{"beckhoff"},
     {"G21", "G17", "G90", "G91.1", "G94", "G64", "G40", "G49", "G69", "G50", "G50.1", "G15",
      "G13.1", "G7.1 C0", "G5.1 Q0", "G67", "G97", "G8"}}};

bool is_known_behind(const Control& control, const std::string& block,
                     const std::vector<std::string>& words) {
  std::string text = std::string(kKnownModes) + block + "\n";
  for (const std::string& word : words) text += word + "\n";
  return is_known(tests::Interpreted(text, ReadOptions{.lacks = control.lacks}).last_state());
}

// A block may have turned on whatever the control has: with one word left out its mode is not
// known.
TEST(LostModes, AreKnownAgainByTheWordsOfEachControlAndNoFewer) {
  std::size_t seen = 0;
  for (const WordsRow& row : kWordsRows) {
    for (const std::string& target : row.targets) {
      const Control* control = find_control(target);
      ASSERT_NE(control, nullptr) << target;
      ++seen;
      for (const std::string block : {"G777", "START_PRINT", "M98 P1", "o100 call", "G65 P9010"}) {
        SCOPED_TRACE(target + ": " + block);
        EXPECT_TRUE(is_known_behind(*control, block, row.words));
        for (std::size_t i = 0; i < row.words.size(); ++i) {
          std::vector<std::string> fewer = row.words;
          fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
          EXPECT_FALSE(is_known_behind(*control, block, fewer)) << "without " << row.words[i];
        }
      }
    }
  }
  const auto of_the_family = [](const Control& each) { return each.language == Language::kRs274; };
  EXPECT_EQ(seen, static_cast<std::size_t>(std::ranges::count_if(controls(), of_the_family)));
}

// What a program turned on by a word of another control is on, whatever its own control lacks.
TEST(LostModes, OfAnotherControlStayUnknown) {
  const Control* mach3 = find_control("mach3");
  ASSERT_NE(mach3, nullptr);
  const std::vector<std::string>& words = kWordsRows[6].words;
  ASSERT_TRUE(is_known_behind(*mach3, "G777", words));
  for (const std::string on : {"G51.1 X0", "G7.1 C5", "G5.1 Q2", "G7"}) {
    EXPECT_FALSE(is_known_behind(*mach3, on + "\nG777", words)) << on;
  }
}

TEST(LostModes, OfEachControlHaveTheWordsThatAreListed) {
  for (const Control& control : controls()) {
    if (control.language != Language::kRs274 || control.name == "philips") continue;
    SCOPED_TRACE(control.name);
    std::vector<std::string> words;
    for (const std::string_view word : words_of_modes(control)) {
      words.emplace_back(word.substr(word.find(" or ") == word.npos ? 0 : word.find(" or ") + 4));
    }
    if (control.smoothing_off.empty()) words.emplace_back("G5.1 Q0");
    EXPECT_TRUE(is_known_behind(control, "G777", words));
  }
}

TEST(LostModes, AreNotToldWhereNothingIsCopiedForThem) {
  EXPECT_EQ(lost_modes_told(std::string(kKnownModes) + "X3\nM30\n"), "");
  EXPECT_EQ(lost_modes_told(std::string(kKnownModes) + "G777\nM30\n"), "");
  EXPECT_EQ(lost_modes_told("G1 X1\nG21\nG0 X1\n"), "");  // units-missing says that
}

}  // namespace
}  // namespace batten::gcode
