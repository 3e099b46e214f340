// A block that is not understood, in the midst of a program: what is behind it is smoothed only
// where the block cannot have changed what it means, or where that was said again.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/mode_words.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

struct BoundedRow {
  const char* block;
  bool smoothed_behind;
};

const BoundedRow kBoundedRows[] = {
    {"[SECOND PASS]", true},
    {"$X", true},
    {"$H", true},
    {"$110=500", true},
    {"M117 Layer 2/3", true},
    {"M0 Change the tool", true},
    {"M94/1", true},
    {"M3 $0 S1000", true},
    {"M55", true},
    {"M101", true},
    {"X1 X2", true},
    {"F100 F200", true},
    {"M3 M5", true},
    {"G90 G91\nG90", true},
    {"G93 G94\nG94", true},
    {"G40 G41 D1\nG40", true},
    {"G17 G18\nG17", true},
    // The wave would be cut in increments, beside itself, in another plane, by the inverse of time,
    // with stops at each point, by a macro, in other units.
    {"G90 G91", false},
    {"X1 X2 G91", false},
    {"G40 G41 D1", false},
    {"G17 G18", false},
    {"G93 G94", false},
    {"G61.1 G64", false},
    {"G20 G21", false},
    {"G20 G21\nG91 G90\nG90", false},
    {"G90 G91 G777\nG90", false},
    {"START_PRINT", false},
    {"part.nc", false},
    {"$J=G91 X1 F9", false},
    {"[SECOND PASS] G91", false},
    {"G777", false},
    {"M98 P1", false},
    {"L54", false},      // a subprogram of Sinumerik
    {"G11 P30", false},  // of Okuma
};

TEST(BoundedBlocks, LoseOnlyWhatTheyCanHaveChanged) {
  const std::string wave = joined(wave_lines({}), "\n");
  for (const BoundedRow& row : kBoundedRows) {
    SCOPED_TRACE(row.block);
    const std::string text = head("G21") + "G94 G40 G64\n" + wave + "G0 Z5\n" + row.block +
                             "\nG0 X0 Y0 Z5\nG1 Z-1 F300\n" + wave + tail();
    const SmoothResult result = smoothed(text, options_for("grbl"));
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(rewritten_runs(result), row.smoothed_behind ? 2U : 1U);
  }
}

// A wave, a block that is not understood, some words, and the same wave again.
std::size_t rewritten_behind(const std::string& block, const std::vector<std::string>& words,
                             const SmoothOptions& options, const std::string& units = "G21") {
  const std::string wave = joined(wave_lines({}), "\n");
  std::string text = head(units) + "G94 G40\n" + wave + "G0 Z5\n" + block + "\n" +
                     joined(words, "\n") + "G0 X0 Y0 Z5\nG1 Z-1 F300\n" + wave + tail();
  if (options.target->needs_commands) {
    for (std::size_t at = text.find("\nX"); at != std::string::npos; at = text.find("\nX", at)) {
      text.insert(at + 1, "G1 ");
    }
  }
  return rewritten_runs(smoothed(text, options));
}

TEST(BoundedBlocks, OfADefinitionOfLinuxcncChangeNothing) {
  const SmoothOptions options = options_for("linuxcnc");
  EXPECT_EQ(rewritten_behind("o<a> sub\nG91 G20 G41\no<a> endsub", {}, options), 2U);
  EXPECT_EQ(rewritten_behind("o<a> sub\nG91\no<a> endsub\no<a> call", {}, options), 1U);
}

// What a control's own words do is known in programs for it, and in no others.
TEST(BoundedBlocks, OfOwnWordsOfAControlAreKnownInItsProgramsAlone) {
  for (const gcode::Control& control : gcode::controls()) {
    for (const auto& [name, effect] : control.own_words) {
      SCOPED_TRACE(control.name + ": " + std::string(name));
      SmoothOptions options = options_for(control.name);
      options.units = gcode::Units::kMillimetre;
      const std::string units = gcode::other_meaning(control, 210).empty() ? "G21" : "G71";
      const std::string block = std::string(name) + (name.starts_with("#") ? "[]" : "");
      EXPECT_EQ(rewritten_behind(block, {}, options, units), 2U);
      const bool known_to_all =
          name == "G51" || name == "G52" || name == "G53" || name.starts_with("M");
      options.target = gcode::find_control("smoothieware");
      if (known_to_all) continue;
      EXPECT_LE(rewritten_behind(block, {}, options), 1U);
    }
  }
}

