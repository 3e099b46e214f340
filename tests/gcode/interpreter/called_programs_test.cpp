// What is known behind calls of programs that were read: what they leave, from what was known at
// the call; and which files are such programs at all.
#include "gcode/interpreter/called_programs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gcode/reading/parser.h"
#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

Program parsed(const std::string& text, Language language = Language::kRs274) {
  Diagnostics found;
  return parse(SourceText("test", std::string(text)), language, found);
}

std::string why_not(const std::string& name, const std::string& text,
                    Language language = Language::kRs274) {
  std::string why;
  return as_subprogram(name, parsed(text, language), why) ? "" : why;
}

// --- which files are programs that surely come back
// -----------------------------------------------

struct FileCase {
  std::string name;
  std::string text;
  std::string why;  // a part of it; empty: it is one
  Language language = Language::kRs274;
};

class FilesOfCalledPrograms : public testing::TestWithParam<FileCase> {};

TEST_P(FilesOfCalledPrograms, AreTakenOnlyWhereTheirEndIsCertain) {
  const auto& [name, text, why, language] = GetParam();
  const std::string said = why_not(name, text, language);
  EXPECT_EQ(said.empty(), why.empty()) << said;
  EXPECT_NE(said.find(why), std::string::npos) << said;
}

INSTANTIATE_TEST_SUITE_P(
    Fanuc, FilesOfCalledPrograms,
    testing::Values(FileCase{"P1234", "O1234 (HOLE)\nG0 X1\nM99\n", ""},
                    FileCase{"P1234", "%\nO1234\nN10 G0 X1\nN20 M99\n%\n", ""},
                    FileCase{"P1234", "G0 X1\nM99\n", ""},
                    // An early way back.
                    FileCase{"P1234", "O1234\n/M99\nG0 X1\nM99\n", ""},
                    // A part program that has this name, too.
                    FileCase{"P1234", "O1234\nG0 X1\nM30\n", "ends the whole program"},
                    FileCase{"P1234", "O1234\nG0 X1\n", "does not say where it goes back"},
                    FileCase{"P1234", "O1234\nG0 X1\n/M99\n", "may be skipped"},
                    // N100 of the program that calls.
                    FileCase{"P1234", "O1234\nG0 X1\nM99 P100\n", "goes back to a block"},
                    FileCase{"P1234", "O1234\nM99 P100\nG0 X1\nM99\n", "goes back to a block"},
                    FileCase{"P1234", "O1234\nM99 P#1\nM99\n", "goes back to a block"},
                    FileCase{"P1234", "O1234\nG0 X1 M99\n", "says more beside M99"},
                    FileCase{"P1234", "O1234\nIF [#1 EQ 0] THEN M30\nM99\n", "not certain"},
                    FileCase{"P1234", "O1234\nM#1\nM99\n", "computed"},
                    FileCase{"P1234", "O9\nG0 X1\nM99\n", "says that it is O9"},
                    FileCase{"P1234", "O1234\nM99\nO1235\nM99\n", "several programs"},
                    // LinuxCNC: modes are those of before the call.
                    FileCase{"P1234", "M73\nG91\nM99\n", "takes back what it sets"}));

INSTANTIATE_TEST_SUITE_P(
    LinuxCnc, FilesOfCalledPrograms,
    testing::Values(FileCase{"O<PROBE>", "o<probe> sub\nG0 X1\no<probe> endsub\nM2\n", ""},
                    FileCase{"O100", "(a hole)\no100 sub\nG0 X1\nO100 endsub [1]\n", ""},
                    FileCase{"O<PROBE>", "o<probe2> sub\nG0 X1\no<probe2> endsub\n", "not hold"},
                    FileCase{"O<PROBE>", "G0 X1\nM2\n", "not hold O<PROBE> sub"},
                    FileCase{"O<PROBE>", "o<probe> sub\nG0 X1\nM2\n", "ends the whole program"},
                    FileCase{"O<PROBE>", "o<probe> sub\nG0 X1\n", "no endsub"},
                    FileCase{"O<PROBE>", "o<probe> sub\nM73\nG91\no<probe> endsub\n",
                             "takes back what it sets"},
                    FileCase{"O<PROBE>",
                             "o<probe> sub\no<probe> endsub\no<probe> sub\no<probe> endsub\n",
                             "twice"}));

