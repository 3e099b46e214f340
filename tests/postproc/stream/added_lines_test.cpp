// The words of a profile in a written program: exactly these are taken, and nothing else.
#include <gtest/gtest.h>

#include "postproc/stream/assembly.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

const ProfileWords kWords = {
    .header = {"(by profile)", "G5.1 Q1"},
    .footer = {"G5.1 Q0"},
    .before_run = {"G187 P3 E0.01"},
    .after_run = {"G187"},
};

constexpr const char* kOld = "G21 G90\nG0 X0 Y0\nG1 X1 F100\nG1 X2\nM8\nG1 X3\nG1 X4\nM9\nM30\n";

constexpr const char* kNew =
    "(by profile)\nG5.1 Q1\nG21 G90\nG0 X0 Y0\nG187 P3 E0.01\nG1 X2 F100\nG187\nM8\n"
    "G187 P3 E0.01\nG1 X4\nG187\nM9\nG5.1 Q0\nM30\n";

AddedLines taken(const std::string& text, const ProfileWords& words = kWords,
                 const std::string& old_text = kOld) {
  const ReadText old_program(old_text);
  return take_added_lines(old_program.program, text, words);
}

// What `batten verify --profile` says.
std::vector<std::string> violations(const std::string& text, const std::string& old_text = kOld) {
  const AddedLines added = taken(text, kWords, old_text);
  const ReadText before(old_text);
  const ReadText after(added.text);
  const ReadProgram read{&after.program, &after.meaning};
  std::vector<std::string> ids;
  const auto add = [&ids](const std::vector<Violation>& list) {
    for (const Violation& violation : list) ids.push_back(violation.id);
  };
  add(verify({&before.program, &before.meaning}, read, 0.01).violations);
  add(added.violations);
  add(events_in_brackets(read, added.brackets));
  return ids;
}

constexpr auto with = replaced;

TEST(AddedLines, AreTakenAndLeaveTheLineNumbers) {
  const AddedLines added = taken(kNew);
  EXPECT_EQ(added.text, "\n\nG21 G90\nG0 X0 Y0\n\nG1 X2 F100\n\nM8\n\nG1 X4\n\nM9\n\nM30\n");
  EXPECT_EQ(added.lines, 7U);
  EXPECT_TRUE(added.violations.empty());
  ASSERT_EQ(added.brackets.size(), 2U);
  EXPECT_EQ(added.brackets[0].before, 5U);
  EXPECT_EQ(added.brackets[0].after, 7U);
  EXPECT_EQ(taken(joined(lines_of(kNew), "\r\n")).lines, 7U) << "of other line ends, too";
  EXPECT_EQ(violations(kNew), std::vector<std::string>{});
  EXPECT_FALSE(verdict(kOld, kNew, 0.01).proved()) << "without a profile";
}

TEST(AddedLines, ThatAreWrongAreViolations) {
  const std::pair<const char*, std::string> rows[] = {
      {"AnotherNumber", with(kNew, "G187 P3 E0.01", "G187 P3 E0.02")},
      {"AnotherBlank", with(kNew, "G187 P3 E0.01", "G187 P3  E0.01")},
      {"OnceMore", with(kNew, "M8\n", "M8\nG187\n")},
      {"NoEnd", with(kNew, "G187\n", "")},
      {"NoEndAtAll", with(with(kNew, "G187\n", ""), "G187\n", "")},
      {"NoBeginning", with(kNew, "G187 P3 E0.01\n", "")},
      {"HalfAHeader", with(kNew, "(by profile)\n", "")},
      {"NoHeader", with(kNew, "(by profile)\nG5.1 Q1\n", "")},
      {"NoFooter", with(kNew, "G5.1 Q0\n", "")},
      {"TwoFooters", with(kNew, "M30", "G5.1 Q0\nM30")},
      {"TwoHeaders", with(kNew, "G21", "(by profile)\nG5.1 Q1\nG21")},
      {"FooterInsideARun", with(with(kNew, "G5.1 Q0\n", ""), "G1 X4\n", "G5.1 Q0\nG1 X4\n")},
      {"AroundAnEvent", with(kNew, "G187\nM8\nG187 P3 E0.01\n", "M8\n")},
      {"AroundARapid", with(kNew, "G0 X0 Y0\nG187 P3 E0.01\n", "G187 P3 E0.01\nG0 X0 Y0\n")},
      {"OtherWordsBeside", with(kNew, "G187 P3 E0.01\n", "G187 P3 E0.01\nM7\n")},
      {"AnotherMoveBeside", with(kNew, "G1 X4\n", "G1 Y1\nG1 X4\n")}};
  for (const auto& [name, text] : rows) {
    EXPECT_NE(violations(text), std::vector<std::string>{}) << name;
  }
}

// The program's own G187 P1 would be undone by the profile's G187.
TEST(AddedLines, AreNotTakenWhereTheOldProgramHasSuchWordsItself) {
  const std::string old_text = with(kOld, "M8", "G187 P1\nM8");
  const std::string new_text = with(kNew, "M8", "G187 P1\nM8");
  EXPECT_NE(violations(new_text, old_text), std::vector<std::string>{});
  EXPECT_EQ(taken(new_text, kWords, old_text).lines, 0U);
}

