#include "postproc/profile/target_profile.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

class ProfileFile : public testing::Test {
 protected:
  std::shared_ptr<const TargetProfile> read(const std::string& text,
                                            const gcode::Control* target = nullptr) {
    std::ofstream(file_) << text;
    problems_.clear();
    return read_target_profile(file_, target, problems_);
  }

  // Nothing was read, and the only sentence begins so (after the file's name).
  void expect_problem(const std::string& text, const std::string& sentence,
                      const gcode::Control* target = nullptr) {
    EXPECT_EQ(read(text, target), nullptr) << text;
    ASSERT_EQ(problems_.size(), 1U) << text;
    EXPECT_TRUE(problems_[0].starts_with(file_ + sentence)) << problems_[0];
  }

  ScratchFolder folder_;
  const std::string file_ = folder_.file("profile.toml");
  std::vector<std::string> problems_;
};

TEST_F(ProfileFile, ThatIsShownReadsBackTheSame) {
  for (const gcode::Control& target : gcode::controls()) {
    SCOPED_TRACE(target.name);
    const auto profile = read(profile_text(target));
    ASSERT_NE(profile, nullptr) << (problems_.empty() ? "" : problems_[0]);
    EXPECT_TRUE(profile->words.empty());
    EXPECT_EQ(profile_text(profile->adapted), profile_text(target));
  }
}

// The remarks of a profile are what a user takes the sign off.
TEST_F(ProfileFile, ShowsSmoothingWordsThatItTakes) {
  int shown = 0;
  for (const gcode::Control& target : gcode::controls()) {
    std::string text = "based-on = \"" + std::string(target.name) + "\"\n[words]\n";
    for (const std::string_view hint : target.smoothing_words) {
      if (hint.starts_with("before-run") || hint.starts_with("after-run")) {
        text += std::string(hint) + "\n";
        ++shown;
      }
    }
    const auto profile = read(text);
    EXPECT_NE(profile, nullptr) << text << (problems_.empty() ? "" : problems_[0]);
  }
  EXPECT_GE(shown, 12);
}

TEST_F(ProfileFile, ChangesWhatItNamesAndNothingElse) {
  const auto profile = read(R"(
based-on = "haas"
name = "vf2"
[numbers]
places-mm = 4
decimal-point = false
[lines]
max-length = 120
comments = "semicolon"
[arcs]
planes = ["G17"]
words = "radius"
max-sweep = 90
min-radius = 1
)");
  ASSERT_NE(profile, nullptr) << problems_.at(0);
  gcode::Control expected = *gcode::find_control("haas");
  expected.name = "vf2";
  expected.places.mm = 4;
  expected.arc_ends.mm = 4;  // never fewer than places
  expected.decimal_point = false;
  expected.max_line_length = 120;
  expected.comments = gcode::CommentStyle::kSemicolon;
  expected.planes = {true, false, false};
  expected.arc_form = gcode::ArcForm::kRadius;
  expected.max_sweep_deg = 90;
  expected.min_radius = 1;
  EXPECT_EQ(problems_.size(), 0U);
  EXPECT_EQ(profile_text(profile->adapted), profile_text(expected));
}

TEST_F(ProfileFile, TakesTheTargetThatIsNamedBesideIt) {
  const auto profile = read("[lines]\nblanks = false\n", gcode::find_control("grbl"));
  ASSERT_NE(profile, nullptr);
  EXPECT_EQ(profile->adapted.name, "grbl");
  EXPECT_FALSE(profile->adapted.blanks);
}

TEST_F(ProfileFile, ReadsWords) {
  const auto profile = read(R"toml(
based-on = "haas"
[words]
header = ["(smoothed within {tolerance})"]
before-run = ["G187 P3 E{tolerance}"]
after-run = ["G187"]
)toml");
  ASSERT_NE(profile, nullptr) << problems_.at(0);
  const ProfileWords filled =
      filled_in(profile->words, 0.0127, gcode::Units::kInch, profile->adapted);
  EXPECT_EQ(filled.header, std::vector<std::string>{"(smoothed within 0.0005)"});
  EXPECT_EQ(filled.before_run, std::vector<std::string>{"G187 P3 E0.0005"});
  EXPECT_EQ(filled.after_run, std::vector<std::string>{"G187"});
}

// --- what is wrong, with place, value and what is allowed ---------------------------------------