INSTANTIATE_TEST_SUITE_P(
    SiemensAndKlartext, FilesOfCalledPrograms,
    testing::Values(
        FileCase{"L54", "N10 G0 X1\nN20 M17\n", "", Language::kSiemens},
        FileCase{"HOLE", "PROC HOLE(REAL A)\nG0 X1\nRET ; back\n", "", Language::kSiemens},
        FileCase{"L54", "G0 X1\nM30\n", "ends the whole program", Language::kSiemens},
        FileCase{"L54", "G0 X1\nRET(\"N100\")\nM17\n", "goes back to a block", Language::kSiemens},
        FileCase{"HOLE", "PROC HOLE SAVE\nG91\nM17\n", "takes back", Language::kSiemens},
        FileCase{"L54", "G0 X1\n/M17\n", "not certain", Language::kSiemens},
        FileCase{"PGM A", "0 BEGIN PGM A MM\n1 L X+1 FMAX\n2 END PGM A MM\n", "",
                 Language::kKlartext},
        FileCase{"PGM A", "0 BEGIN PGM A MM\n1 L X+1 FMAX M30\n2 END PGM A MM\n",
                 "ends the whole program", Language::kKlartext}));

// --- what is called
// ---------------------------------------------------------------------------------

struct ProgramCallCase {
  std::string text;
  std::string name;  // empty: none for certain
  bool is_once = true;
  Language language = Language::kRs274;
};

class CallsInBlocks : public testing::TestWithParam<ProgramCallCase> {};

TEST_P(CallsInBlocks, NameOneProgramOrNone) {
  const auto& [text, name, is_once, language] = GetParam();
  const Program program = parsed(text, language);
  const auto call = called_program(program, program.blocks.back());
  EXPECT_EQ(call ? call->name : "", name);
  EXPECT_TRUE(!call || call->is_once == is_once);
}

INSTANTIATE_TEST_SUITE_P(
    OfEachForm, CallsInBlocks,
    testing::Values(
        ProgramCallCase{"G0\nM98 P0012", "P12"}, ProgramCallCase{"G0\nN5 M98 P12 L3", "P12", false},
        ProgramCallCase{"G0\nG65 P9810 X1. F#1", "P9810"},
        // O51234, or five times O1234.
        ProgramCallCase{"G0\nM98 P51234", ""}, ProgramCallCase{"G0\nM98 P12 H5", ""},
        ProgramCallCase{"G0\nM98 P12 X5", ""}, ProgramCallCase{"G0\nM98 P12 M8", ""},
        ProgramCallCase{"G0\nM98 P12 L0", ""}, ProgramCallCase{"G0\nM98 P12 L#1", ""},
        ProgramCallCase{"G0\nG66 P12", ""}, ProgramCallCase{"G0\nM97 P12", ""},
        ProgramCallCase{"G0\no<probe> call [1]", "O<PROBE>"},
        ProgramCallCase{"G0\nO100 call", "O100"}, ProgramCallCase{"G0\no#1 call", ""},
        ProgramCallCase{"G0\nL54", "L54", true, Language::kSiemens},
        ProgramCallCase{"G0\nL54 P3", "L54", false, Language::kSiemens},
        ProgramCallCase{"G0\nL54 P0", "", false, Language::kSiemens},
        ProgramCallCase{"G0\nMCALL L54", "", true, Language::kSiemens},
        ProgramCallCase{"0 BEGIN PGM A MM\n1 CALL PGM b.h", "PGM B", true, Language::kKlartext},
        ProgramCallCase{"0 BEGIN PGM A MM\n1 CALL PGM TNC:\\b.h", "", true, Language::kKlartext}));

// --- what is known behind the call
// -------------------------------------------------------------------

constexpr const char* kModesOfBefore =
    "G21 G90 G94 G17 G40 G49 G64\nG54\nG0 X1 Y1 Z1\nG1 X2 F100\n";

ReadOptions calling(const std::vector<std::pair<std::string, std::string>>& files) {
  std::vector<Subprogram> programs;
  for (const auto& [name, text] : files) {
    std::string why;
    auto sub = as_subprogram(name, parsed(text), why);
    EXPECT_TRUE(sub.has_value()) << why;
    if (sub) programs.push_back(std::move(*sub));
  }
  ReadOptions options;
  options.subprograms = std::make_shared<const Subprograms>(std::move(programs));
  return options;
}

// The last block: G1 to X50.
struct BehindCall {
  BehindCall(const std::string& body, const std::string& call = "M98 P1",
             const std::string& next = "G1 X50 Y50 Z50")
      : it(std::string(kModesOfBefore) + call + "\n" + next + "\n",
           calling({{"P1", "O1\n" + body + "\nM99\n"}})) {}