TEST(LineWithWordsOf, LooksAtCodesAndNamesWhateverTheirArguments) {
  const auto line = [](const std::string& text, const ProfileWords& words) {
    const ReadText read(text);
    return line_with_words_of(read.program, words);
  };
  EXPECT_EQ(line("G21\nG1 X1\nG187P1\n", kWords), 3U);
  EXPECT_EQ(line("G21\ng05.1 q2 x0\n", kWords), 2U);
  EXPECT_EQ(line("G21\n(G187)\nG18\n", kWords), 0U);
  ProfileWords siemens;
  siemens.before_run = {"CYCLE832(0.01,1)"};
  siemens.after_run = {"CYCLE832(0,0)"};
  EXPECT_EQ(line("G71\nN10 cycle832(0.02,2)\n", siemens), 2U);
  EXPECT_EQ(line("G71\n;CYCLE832\nG1 X1\n", siemens), 0U);
}

SmoothOptions with_words(std::string_view target, ProfileWords words) {
  SmoothOptions options = options_for(target);
  options.words = std::move(words);
  options.profile = "test.toml";
  return options;
}

ProfileWords smoothness() {
  return {.header = {"(header)"},
          .footer = {"(footer)"},
          .before_run = {"G187 P3 E{tolerance}"},
          .after_run = {"G187"}};
}

TEST(ProfileWordsInPrograms, StandAroundRewrittenRunsAndAreProved) {
  const SmoothResult result = smoothed(wave_program(), with_words("haas", smoothness()));
  ASSERT_EQ(rewritten_runs(result), 1U);
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(result.added_lines, 4U);
  const auto lines = lines_of(result.text);
  EXPECT_EQ(lines.front(), "(header)");
  const auto before = std::ranges::find(lines, "G187 P3 E0.01");
  const auto after = std::ranges::find(lines, "G187");
  const auto footer = std::ranges::find(lines, "(footer)");
  ASSERT_TRUE(before != lines.end() && after != lines.end() && footer != lines.end());
  EXPECT_TRUE((before + 1)->starts_with("G")) << "the run names its motion again";
  EXPECT_NE((before + 1)->find('F'), std::string::npos) << "and its feed";
  EXPECT_EQ(*(after + 1), "G0 Z5");
  EXPECT_EQ(*(footer + 1), "M2");
}

TEST(ProfileWordsInPrograms, AreNotAddedWhereNothingIsRewrittenNorASecondTime) {
  SmoothOptions options = with_words("haas", smoothness());
  const SmoothResult once = smoothed(wave_program(), options);
  const SmoothResult twice = smoothed(once.text, options);
  EXPECT_TRUE(twice.understood);
  EXPECT_EQ(twice.text, once.text);
  options.method = Method::kNone;
  const SmoothResult result = smoothed(wave_program(), options);
  EXPECT_EQ(result.text, wave_program());
  EXPECT_EQ(result.added_lines, 0U);
}

TEST(ProfileWordsInPrograms, MakeAProgramThatHasThemItselfRefused) {
  const std::string text = "G187 P1\n" + wave_program();
  const SmoothResult result = smoothed(text, with_words("haas", smoothness()));
  EXPECT_FALSE(result.understood);
  EXPECT_TRUE(std::ranges::any_of(result.diagnostics, [](const gcode::Diagnostic& each) {
    return each.id == "profile-words-in-program";
  }));
}

TEST(ProfileWordsInPrograms, StandOnceAroundRunsThatFollowEachOther) {
  // Two waves with a feed between that only the settings block says: one or two runs, but never an
  // end and a beginning right after each other.
  const SmoothResult result =
      smoothed(head("G21") + joined(wave_lines({}), "\n") + "M8\n" +
                   joined(wave_lines({.lines = 200, .height = -2}), "\n") + tail(),
               with_words("haas", smoothness()));
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(result.text.find("G187\nG187 P3"), std::string::npos);
}

TEST(ProfileWordsInPrograms, FollowTheMarksOfTheProgram) {
  const std::string text = "%\r\nO1000 (part)\r\n" + wave_program({.line_end = "\r\n"}) + "%\r\n";
  ProfileWords words = smoothness();
  words.header = {"G5.1 Q1"};
  words.footer = {"G5.1 Q0"};
  const SmoothResult result = smoothed(text, with_words("haas", words));
  ASSERT_EQ(rewritten_runs(result), 1U);
  EXPECT_TRUE(result.text.starts_with("%\r\nO1000 (part)\r\nG5.1 Q1\r\nG21 G90 G17\r\n"))
      << result.text.substr(0, 60);
  EXPECT_TRUE(result.text.ends_with("M5\r\nG5.1 Q0\r\nM2\r\n%\r\n"));
}

// A dwell of the profile is a second of the program that is written, as `batten time` counts it.
TEST(AddedLines, CountInTheTimeOfWhatIsWritten) {
  SmoothOptions options = options_for("linuxcnc");
  const std::string text = wave_program();
  const double without = smoothed(text, options).program_after.seconds;
  options.words.before_run = {"G4 P1"};
  options.words.after_run = {"G64 P0.01"};
  const SmoothResult result = smoothed(text, options);
  ASSERT_EQ(rewritten_runs(result), 1U);
  const ReadText written(result.text);
  EXPECT_EQ(result.program_after.seconds,
            time_of(written.program, written.meaning, options).seconds);
  EXPECT_NEAR(result.program_after.seconds, without + 1, 0.01);
}

}  // namespace
}  // namespace batten::postproc
