#include "tests/support/klartext_arc_alarms.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/curve_texts.h"

namespace batten::gcode {
namespace {

TEST(KlartextArcAlarms, AreGivenForArcsThatAreNone) {
  const std::string text =
      "1 L X+0 Y+0\n"
      "2 C X+1 Y+1 DR+\n"
      "3 CC X+5 Y+0\n"
      "4 C X+10 Y+0.5\n"
      "5 L X+0 Y+0\n"
      "6 C X+10.015 Y+0 DR+\n"
      "7 L X+0 Y+0\n"
      "8 C X+10.017 Y+0 DR+\n"
      "9 L X+100000\n";
  EXPECT_EQ(
      curve_tests::short_forms(klartext_arc_alarms(curve_tests::parsed(text), Units::kMillimetre)),
      (std::vector<std::string>{"2 arc-no-centre", "4 arc-no-sense", "4 arc-radius", "8 arc-radius",
                                "9 place-range"}));
}

}  // namespace
}  // namespace batten::gcode