  [[nodiscard]] bool starts_at(double x, double y, double z) const {
    const Motion* motion = it.motion_of_line(it.read.blocks.size());
    return motion != nullptr && motion->start_known &&
           motion->piece.start() == geometry::Point3(x, y, z);
  }
  [[nodiscard]] bool starts_somewhere() const {
    const Motion* motion = it.motion_of_line(it.read.blocks.size());
    return motion == nullptr || !motion->start_known;
  }
  [[nodiscard]] const ModalState& modes() const { return it.last_state(); }

  tests::Interpreted it;
};

TEST(CalledPrograms, LeaveThePositionAndTheModesThatTheySet) {
  const BehindCall call("G0 X5 Y6\nG1 Z-2 F77\nS500 M3");
  EXPECT_TRUE(call.starts_at(5, 6, -2));
  EXPECT_TRUE(is_known(call.modes()));
  EXPECT_EQ(call.modes().feed, 77);
  EXPECT_EQ(call.modes().spindle_speed, 500);
}

// Each is a program that would be cut wrongly if the modes of before the call held behind it.
TEST(CalledPrograms, LeaveWhatTheyChangeChanged) {
  EXPECT_EQ(BehindCall("G91\nX1").modes().distance, DistanceMode::kIncremental);
  EXPECT_EQ(BehindCall("G20").modes().units, Units::kInch);
  EXPECT_EQ(BehindCall("G18").modes().plane, Plane::kZX);
  EXPECT_EQ(BehindCall("G68 X0 Y0 R30").modes().rotation, TriState::kOn);
  EXPECT_EQ(BehindCall("G41 D1").modes().cutter_compensation, TriState::kOn);
  EXPECT_EQ(BehindCall("G93").modes().feed_mode, FeedMode::kInverseTime);
  EXPECT_EQ(BehindCall("G0 X0", "M98 P1", "X50").modes().motion, MotionMode::kRapid);
}

TEST(CalledPrograms, MoveByIncrementsFromWhereTheyAreCalled) {
  EXPECT_TRUE(BehindCall("G91\nG0 X5\nG90").starts_at(7, 1, 1));
  // Three times, or as often as the control takes L for.
  EXPECT_TRUE(BehindCall("G91\nG0 X5\nG90", "M98 P1 L3").starts_somewhere());
  EXPECT_TRUE(is_known(BehindCall("G91\nG0 X5\nG90", "M98 P1 L3").modes()));
  EXPECT_TRUE(BehindCall("G90\nG0 X5", "M98 P1 L3").starts_at(5, 1, 1));
}

TEST(CalledPrograms, LeaveUnknownWhatIsUnknownInThem) {
  EXPECT_TRUE(BehindCall("G0 X#1").starts_somewhere());
  EXPECT_TRUE(BehindCall("T5 M6").starts_somewhere());
  EXPECT_FALSE(is_known(BehindCall("G777").modes()));
  EXPECT_FALSE(is_known(BehindCall("WHILE [#1 LT 5] DO1\nG91\nEND1").modes()));
  EXPECT_FALSE(is_known(BehindCall("IF [#1 EQ 1] GOTO 5\nG90\nN5 G0 X5").modes()));
  EXPECT_FALSE(is_known(BehindCall("M98 P2").modes()));
  // Not a line for people, though nothing has moved yet.
  EXPECT_FALSE(is_known(BehindCall("WHAT THIS IS").modes()));
}

// One way goes back after G91, the other one before it.
TEST(CalledPrograms, LeaveWhatAllTheirWaysBackAgreeIn) {
  const BehindCall call("G0 X5 Y6\n/M99\nG91\nG0 X1");
  EXPECT_EQ(call.modes().distance, DistanceMode::kUnknown);
  EXPECT_EQ(call.modes().units, Units::kMillimetre);
  EXPECT_TRUE(call.starts_somewhere());
}

TEST(CalledPrograms, AreSkippedWhereTheOperatorSkipsTheCall) {
  EXPECT_EQ(BehindCall("G91", "/M98 P1").modes().distance, DistanceMode::kUnknown);
}

// Numbers with letters are values of the macro, not places and feeds.
TEST(CalledPrograms, TakeArgumentsThatAreNoWordsOfTheBlock) {
  const BehindCall call("G0 Y6", "G65 P1 X5. Z9. F5");
  EXPECT_TRUE(call.starts_at(2, 6, 1));
  EXPECT_EQ(call.modes().feed, 100);
}