TEST_F(ProfileFile, SaysWhereAValueIsWrongAndWhatItMayBe) {
  const std::pair<const char*, const char*> kWrong[] = {
      {"[numbers]\nplaces-mm = 12",
       ":3:13: numbers.places-mm: 12, expected a whole number from 0 to 9"},
      {"[numbers]\nplaces-mm = 3.5",
       ":3:13: numbers.places-mm: 3.5, expected a whole number from 0 to 9"},
      {"[numbers]\ndecimal-point = \"yes\"",
       ":3:17: numbers.decimal-point: \"yes\", expected true or false"},
      {"[lines]\nmax-length = 10",
       ":3:14: lines.max-length: 10, expected a whole number from 40 to 100000"},
      {"[lines]\ncomments = \"slashes\"",
       ":3:12: lines.comments: \"slashes\", expected one of none, parentheses, semicolon"},
      {"[arcs]\nmin-radius = -1",
       ":3:14: arcs.min-radius: -1, expected a number from 0.001 to 1000000"},
      {"[arcs]\nmax-sweep = \"90\"",
       ":3:13: arcs.max-sweep: \"90\", expected a number from 1 to 360"},
      {"name = \"\"", ":2:8: name: \"\", expected a text that is not empty"},
      // Which keys there are.
      {"[lines]\nlength = 10",
       ":3:10: lines.length: 10, expected one of the keys max-length, blanks, comments, "
       "repeat-words"},
      {"[line]\nblanks = true",
       ":2:1: line: a table, expected one of the sections numbers, lines, arcs, curves, words"},
      // What does not go together.
      {"[numbers]\narc-ends-mm = 2", ":3:15: numbers.arc-ends-mm: 2, expected at least as many"},
      {"[arcs]\nwords = \"radius\"",
       ":3:9: arcs.words: \"radius\", expected max-sweep of 170 or less"},
      {"[curves]\nauto = true", ":3:8: curves.auto: true, expected false: the target has no curves"},
      {"[arcs]\nmin-radius = 2000", ":3:14: arcs.min-radius: 2000, expected less than max-radius"},
      {"machine = \"lathe\"", ":2:11: machine: \"lathe\", expected one of "}};
  for (const auto& [lines, sentence] : kWrong) {
    expect_problem(std::string("based-on = \"haas\"\n") + lines + "\n", sentence);
  }
}

TEST_F(ProfileFile, SaysAllProblemsAtOnce) {
  EXPECT_EQ(read("based-on = \"haas\"\nx = 1\n[numbers]\nfeeds = -1\n[arcs]\nhelices = 3\n"),
            nullptr);
  EXPECT_EQ(problems_.size(), 3U);
}

TEST_F(ProfileFile, NeedsATarget) {
  expect_problem("name = \"x\"\n", ": based-on: nothing given");
  expect_problem("based-on = \"hass\"\n", ":1:12: based-on: \"hass\", expected one of linuxcnc");
  expect_problem("based-on = \"haas\"\n",
                 ":1:12: based-on: \"haas\", expected \"grbl\", which --target names",
                 gcode::find_control("grbl"));
}

TEST_F(ProfileFile, SaysWhereTheTextIsNoToml) {
  expect_problem("based-on = \n", ":1:");
  EXPECT_EQ(read_target_profile("no such file.toml", nullptr, problems_), nullptr);
}

TEST_F(ProfileFile, TakesNoWordThatMovesOrStops) {
  const std::string head = "based-on = \"haas\"\n[words]\nheader = [\"";
  for (const std::string line : {"G91",         "G0 X0",    "G1 Z5",
                                 "X1",          "G20",      "M6 T2",
                                 "M30",         "S1000 M3", "G54",
                                 "G92 X0",      "G187 X1",  "G5.1 Q1 X5",
                                 "G68 R45",     "M128",     "M98 P1",
                                 "#1=5",        "GOTO 10",  "G187 P3 G91",
                                 "F100",        "T1",       "CYCLE81(1)",
                                 "G64 P0.1 X1", "/G187",    "N10 G187",
                                 "G4 P1",       "{feed}",   "#HSC ON X=1;G91"}) {
    EXPECT_EQ(read(head + line + "\"]\n"), nullptr) << line;
  }
}

// Each word of a language is taken by the targets that read it, and by no other.
TEST_F(ProfileFile, TakesNoWordOfAnotherLanguage) {
  struct OwnWord {
    std::string_view base;
    std::string_view line;
  };
  const OwnWord kWords[] = {{"siemens", "CYCLE832(0.01,1,1)"},
                            {"siemens", "COMPCAD"},
                            {"itnc530", "CYCL DEF 32.0 TOLERANCE"},
                            {"beckhoff", "#HSC OFF"}};
  for (const OwnWord& word : kWords) {
    for (const std::string_view target : {"siemens", "itnc530", "beckhoff", "fanuc", "linuxcnc"}) {
      const auto profile =
          read(fmt::format("based-on = \"{}\"\n[words]\nfooter = [\"{}\"]\n", target, word.line));
      EXPECT_EQ(profile != nullptr, target == word.base) << target << ": " << word.line;
    }
  }
}

TEST_F(ProfileFile, NeedsAnEndForWordsThatAct) {
  EXPECT_EQ(read("based-on = \"haas\"\n[words]\nbefore-run = [\"G187 P3\"]\n"), nullptr);
  EXPECT_EQ(read("based-on = \"haas\"\n[words]\nafter-run = [\"G187\"]\n"), nullptr);
  EXPECT_NE(read("based-on = \"haas\"\n[words]\nbefore-run = [\"(finish)\"]\n"), nullptr);
}

}  // namespace
}  // namespace batten::postproc