// With any one of the words left out nothing is.
void expect_settled_by(const std::vector<std::string>& words, const SmoothOptions& options) {
  for (const std::string block : {"G777", "START_PRINT", "M98 P1", "L54", "part.nc"}) {
    SCOPED_TRACE(block);
    EXPECT_EQ(rewritten_behind(block, words, options), 2U);
    for (std::size_t i = 0; i < words.size(); ++i) {
      SCOPED_TRACE("without " + words[i]);
      std::vector<std::string> fewer = words;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
      EXPECT_EQ(rewritten_behind(block, fewer, options), 1U);
    }
  }
}

// grbl drops a block with a word that it does not know, and has no other modes than these.
TEST(BoundedBlocks, AreSettledForGrblByItsFewModes) {
  expect_settled_by({"G17", "G21", "G90", "G94"}, options_for("grbl"));
}

// Elsewhere the block may have mirrored or scaled what follows, or turned its plane.
TEST(BoundedBlocks, AreNotSettledByTheModesOfGrblOnOtherControls) {
  const std::vector<std::string> words = {"G17", "G21", "G90", "G94", "G40", "G49"};
  for (const char* target : {"grblhal", "linuxcnc", "fanuc", "haas", "mach3"}) {
    SCOPED_TRACE(target);
    EXPECT_EQ(rewritten_behind("G777", words, options_for(target)), 1U);
  }
}

// Written for a control that has more modes: M98 may have left any of them on.
TEST(BoundedBlocks, AreNotSettledByTheModesOfGrblInProgramsForOthers) {
  const std::vector<std::string> words = {"G17", "G21", "G90", "G94"};
  SmoothOptions converted = options_for("grbl");
  converted.convert = true;
  EXPECT_LE(rewritten_behind("M98 P1", words, converted), 1U);
  SmoothOptions from_haas = options_for("grbl");
  from_haas.source = gcode::SourceKind::kHaas;
  EXPECT_EQ(rewritten_behind("M98 P1", words, from_haas), 1U);
}

// Modes of others that a program for grbl names are on from there: not those of power-on.
TEST(BoundedBlocks, LeaveUnknownWhatAProgramForGrblHasSetOn) {
  const std::vector<std::string> words = {"G17", "G21", "G90", "G94"};
  for (const char* on : {"G51 X2", "G68 X0 Y0 R30", "G41 D1", "G16", "G61.1", "G90.1", "G96"}) {
    SCOPED_TRACE(on);
    EXPECT_LE(rewritten_behind(std::string(on) + "\nG777", words, options_for("grbl")), 1U);
  }
}

std::vector<std::string> words_for(const gcode::Control& control) {
  std::vector<std::string> words;
  for (const std::string_view word : gcode::words_of_modes(control)) {
    const std::size_t choice = word.find(" or ");
    words.emplace_back(choice == word.npos ? word : word.substr(choice + 4));
  }
  return words;
}

// Of the controls that share a list one is tried with each word left out, from the text to the
// proved text.
TEST(BoundedBlocks, AreSettledByTheWordsThatTheMessageNames) {
  for (const char* target : {"grblhal", "g2core", "smoothieware", "linuxcnc", "mach3", "planetcnc",
                             "fanuc", "mazak", "haas"}) {
    SCOPED_TRACE(target);
    const gcode::Control* control = gcode::find_control(target);
    ASSERT_NE(control, nullptr);
    expect_settled_by(words_for(*control), options_for(target));
  }
}