TEST(CalledPrograms, AreFollowedIntoThoseThatTheyCall) {
  const ReadOptions options =
      calling({{"P1", "O1\nG0 X5\nM98 P2\nG0 Y6\nM99\n"}, {"P2", "O2\nG0 Z9\nM99\n"}});
  const tests::Interpreted it(std::string(kModesOfBefore) + "M98 P1\nG1 X50 Y50 Z50\n", options);
  const Motion* motion = it.motion_of_line(6);
  ASSERT_NE(motion, nullptr);
  EXPECT_EQ(motion->piece.start(), geometry::Point3(5, 6, 9));
}

TEST(CalledPrograms, ThatCallThemselvesEndUnknown) {
  const ReadOptions options =
      calling({{"P1", "O1\nM98 P2\nM98 P2\nM99\n"}, {"P2", "O2\nM98 P1\nM98 P1\nM99\n"}});
  const tests::Interpreted it(std::string(kModesOfBefore) + "M98 P1\nG1 X50 Y50 Z50\n", options);
  EXPECT_FALSE(is_known(it.last_state()));
}

// Else a program of some lines would take hours.
TEST(CalledPrograms, AreFollowedForSoManyBlocksOnly) {
  std::string tens;
  for (int i = 0; i < 10; ++i) tens += "M98 P2\n";
  std::vector<std::pair<std::string, std::string>> files;
  for (int k = 1; k <= 9; ++k) {
    std::string body = tens;
    for (std::size_t at = body.find("P2"); at != std::string::npos; at = body.find("P2", at + 2)) {
      body[at + 1] = static_cast<char>('1' + k);
    }
    files.emplace_back("P" + std::to_string(k), k == 9 ? "G0 X1\nM99\n" : body + "M99\n");
  }
  const tests::Interpreted it(std::string(kModesOfBefore) + "M98 P1\nG1 X50\n", calling(files));
  EXPECT_FALSE(is_known(it.last_state()));
}

TEST(CalledPrograms, MakeNoTargetsOfLabels) {
  const std::string text = std::string(kModesOfBefore) + "M98 P1\nN100 G1 X50 Y50 Z50\n";
  const tests::Interpreted known(text, calling({{"P1", "O1\nG0 X5\nM99\n"}}));
  EXPECT_FALSE(known.line(6).entered_from_elsewhere);
  const tests::Interpreted other(text + "M98 P2\n", calling({{"P1", "O1\nG0 X5\nM99\n"}}));
  EXPECT_TRUE(other.line(6).entered_from_elsewhere);
}

// The user's word goes before the file.
TEST(CalledPrograms, AreWhatTheUserSaysWhereHeSaysSomething) {
  ReadOptions options = calling({{"P1", "O1\nG0 X5\nM99\n"}});
  options.own_words = std::make_shared<const OwnWords>(
      std::vector<OwnWord>{{"M98 P1", "moves", {.keeps_modes = true, .returns = true}}});
  const tests::Interpreted it(std::string(kModesOfBefore) + "M98 P1\nG1 X50 Y50 Z50\n", options);
  EXPECT_FALSE(it.motion_of_line(6)->start_known);
}

TEST(CalledPrograms, OfOWordsBeginAtTheirSub) {
  std::string why;
  auto sub = as_subprogram("O<P>", parsed("G91\no<p> sub\nG0 X5\no<p> endsub\nG20\nM2\n"), why);
  ASSERT_TRUE(sub.has_value()) << why;
  ReadOptions options;
  std::vector<Subprogram> programs;
  programs.push_back(std::move(*sub));
  options.subprograms = std::make_shared<const Subprograms>(std::move(programs));
  const tests::Interpreted it(std::string(kModesOfBefore) + "o<p> call\nG1 X50 Y50 Z50\n", options);
  ASSERT_NE(it.motion_of_line(6), nullptr);
  EXPECT_EQ(it.motion_of_line(6)->piece.start(), geometry::Point3(5, 1, 1));
  EXPECT_TRUE(is_known(it.last_state()));
}

TEST(ProgramsWithin, AreThoseThatTheTextNames) {
  const auto names = programs_within(parsed("O1\nM98 P2\nM30\nO2\nM99\no<p> sub\no<p> endsub\n"));
  EXPECT_EQ(names, (std::vector<std::string>{"P1", "P2", "O<P>"}));
}

}  // namespace
}  // namespace batten::gcode
