// Which comments and words say how exact a part has to be, and which only look like it.
#include "gcode/interpreter/tolerance_words.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

namespace batten::gcode {
namespace {

// "0.005", "0.005 mm", "0.0002 in", "ended", "uncertain", or empty where it is about something
// else.
std::string words_for(const ToleranceWords& said) {
  switch (said.kind) {
    case ToleranceWords::Kind::kNone:
      return "";
    case ToleranceWords::Kind::kEnded:
      return "ended";
    case ToleranceWords::Kind::kUncertain:
      return "uncertain";
    case ToleranceWords::Kind::kStated:
      break;
  }
  const Units units = said.length.units;
  return fmt::format("{:g}{}", said.length.value,
                     units == Units::kMillimetre ? " mm"
                     : units == Units::kInch     ? " in"
                                                 : "");
}

struct ToleranceRow {
  const char* text;
  const char* said;
};

TEST(ToleranceComments, AreReadInTheSpellingsThatSayNothingElse) {
  const ToleranceRow rows[] = {
      {"(TOLERANCE 0.005)", "0.005"},
      {"(Tolerance: 0.01)", "0.01"},
      {"(Tolerance:0.01)", "0.01"},
      {"; tolerance = 0.02", "0.02"},
      {";TOLERANCE=.02", "0.02"},
      {"(TOL: 0.01 MM)", "0.01 mm"},
      {"(TOL .01)", "0.01"},
      {"(tol=0.0002in)", "0.0002 in"},
      {"(TOLERANCE 0.0002 INCH)", "0.0002 in"},
      {"(TOLERANCE 0.0002 INCHES)", "0.0002 in"},
      {"( TOLERANCE   :   0.02 )", "0.02"},
      {"(TOLERANCE - 0.001)", "0.001"},
      {"(CUT TOLERANCE 0.01)", "0.01"},
      {"(Cutting Tolerance = 0.01 mm)", "0.01 mm"},
      {"(MACHINING TOLERANCE: 0.01)", "0.01"},
      {"(TOTAL TOLERANCE: 0.01)", "0.01"},
      {"; TOLERANZ: 0.01", "0.01"},
      {"* - TOL 0.01", "uncertain"},  // names a step of the work
      {"(TOLERANCE 1)", "1"},
      {"(TOLERANCE 0.01", "0.01"},  // to the end of the line
  };
  for (const auto& [text, said] : rows) {
    EXPECT_EQ(words_for(tolerance_in_comment(text)), said) << text;
  }
}

TEST(ToleranceComments, AreUncertainWhereTheyNameATolerance) {
  for (const char* text : {"(TOLERANCE +/-0.1 ON DRAWING)",
                           "(TOLERANCE SEE DRAWING)",
                           "(TOLERANCE)",
                           "(TOLERANCE:)",
                           "(TOLERANCE -0.01)",
                           "(TOLERANCE +0.01)",
                           "(TOLERANCE 0)",
                           "(TOLERANCE 0.01 0.02)",
                           "(TOLERANCE 0.01 THICKNESS 0.2)",
                           "(TOLERANCE 10 UM)",
                           "(TOLERANCE 5%)",
                           "(TOLERANCE 1e-2)",
                           "(TOLERANCE 0. 01)",
                           "(TOLERANZ 0,01)",
                           "(TOLERANCE 0.01 MM.)",
                           "(INTOL 0.01 OUTTOL 0.01)",
                           "(FINISH PASS, TOLERANCE 0.01)",
                           "(BORE 10H7 TOL +0.015/0)",
                           "(TOL 0.01-0.02)",
                           "(STOCK 0.2 TOL: 0.01)",
                           "(TOLERANCE #101)"}) {
    EXPECT_EQ(words_for(tolerance_in_comment(text)), "uncertain") << text;
  }
}

TEST(ToleranceComments, AreNotTakenFromOtherText) {
  for (const char* text :
       {"(TOOL TOLERANCE H7)", "(TOLERANCES AS ON DRAWING)", "(TOL CHECK)", "(STOOL 5)",
        "(PISTOL 0.01)", "(TOLERANT 0.01)", "(Batten: smoothed within 0.01 mm)",
        "; Batten: smoothed within 0.01 mm", "(T1 D=6. CR=0. - ZMIN=-1. - FLAT END MILL)", "()",
        ";", "(SMOOTHING 0.01)", "(STOCK TO LEAVE 0.2)", "(TOLEDO 7)"}) {
    EXPECT_EQ(words_for(tolerance_in_comment(text)), "") << text;
  }
}

TEST(Cycle832, SaysATolerance) {
  const ToleranceRow rows[] = {
      {"CYCLE832(0.01,_FINISH,1)", "0.01 mm"},
      {"N100 CYCLE832(0.02, _ROUGH, 1) ; roughing", "0.02 mm"},
      {"cycle832(.05)", "0.05 mm"},
      {"CYCLE832 (0.05, 102001)", "0.05 mm"},
      {"CYCLE832(0.1,3,1)", "0.1 mm"},
      {"CYCLE832()", "ended"},
      {"CYCLE832", "ended"},
      {"CYCLE832(0,_OFF,1)", "ended"},
      {"CYCLE832(0)", "ended"},
      {"CYCLE832(0.01,_OFF,1)", "ended"},
      {"CYCLE832(_camtolerance,0,1)", "uncertain"},
      {"CYCLE832(R1,_FINISH,1)", "uncertain"},
      {"CYCLE832(-0.01,_FINISH,1)", "uncertain"},
      {"CYCLE832(,_FINISH,1)", "uncertain"},
      {"CYCLE832(0.01", "uncertain"},
      {"CYCLE800()", ""},
      {"MYCYCLE832(0.01)", ""},
      {"CYCLE8321(0.01)", ""},
      {"G1 X1 ; CYCLE832(0.01)", ""},
  };
  for (const auto& [text, said] : rows) {
    EXPECT_EQ(words_for(tolerance_in_cycle832(text)), said) << text;
  }
}

TEST(Cycle32, SaysATolerance) {
  const ToleranceRow rows[] = {
      {"CYCL DEF 32.0 TOLERANZ", ""},
      {"CYCL DEF 32.1 T0.05", "0.05 mm"},
      {"CYCL DEF 32.1 T0,05", "0.05 mm"},
      {"cycl def 32.1 t+0.05", "0.05 mm"},
      {"CYCL DEF 32.1 T 0.05", "0.05 mm"},
      {"CYCL DEF 32.1", "ended"},
      {"CYCL DEF 32.1 T", "ended"},
      {"CYCL DEF 32.1 TQ5", "uncertain"},
      {"CYCL DEF 32.1 T0", "uncertain"},
      {"CYCL DEF 32.1 Q5", "uncertain"},
      {"CYCL DEF 32.2 HSC-MODE:0 TA0.5", ""},
      {"CYCL DEF 9.1 DWELL 1.5", ""},
      {"L X+1", ""},
  };
  for (const auto& [text, said] : rows) {
    EXPECT_EQ(words_for(tolerance_in_cycle32(text)), said) << text;
  }
}

}  // namespace
}  // namespace batten::gcode