// Where the control's own word that ends its smoothing is not read, its user says that both
// tolerances together are fine; whether it is on is then no matter. On Philips other words, too,
// have meanings of its own: no list settles its modes.
TEST(BoundedBlocks, AreSettledOnEveryControlSomeWithAnOption) {
  std::vector<std::string> only_with_option;
  for (const gcode::Control& control : gcode::controls()) {
    if (control.language != gcode::Language::kRs274 || control.needs_commands) continue;
    if (control.name == "philips") continue;
    SCOPED_TRACE(control.name);
    SmoothOptions options = options_for(control.name);
    options.units = gcode::Units::kMillimetre;
    const std::string units = gcode::other_meaning(control, 210).empty() ? "G21" : "";
    const std::vector<std::string> words = words_for(control);
    if (rewritten_behind("G777", words, options, units) == 2U) continue;
    only_with_option.push_back(control.name);
    options.allowed = {"control-smoothing"};
    EXPECT_EQ(rewritten_behind("G777", words, options, units), 2U);
  }
  EXPECT_EQ(only_with_option,
            (std::vector<std::string>{"hurco", "fagor", "num", "codesys", "beckhoff"}));
}

TEST(BoundedBlocks, BehindSmoothingThatIsOnAreSettledWithTheOption) {
  const gcode::Control* okuma = gcode::find_control("okuma");
  ASSERT_NE(okuma, nullptr);
  std::vector<std::string> words = words_for(*okuma);
  std::erase(words, "G130");
  SmoothOptions options = options_for("okuma");
  EXPECT_EQ(rewritten_behind("G131 F5000 J1 E0.01\nG777", words, options), 1U);
  options.allowed = {"control-smoothing"};
  EXPECT_EQ(rewritten_behind("G131 F5000 J1 E0.01\nG777", words, options), 2U);
}

TEST(BoundedBlocks, OfSiemensAreSettledByTheWordsOfSiemens) {
  const std::vector<std::string> words = {"G17", "G71",        "G90",   "G94",    "G64",
                                          "G40", "TRAFOOF",    "TRANS", "COMPOF", "MCALL",
                                          "G97", "CYCLE800()", "DIAMOF"};
  const std::string wave = joined(wave_lines({}), "\n");
  const auto rewritten = [&](const std::string& block, const std::vector<std::string>& said) {
    const std::string down = "G0 X0 Y0 Z5\nG1 Z-1 F300\n";
    const std::string text = "; a part\nG71 G90 G17 G94\n" + down + wave + "G0 Z5\n" + block +
                             "\n" + joined(said, "\n") + down + wave + "G0 Z5\nM30\n";
    SmoothOptions options = options_for("siemens");
    options.source = gcode::SourceKind::kSiemens;
    return rewritten_runs(smoothed(text, options));
  };
  for (const std::string block : {"G777", "L54", "PART(1)", "PART"}) {
    SCOPED_TRACE(block);
    EXPECT_EQ(rewritten(block, words), 2U);
    for (std::size_t i = 0; i < words.size(); ++i) {
      SCOPED_TRACE("without " + words[i]);
      std::vector<std::string> fewer = words;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
      EXPECT_EQ(rewritten(block, fewer), 1U);
    }
  }
}

// Of words that exclude each other the control may have taken either, or none: the same word behind
// them is no repetition.
TEST(BoundedBlocks, AreNoReasonToLeaveOutTheWordThatSettlesThem) {
  for (const std::string& word : {std::string("G41"), std::string("G40")}) {
    SCOPED_TRACE(word);
    const std::string begin = head("G21") + "G40\nG40 G41 D1\n";
    const std::string end = "G0 X0 Y0\nG1 X5 Y5 F100\nX9\n" + tail();
    const ReadText with(begin + word + "\n" + end);
    const ReadText without(begin + end);
    const auto proved =
        verify({&with.program, &with.meaning}, {&without.program, &without.meaning}, 0.01).proved();
    EXPECT_FALSE(proved);
  }
}

}  // namespace
}  // namespace batten::postproc
