#include "gcode/rs274/lexer.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace batten::gcode {
namespace {

// A token for people: its kind and its bytes.
std::string said(const Token& token, const std::string& line) {
  const std::string kind = token.unclosed ? "open " : "";
  return kind + std::array{"",         "value ",      "corner ", "comment ", "line comment ",
                           "delete ",  "sum ",        "set ",    "program ", "flow ",
                           "foreign ", "unreadable ", "end"}[static_cast<std::size_t>(token.kind)] +
         line.substr(token.span.begin, token.span.size());
}

using Said = std::vector<std::string>;

Said tokens_of(const std::string& line) {
  LineLexer lexer(line, SourceSpan{0, static_cast<std::uint32_t>(line.size())});
  Said all;
  for (;;) {
    const Token& token = lexer.next();
    if (token.kind == TokenKind::kEnd) {
      return all;
    }
    all.push_back(said(token, line));
  }
}

struct SplitCase {
  std::string line;
  Said tokens;
};

const SplitCase kSplitWordsRows[] = {

    // Words
    {"G1X1Y2F3", {"G1", "X1", "Y2", "F3"}},
    {"N120 G1 X10", {"N120", "G1", "X10"}},
    {"X  0.0238", {"X  0.0238"}},
    {"G0X +0. 12 34Y 7", {"G0", "X +0. 12 34", "Y 7"}},
    {"G1\tX\t1", {"G1", "X\t1"}},
    {"g1 x.5 y5. z+3", {"g1", "x.5", "y5.", "z+3"}},
    {"X-.5Y-5.", {"X-.5", "Y-5."}},
    {"G90.1G61.1", {"G90.1", "G61.1"}},
    {"G1 X1 E3", {"G1", "X1", "E3"}},
    {"E.5X1", {"E.5", "X1"}},
    {"G1 X Y2", {"G1", "unreadable X Y2"}},
    {"G1 X", {"G1", "unreadable X"}},
    {"X--5", {"unreadable X--5"}},
    {"X- Y1", {"unreadable X- Y1"}},
    {"X. Y1", {"unreadable X. Y1"}},
    {"X1.2.3", {"X1.2", "unreadable .3"}},
    {"G1 X1E3", {"G1", "unreadable E3"}},
    {"X1.5e-3", {"unreadable e-3"}},
    {"X" + std::string(400, '9'), {"unreadable X" + std::string(400, '9')}},
    {"X-1000000000", {"unreadable X-1000000000"}},
    {"X999999999.9", {"X999999999.9"}},
    {"G1 \xC3\xA9", {"G1", "unreadable \xC3\xA9"}},
    {"G1 \x18", {"G1", "unreadable \x18"}},
    // Comments
    {"G1 X1 (c) Y2 ; d", {"G1", "X1", "comment (c)", "Y2", "line comment ; d"}},
    {"(a)(b)", {"comment (a)", "comment (b)"}},
    {"; a (b", {"line comment ; a (b"}},
    {"(a ; b) X1", {"comment (a ; b)", "X1"}},
    {"(50 % of %)", {"comment (50 % of %)"}},
    {"(\xC3\xA9\xFF) X1", {"comment (\xC3\xA9\xFF)", "X1"}},
    {"X1 (c Y2", {"X1", "open comment (c Y2"}},
    {"X1 (a (b) c)", {"X1", "comment (a (b) c)"}},
    {"(a (b)  ", {"comment (a (b)  "}},
    // For a control that ends comments at the first bracket these say something else.
    {"(a (b) c) X1", {"unreadable (a (b) c) X1"}},
    {"(a (b) X1", {"unreadable (a (b) X1"}},
    {"X1 ) Y1", {"X1", "unreadable ) Y1"}},
    // Signs
    {"/G1", {"delete /", "G1"}},
    {"/2 G1", {"delete /2", "G1"}},
    {"/12 G1", {"unreadable /12 G1"}},
    {"N5 G1*71 ", {"N5", "G1", "sum *71"}},
    {"N5*71 G1", {"N5", "unreadable *71 G1"}},
    {"N5*1234", {"N5", "unreadable *1234"}},
    {"X1,R2", {"X1", "corner ,R2"}},
    {"X1 , c -.5 Y2", {"X1", "corner , c -.5", "Y2"}},
    {",A#1", {"corner ,A#1"}},
    {"X1,R", {"X1", "unreadable ,R"}},
    {"G61.1 ,K50", {"G61.1", "corner ,K50"}},
    {",L5", {"unreadable ,L5"}},
    // Okuma: offsets of the tool in the spindle
    {"G56 HA Z5", {"G56", "value HA", "Z5"}},
    {"G41 db", {"G41", "value db"}},
    {"HA", {"foreign HA"}},
    {"G56 HALT", {"G56", "foreign HALT"}},
    {"G56 HD", {"G56", "foreign HD"}},
    {"X1,", {"X1", "unreadable ,"}},
    // Values
    {"X[#1+2]Y3", {"value X[#1+2]", "Y3"}},
    {"X [1+[2*#3]] Y1", {"value X [1+[2*#3]]", "Y1"}},
    {"X#5Y1", {"value X#5", "Y1"}},
    {"X#<a b>Y1", {"value X#<a b>", "Y1"}},
    {"X##1", {"value X##1"}},
    {"X#[1+2]", {"value X#[1+2]"}},
    {"Z-#3 Y-[2]", {"value Z-#3", "value Y-[2]"}},
    {"XSIN[30]Y cos[#1]", {"value XSIN[30]", "value Y cos[#1]"}},
    {"X[1+2", {"unreadable X[1+2"}},
    {"X#<a Y1", {"unreadable X#<a Y1"}},
    {"X#Y", {"unreadable X#Y"}},
    {"X[1(c)]", {"unreadable X[1(c)]"}},
    {"X#-1", {"unreadable X#-1"}},
    {"XFIXED[#1]", {"foreign XFIXED[#1]"}},
    {"#1=5", {"set #1=5"}},
    {"#<a> = #1", {"set #<a> = #1"}},
    {"#1=#2 #3=[#4+1](c)", {"set #1=#2", "set #3=[#4+1]", "comment (c)"}},
    {"#1=#2+3*SIN[#4]**2-ATAN[1]/[2] MOD 3", {"set #1=#2+3*SIN[#4]**2-ATAN[1]/[2] MOD 3"}},
    {"#1=2*-#3", {"set #1=2*-#3"}},
    {"#1=5 X3", {"set #1=5", "X3"}},
    {"#1=", {"unreadable #1="}},
    {"#1=2+", {"unreadable #1=2+"}},
    {"R1=5 R2=R1+3 r3=-R[2]", {"set R1=5", "set R2=R1+3", "set r3=-R[2]"}},
    {"#5", {"unreadable #5"}},
    // Other languages
    {"O1000 (part)", {"program O1000", "comment (part)"}},
    {":1000", {"program :1000"}},
    {"G1 :1000", {"flow G1 :1000"}},
    {"o100 sub", {"flow o100 sub"}},
    {"o<x> call [1]", {"flow o<x> call [1]"}},
    {"O1000 G21", {"flow O1000 G21"}},
    {"N10 IF[#1EQ2]GOTO50", {"N10", "flow IF[#1EQ2]GOTO50"}},
    {"while [#1LT3] do1", {"flow while [#1LT3] do1"}},
    {"END1", {"flow END1"}},
    {"GOTO100", {"flow GOTO100"}},
    {"LOOP_A: G1 X1", {"flow LOOP_A: G1 X1"}},
    {"N10:", {"flow N10:"}},
    {"N5 DEF REAL A", {"N5", "foreign DEF REAL A"}},
    {"G1 XY5", {"G1", "foreign XY5"}},
    {"X=10", {"foreign X=10"}},
    {"G1 X1=10", {"G1", "foreign X1=10"}},
    {"\"G1 (X\"", {"foreign \"G1 (X\""}},
    {"T=\"A;B\"", {"foreign T=\"A;B\""}},
    {"$100=80", {"foreign $100=80"}},
    {"{\"a\":1}", {"foreign {\"a\":1}"}},
    {"!transBSpline(1)", {"foreign !transBSpline(1)"}},
    {"#SPLINE ON", {"foreign #SPLINE ON"}},
    {"G0 @1 ^30", {"G0", "foreign @1 ^30"}},
    {"<x>", {"foreign <x>"}},
    {"12 L X+1 R0 F500 M3", {"foreign 12 L X+1 R0 F500 M3"}},
    {"* - part", {"foreign * - part"}},
    {"G1 (c) 5", {"G1", "comment (c)", "unreadable 5"}}};

TEST(SplitWords, AsControlsDo) {
  for (const SplitCase& test : kSplitWordsRows) {
    SCOPED_TRACE(test.line);
    EXPECT_EQ(tokens_of(test.line), test.tokens);
  }
}

TEST(LineLexer, SeesNothingOutsideItsLine) {
  const std::string text = "X1\n5(a\n)";
  LineLexer first(text, SourceSpan{0, 2});
  EXPECT_EQ(first.next().number.value, 1);  // not 15
  EXPECT_EQ(first.next().kind, TokenKind::kEnd);
  EXPECT_EQ(first.next().kind, TokenKind::kEnd);
  LineLexer second(text, SourceSpan{4, 6});
  EXPECT_TRUE(second.next().unclosed);
}

TEST(ActiveComment, IsKnownByItsFirstWord) {
  for (const char* active :
       {"(MSG,hello)", "( m s g , hello)", "(debug,#1)", "(PRINT, x)", "(LOG,x)", "(LOGOPEN,f)",
        "(logappend,f)", "(LOGCLOSE)", "(PROBEOPEN f.txt)", "(PROBECLOSE)", "(py,x=1)", ";py,x=1",
        "(ABORT,x)", "(\tMSG,", "(AXIS,hide)"}) {
    EXPECT_TRUE(is_active_comment(active)) << active;
  }
  for (const char* text : {"(print this first)", "(message)", "(MSG)", "(log of changes)", "()",
                           "(", ";", "; msg", "(a MSG, b)", "(probe)", "(debug)"}) {
    EXPECT_FALSE(is_active_comment(text)) << text;
  }
}

}  // namespace
}  // namespace batten::gcode
