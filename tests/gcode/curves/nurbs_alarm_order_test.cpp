// nurbs_alarms promises the order of the lines, also where a curve's knots are judged at its end.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gcode/curves/nurbs.h"
#include "gcode/reading/parser.h"
#include "tests/support/nurbs_alarms.h"

namespace batten::gcode {
namespace {

TEST(NurbsAlarmOrder, IsThatOfTheLinesThoughKnotsAreJudgedAtTheEnd) {
  // Nine points and thirteen knots: the last four differ (line 14, where the curve ends), and K0
  // stands four times and once more in line 6.
  const std::string text =
      "G01 X0. Y0. Z0. F3000.\n"
      "G06.2 P4 K0. X0. Y0. Z0.\n"
      "K0. X10.\n"
      "K0. X20.\n"
      "K0. X30.\n"
      "K0. X40.\n"
      "K50. X50.\n"
      "K60. X60.\n"
      "K70. X70.\n"
      "K80. X80.\n"
      "K100.\nK100.\nK100.\nK110.\n"
      "G01 X90.\n";
  Diagnostics found;
  const Program program = parse(SourceText("test.nc", text), found);
  const CurveAlarms alarms = nurbs_alarms(program, fanuc_nurbs(Units::kMillimetre));
  ASSERT_GE(alarms.size(), 2u);
  for (std::size_t i = 1; i < alarms.size(); ++i) {
    EXPECT_LE(alarms[i - 1].line, alarms[i].line) << alarms[i - 1].id << " " << alarms[i].id;
  }
  EXPECT_EQ(alarms.front().line, 6U);
  EXPECT_EQ(alarms.front().id, "PS1008");
}

}  // namespace
}  // namespace batten::gcode
