// What does not read as plain words, language by language: copied byte for byte, what it could have
// changed unknown behind it, its reason in the report, smoothed in front of it and behind.
#include <gtest/gtest.h>

#include "tests/support/constructs.h"

namespace batten::postproc {
namespace {

constexpr const char* kLinuxCnc = "linuxcnc";
constexpr const char* kGrbl = "grbl";
constexpr const char* kFanuc = "fanuc";
constexpr const char* kSiemens = "siemens";
constexpr const char* kHeidenhain = "heidenhain";

void expect_kept(const std::vector<Construct>& constructs) {
  for (const Construct& construct : constructs) {
    SCOPED_TRACE(testing::Message() << construct.name << " " << construct.target);
    expect_kept_construct(construct);
  }
}

// Constructs after which nothing is known.
Construct opaque(const char* name, const char* target, std::string text, std::string reason) {
  return {name, target, std::move(text), std::move(reason), false, "state-unknown"};
}

TEST(LexingTable, Comments) {
  expect_kept(
      {{"Parenthesis", kLinuxCnc, "(text)"},
       {"Parenthesis", kFanuc, "(TEXT)"},
       {"NestedAtTheEnd", kLinuxCnc, "(text (inner) text)"},
       opaque("NestedBeforeWords", kLinuxCnc, "(text (inner) text) G1 X31.", "not-understood"),
       {"Unclosed", kGrbl, "(text"},
       {"Semicolon", kLinuxCnc, "; G1 X99"},
       {"Semicolon", kSiemens, "; G1 X99"},
       {"Semicolon", kHeidenhain, "; L X+99"},
       {"Structure", kHeidenhain, "* - PART ONE"},
       opaque("Parenthesis", kSiemens, "(text)", "not-understood"),
       {"Message", kLinuxCnc, "(MSG, text)", "active-comment"},
       {"Debug", kLinuxCnc, "(DEBUG, #1)", "active-comment"},
       {"Print", kLinuxCnc, "(print,text)", "active-comment"},
       {"Log", kLinuxCnc, "(LOG,text)", "active-comment"},
       {"ProbeOpen", kLinuxCnc, "(PROBEOPEN points.txt)", "active-comment"},
       {"Message", kSiemens, "MSG(\"G1 X5 ; no comment\")", "state-change"}});
}

TEST(LexingTable, Programs) {
  expect_kept({opaque("ProgramNumber", kFanuc, "O2000", "program-flow"),
               {"SecondProgram", kSiemens, "%_N_NEXT_SPF", "program-mark", false, "program-mark"},
               {"Sub", kLinuxCnc, "o100 sub\no100 endsub", "program-flow"},
               opaque("OpenSub", kLinuxCnc, "o100 sub", "program-flow"),
               opaque("NamedCall", kLinuxCnc, "o<name> call [1] [2]", "subprogram"),
               opaque("If", kLinuxCnc, "o101 if [#1 GT 2]\no101 endif", "program-flow"),
               opaque("While", kLinuxCnc, "o102 while [#1 LT 2]\no102 endwhile", "program-flow"),
               opaque("Call", kFanuc, "M98 P1000", "subprogram"),
               opaque("Subprogram", kSiemens, "L100 P3", "foreign-words"),
               opaque("OwnCycle", kSiemens, "MY_CYCLE(1,2)", "foreign-words"),
               opaque("Program", kHeidenhain, "CALL PGM OTHER", "subprogram"),
               {"Number", kLinuxCnc, "N500"},
               {"Number", kSiemens, "N500"}});
}

// A call, and the tool back in front of the next wave.
Construct call(const char* name, const char* target, const std::string& text) {
  const std::string back = std::string(target) == kHeidenhain
                               ? "\nL X+30 Y+0 Z+5 R0 FMAX\nL Z-1 F300"
                               : "\nG0 X30. Y0. Z5.\nG1 Z-1. F300.";
  return {name, target, text + back, "subprogram", true, {}, {}, "subprogram"};
}

TEST(LexingTable, CallsThatKeepModes) {
  expect_kept({call("Named", kLinuxCnc, "o<do_it> call [1] [2]"),
               call("Numbered", kLinuxCnc, "o100 call"), call("Call", kFanuc, "M98 P1000 L3"),
               call("Macro", kFanuc, "G65 P9010 A1."), call("Local", "haas", "M97 P700"),
               call("Program", kHeidenhain, "CALL PGM OTHER")});
}

TEST(LexingTable, Skipping) {
  expect_kept({{"OfAMove", kLinuxCnc, "/G1 X31.", "block-delete"},
               {"OfAMove", kFanuc, "/2 G1 X31.", "block-delete"},
               {"OfAMove", kSiemens, "/3 G1 X31", "block-delete"},
               {"OfAMove", kHeidenhain, "/ L X+31", "block-delete"},
               {"OfAMode", kFanuc, "/G91", "block-delete", false, "state-unknown"},
               {"OfAMode", kSiemens, "/G91", "block-delete", false, "state-unknown"},
               {"OfUnits", kFanuc, "/G20", "block-delete", false, "units-unknown"}});
}

TEST(LexingTable, Values) {
  expect_kept(
      {{"Expression", kLinuxCnc, "G1 X[#1+2] Y0", "expression"},
       {"Parameter", kFanuc, "G1 X#5 Y0", "expression"},
       {"Function", kLinuxCnc, "G1 XSIN[30]", "expression"},
       {"Expression", kSiemens, "G1 X=R1*2+SIN(R3)", "expression"},
       {"Variable", kSiemens, "DEF REAL _DEPTH=5\n_DEPTH=R1*2\nG1 Z=_DEPTH", "foreign-words"},
       {"Absolute", kSiemens, "G1 X=AC(31)", "expression"},
       {"Increment", kSiemens, "G1 X=IC(1)", "expression"},
       {"Parameter", kHeidenhain, "L X+Q1", "expression"},
       {"Set", kFanuc, "#100=5", "parameter-assignment"},
       {"SetByName", kLinuxCnc, "#<_depth>=[#1*2]", "parameter-assignment"},
       {"SystemVariable", kFanuc, "#5221=5", "parameter-assignment"},
       {"Set", kSiemens, "R1=5 R2=R1*3", "parameter-assignment"},
       {"SetByIndex", kSiemens, "R[5]=3", "parameter-assignment"},
       {"Set", kHeidenhain, "Q1 = +5", "parameter-assignment"},
       {"SetByFn", kHeidenhain, "FN 0: Q1 =+5", "parameter-assignment"},
       opaque("SystemVariable", kSiemens, "$P_UIFR[1]=CTRANS(X,5)", "foreign-words"),
       opaque("UndeclaredVariable", kSiemens, "_NOBODY_SAID=5", "foreign-words")});
}

TEST(LexingTable, Jumps) {
  expect_kept(
      {{"Conditional", kFanuc, "IF [#1 GT 2] GOTO 900", "program-flow"},
       opaque("Loop", kFanuc, "WHILE [#1 LT 2] DO1\nEND1", "program-flow"),
       opaque("Macro", kFanuc, "G65 P9010 A1.", "subprogram"),
       opaque("ModalMacro", kFanuc, "G66 P9010", "modal-macro"),
       {"Conditional", kSiemens, "IF R1>5 GOTOF LATER\nLATER:", "program-flow", false,
        "state-unknown"},
       {"LabelThatNobodyNames", kSiemens, "START_OF_IT:", "program-flow"},
       {"LabelBeforeWords", kSiemens, "START_OF_IT: G1 X31 Y0", "program-flow"},
       {"MainBlock", kSiemens, ":100 G90 G17", "program-flow"},
       opaque("Repeat", kSiemens, "REPEAT START P=3", "program-flow"),
       opaque("Branch", kSiemens, "IF R1==2\nR3=1\nENDIF", "program-flow"),
       opaque("Loop", kSiemens, "WHILE R1<2\nR1=R1+1\nENDWHILE", "program-flow"),
       {"Case", kSiemens, "CASE R1 OF 1 GOTOF FAR 2 GOTOF FAR DEFAULT GOTOF FAR", "program-flow"},
       {"Fn", kHeidenhain, "FN 9: IF +Q1 EQU +1 GOTO LBL 99", "program-flow"},
       {"Label", kHeidenhain, "LBL 77", "program-flow"},
       opaque("Call", kHeidenhain, "CALL LBL 99", "subprogram")});
}

TEST(LexingTable, Spelling) {
  expect_kept({{"NoBlanks", kLinuxCnc, "G1X30.Y1.F1500."},
               {"SmallLetters", kLinuxCnc, "g1 x30. y1."},
               {"Points", kLinuxCnc, "X.5 Y5."},
               {"Zeros", kFanuc, "G01 X030.50 Y+1.0"},
               {"NoBlanks", kSiemens, "G1X30Y1F1500"},
               {"Equals", kSiemens, "G1 X=30 Y = 1"},
               {"Comma", kHeidenhain, "L X+30,5 Y+1"},
               opaque("Exponent", kLinuxCnc, "X1E3", "not-understood"),
               opaque("Exponent", kSiemens, "X1EX3", "not-understood"),
               opaque("Checksum", kLinuxCnc, "N5 G1 X31.*71", "not-understood"),
               {"ChecksumThatFits", "reprapfirmware", "N5 G1 X31.*121", "checksum"},
               {"Rounding", kFanuc, "G1 X31. ,R2.", "corner-word"},
               {"Chamfer", kFanuc, "G1 X31. ,C1.", "corner-word"},
               {"Angle", kFanuc, "G1 X31. ,A45.", "corner-word"},
               {"RoundingByR", kFanuc, "G1 X31. R2.", "corner-word"},
               {"Rounding", kSiemens, "G1 X31 RND=2", "not-understood"},
               {"Chamfer", kSiemens, "G1 X31 CHF=1", "not-understood"},
               {"Angle", kSiemens, "G1 X31 ANG=45", "not-understood"},
               {"Rounding", kHeidenhain, "RND R2", "foreign-words"},
               {"Chamfer", kHeidenhain, "CHF 2", "foreign-words"}});
}

TEST(LexingTable, OtherLanguages) {
  expect_kept({opaque("String", kLinuxCnc, "M98 \"part.nc\"", "foreign-words"),
               {"ToolByName", kSiemens, "T=\"MILL 6 ; X1\"", "expression"},
               {"ToolByName", kHeidenhain, "TOOL CALL \"MILL 6\" Z S5000", "tool-change"},
               opaque("Assigned", kLinuxCnc, "X=10", "foreign-words"),
               opaque("SiemensCycle", kLinuxCnc, "CYCLE832(0.01)", "foreign-words"),
               opaque("Klartext", kLinuxCnc, "L X+1 R0 FMAX", "not-understood"),
               opaque("Bang", kLinuxCnc, "!transBSpline(BreakAngle:=5)", "foreign-words"),
               {"Dollar", kGrbl, "$H", "foreign-words"},
               opaque("Json", "g2core", "{\"xvm\":1000}", "foreign-words"),
               opaque("Host", "reprapfirmware", "@pause", "foreign-words"),
               opaque("Xml", kLinuxCnc, "<part>", "foreign-words"),
               opaque("Hold", kGrbl, "!", "foreign-words"),
               opaque("Resume", kGrbl, "~", "foreign-words"),
               opaque("StatusReport", kGrbl, "?", "foreign-words"),
               opaque("Reset", kGrbl, "\x18", "not-understood"),
               opaque("Statement", kHeidenhain, "WHATEVER 1 2", "not-understood")});
}

// An N number that a jump names stays, and what the jump brings along is not known.
TEST(LexingTableLabels, ThatAreNamedAreNeitherDroppedNorPassedOver) {
  for (const char* jump : {"IF [#1 GT 2] GOTO 500", "GOTO 500"}) {
    SCOPED_TRACE(jump);
    const std::string before = head_of(gcode::Language::kRs274) + jump + "\n" +
                               wave_part(gcode::Language::kRs274, 0) + "N500 X31. Y1.\n" +
                               wave_part(gcode::Language::kRs274, 1) +
                               tail_of(gcode::Language::kRs274);
    const SmoothResult result = smoothed(before, options_for(kFanuc));
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(reason_at(inspected(before, options_for(kFanuc)), 6 + kWaveLines), "state-unknown");
    EXPECT_TRUE(is_rewritten_within(result, 6, 5 + kWaveLines));
    EXPECT_FALSE(is_rewritten_within(result, 6 + kWaveLines, 500));
    expect_rest_copied(before, result);
  }
}

// M99 P500 in a program that is not read comes back to N500.
TEST(LexingTableLabels, MayBeNamedByAProgramThatIsCalled) {
  const auto language = gcode::Language::kRs274;
  const std::string before = head_of(language) + wave_part(language, 0) + "N500 " +
                             wave_part(language, 1) + "M98 P2000\n" + tail_of(language);
  SmoothOptions options = options_for(kFanuc);
  const SmoothResult kept = smoothed(before, options);
  EXPECT_TRUE(kept.proved);
  EXPECT_TRUE(is_rewritten_within(kept, 1, 4 + kWaveLines));
  EXPECT_FALSE(is_rewritten_within(kept, 5 + kWaveLines, 500));
  EXPECT_NE(kept.text.find("N500 G1 X30.300"), std::string::npos);
  expect_rest_copied(before, kept);

  options.allowed = {"subprogram"};
  const SmoothResult allowed = smoothed(before, options);
  EXPECT_TRUE(allowed.proved);
  EXPECT_TRUE(is_rewritten_within(allowed, 1, 500));
  EXPECT_EQ(allowed.text.find("N500"), std::string::npos);
}

TEST(LexingTableLabels, OfSiemensAreLikewise) {
  const auto language = gcode::Language::kSiemens;
  for (const std::string label : {"N500", "LATER:", ":500"}) {
    SCOPED_TRACE(label);
    const std::string name = label == "LATER:" ? "LATER" : label;
    const std::string before = head_of(language) + "IF R1==2 GOTOF " + name + "\n" +
                               wave_part(language, 0) + label + " G1 X31 Y1\n" +
                               wave_part(language, 1) + tail_of(language);
    const SmoothResult result = smoothed(before, options_for(kSiemens));
    EXPECT_TRUE(result.proved);
    EXPECT_TRUE(is_rewritten_within(result, 7, 6 + kWaveLines));
    EXPECT_FALSE(is_rewritten_within(result, 7 + kWaveLines, 500));
    expect_rest_copied(before, result);
  }
}

// Marks, fillings and line ends of old files are bytes like others.
TEST(LexingTableEncodings, AreKeptByteForByte) {
  const std::string plain = head_of(gcode::Language::kRs274) +
                            wave_part(gcode::Language::kRs274, 0) +
                            tail_of(gcode::Language::kRs274);
  const auto with_ends = [&plain](const std::string& end) {
    std::string text;
    for (const std::string& line : lines_of(plain)) text += line + end;
    return text;
  };
  const std::string texts[] = {
      "\xEF\xBB\xBF" + plain,
      with_ends("\r\n"),
      with_ends("\r\r\n"),
      with_ends("\n\r"),
      std::string(40, '\0') + "\n" + plain,
      std::string(20, '\0') + "\n%\n" + plain + "%\n" + std::string(9, '\0'),
      plain + "\x1A",
      "%\r\n" + with_ends("\r\n") + "%\r\n\x1A"};
  for (const std::string& text : texts) {
    SCOPED_TRACE(testing::Message() << "text " << (&text - texts));
    const SmoothResult result = smoothed(text, options_for(kLinuxCnc));
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(rewritten_runs(result), 1U);
    const std::size_t head = text.find("G1 Z-1.");
    EXPECT_EQ(result.text.substr(0, head), text.substr(0, head));
    const std::string tail = text.substr(text.find("G0 Z5.", head));
    EXPECT_TRUE(result.text.ends_with(tail));
  }
}

// LinuxCNC leaves out a CR that no LF follows, wherever it stands; grbl ends a line there. What is
// written reads the same for both, and what does not is copied.
TEST(LexingTableEncodings, NewLinesEndAsEveryControlReadsThem) {
  const auto has_lone_return = [](std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \r");
    const std::size_t last = line.find_last_not_of(" \r");
    return first != std::string_view::npos &&
           line.substr(first, last - first).find('\r') != std::string_view::npos;
  };
  for (const std::string end : {"\n", "\r\n", "\r\r\n", "\r\r\r\n", "\n\r", "\n\r\r", "\r\n\r"}) {
    SCOPED_TRACE(testing::PrintToString(end));
    for (const char* target : {kLinuxCnc, kGrbl, kFanuc}) {
      const std::string before = wave_program({.line_end = end});
      const SmoothResult result = smoothed(before, options_for(target));
      EXPECT_TRUE(result.proved);
      EXPECT_EQ(rewritten_runs(result), 1U);
      for (const std::string& line : lines_of(result.text)) EXPECT_FALSE(has_lone_return(line));
    }
  }
}

TEST(LexingTableEncodings, LinesThatControlsReadInTwoWaysAreCopied) {
  const std::string wave = wave_program();
  const std::size_t middle = wave.find('\n', wave.size() / 2);
  const auto with = [&](std::size_t at, std::size_t count, const std::string& what) {
    return std::string(wave).replace(at, count, what);
  };
  std::string returns = wave;
  std::ranges::replace(returns, '\n', '\r');
  const std::string nul(1, '\0');
  const std::string texts[] = {returns,
                               returns + "\n",
                               with(middle, 1, "\r"),
                               with(middle, 1, nul + "\n"),
                               with(middle, 1, "\n" + nul),
                               with(0, 0, std::string(40, '\0'))};
  for (const std::string& text : texts) {
    SCOPED_TRACE(testing::Message() << "text " << (&text - texts));
    const SmoothResult result = smoothed(text, options_for(kLinuxCnc));
    EXPECT_TRUE(result.proved);
    EXPECT_TRUE(std::ranges::any_of(result.diagnostics, [](const gcode::Diagnostic& told) {
      return told.id == "unreadable-block" && !told.message.empty();
    }));
    const std::size_t copied = &text - texts < 2 ? 0 : text.find_first_of(std::string("\0\r", 2));
    EXPECT_EQ(text.substr(copied), result.text.substr(result.text.size() - (text.size() - copied)));
  }
}

// A sender would act on these wherever they stand.
TEST(LexingTableRealTime, CharactersAreNeverWritten) {
  for (const char* target : {"grbl", "grblhal", "fluidnc"}) {
    const std::string before = wave_program();
    const std::string after = smoothed(before, options_for(target)).text;
    EXPECT_NE(after, before);
    EXPECT_EQ(after.find_first_of("!~?\x18"), std::string::npos) << target;
  }
}

}  // namespace
}  // namespace batten::postproc
