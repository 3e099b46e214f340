#include "gcode/control/control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include "gcode/controls/arc_rules.h"
#include "gcode/state/modal_state.h"
#include "tests/support/control_arcs.h"
#include "tests/support/places.h"

namespace batten::gcode {
namespace {

namespace fs = std::filesystem;

using geometry::Arc;
using geometry::Point3;
using geometry::Vector3;

// From (radius, 0) by `sweep` about the origin; the end lies `mismatch` farther out.
Arc arc_with(double radius, double sweep, double mismatch) {
  const double end_radius = radius + mismatch;
  return {Point3(radius, 0, 0),
          Point3(end_radius * std::cos(sweep), end_radius * std::sin(sweep), 0), Point3::Zero(),
          Vector3::UnitZ(), sweep};
}

TEST(Controls, HaveDifferentNamesAndAreFoundByThem) {
  std::set<std::string_view> names;
  for (const Control& each : controls()) {
    EXPECT_TRUE(names.insert(each.name).second) << each.name;
    EXPECT_EQ(find_control(each.name), &each);
    EXPECT_FALSE(each.description.empty());
    EXPECT_FALSE(each.machine.empty());
  }
  EXPECT_EQ(find_control("no such control"), nullptr);
  EXPECT_EQ(find_control(""), nullptr);
}

TEST(Controls, PrintInchesAtLeastAboutAsFinelyAsMillimetres) {
  for (const Control& each : controls()) {
    SCOPED_TRACE(each.name);
    // One decimal more is a step 2.54 times as wide.
    EXPECT_LE(printed_step(place_format(each, Units::kInch), Units::kInch),
              2.6 * printed_step(place_format(each, Units::kMillimetre), Units::kMillimetre));
    EXPECT_LE(arc_end_format(each, Units::kInch).decimals, 9);
    EXPECT_GE(arc_end_format(each, Units::kInch).decimals,
              place_format(each, Units::kInch).decimals);
  }
}

TEST(Controls, StepOfAFormatIsItsLastDecimal) {
  EXPECT_DOUBLE_EQ(printed_step({.decimals = 3}, Units::kMillimetre), 0.001);
  EXPECT_DOUBLE_EQ(printed_step({.decimals = 4}, Units::kInch), 0.00254);
  EXPECT_DOUBLE_EQ(printed_step({.decimals = 0}, Units::kMillimetre), 1);
}

TEST(Controls, UnknownUnitsHaveNoSize) {
  EXPECT_THROW((void)millimetres_per(Units::kUnknown), std::invalid_argument);
}

// --- which arcs are taken ---------------------------------------------------------------------

struct ArcCase {
  std::string name;
  std::string control;
  double radius;
  double sweep_deg;
  double mismatch;  // mm
  bool taken;
};

const ArcCase kArcRows[] = {
    // grbl: refused above 0.005 mm, if also above 0.1 % of the radius or above 0.5 mm
    {"GrblExact", "grbl", 10, 90, 0, true},
    {"GrblJustBelow5Micrometres", "grbl", 1, 90, 0.0049, true},
    {"GrblAbove5MicrometresAndAbove0_1Percent", "grbl", 1, 90, 0.0055, false},
    {"GrblAbove5MicrometresBelow0_1Percent", "grbl", 10, 90, 0.0090, true},
    {"GrblAbove0_1Percent", "grbl", 10, 90, 0.0110, false},
    {"GrblInwards", "grbl", 10, 90, -0.0110, false},
    {"GrblAboveHalfAMillimetre", "grbl", 900, 90, 0.51, false},
    {"GrblBelowHalfAMillimetre", "grbl", 900, 90, 0.49, true},
    {"GrblTooTight", "grbl", 0.09, 90, 0, false},
    {"GrblTightest", "grbl", 0.11, 90, 0, true},
    {"GrblTooShort", "grbl", 10, 0.45, 0, false},
    {"GrblShortest", "grbl", 10, 0.55, 0, true},
    {"GrblNearlyAFullTurn", "grbl", 10, 355, 0, false},
    {"GrblLongest", "grbl", 10, 345, 0, true},
    {"GrblClockwise", "grbl", 10, -90, 0, true},
    // LinuxCNC: 0.0283 mm, or 0.1 % of the radius up to 2.83 mm
    // and a least radius of 0.05 mm, ours
    {"LinuxcncTooTight", "linuxcnc", 0.0499, 90, 0, false},
    {"LinuxcncOfMicrometres", "linuxcnc", 0.00015, 90, 0, false},
    {"LinuxcncTightest", "linuxcnc", 0.05, 90, 0, true},
    {"LinuxcncExact", "linuxcnc", 10, 90, 0, true},
    {"LinuxcncBelow28Micrometres", "linuxcnc", 1, 90, 0.0280, true},
    {"LinuxcncAbove28Micrometres", "linuxcnc", 1, 90, 0.0290, false},
    {"LinuxcncBelow0_1Percent", "linuxcnc", 100, 90, 0.0990, true},
    {"LinuxcncAbove0_1Percent", "linuxcnc", 100, 90, 0.1010, false},
    {"LinuxcncAboveItsLimit", "linuxcnc", 5000, 90, 2.9, false},
    {"LinuxcncFullTurn", "linuxcnc", 10, 360, 0, true},
    {"LinuxcncReadAsAFullTurn", "linuxcnc", 10, 1e-5, 0, false}};

TEST(ArcRule, TakesOrRefuses) {
  for (const ArcCase& test : kArcRows) {
    const Arc arc = arc_with(test.radius, test.sweep_deg * std::numbers::pi / 180, test.mismatch);
    const auto complaint = arc_refusal(named_control(test.control), arc, Units::kMillimetre);
    EXPECT_EQ(complaint.empty(), test.taken) << test.name << ": " << complaint;
  }
}

TEST(Grbl, JudgesArcsInEveryPlaneAlike) {
  const Arc flat = arc_with(10, 1, 0.02);
  const Arc in_zx{Point3(0, 5, 10), Point3(flat.end.y(), 5, flat.end.x()), Point3(0, 5, 0),
                  Vector3::UnitY(), 1};
  const Arc in_yz{Point3(5, 10, 0), Point3(5, flat.end.x(), flat.end.y()), Point3(5, 0, 0),
                  Vector3::UnitX(), 1};
  for (const Arc& arc : {flat, in_zx, in_yz}) {
    EXPECT_FALSE(arc_refusal(named_control("grbl"), arc, Units::kMillimetre).empty());
    EXPECT_FALSE(arc_refusal(named_control("grbl"), arc, Units::kInch).empty());
  }
}

// Digits that grbl reads of X100000.009: eight. Its end, one digit shorter, it reads to the last.
TEST(Grbl, RefusesAnArcWhoseRadiiDifferInTheDigitsThatItReads) {
  const auto half_turn = [](double start) {
    return Arc{Point3(start, 0, 0), Point3(start - 2, 0, 0), Point3(start - 1, 0, 0),
               Vector3::UnitZ(), std::numbers::pi};
  };
  for (const char* name : {"grbl", "grblhal", "fluidnc"}) {
    EXPECT_EQ(arc_refusal(named_control(name), half_turn(1000.009), Units::kMillimetre), "")
        << name;
    EXPECT_FALSE(
        arc_refusal(named_control(name), half_turn(100000.009), Units::kMillimetre).empty())
        << name;
  }
}

TEST(Controls, RefuseArcsBelowTheLeastRadiusOfTheirTableAndOfAProfile) {
  for (const Control& each : controls()) {
    const auto refusal = [&](const Control& target, double radius) {
      return arc_refusal(target, arc_with(radius, 1, 0), Units::kMillimetre);
    };
    const double least = each.min_radius;
    EXPECT_GE(least, 0.05) << each.name;
    EXPECT_FALSE(refusal(each, 0.99 * least).empty()) << each.name;
    Control mine = each;
    mine.min_radius = 3 * least;
    EXPECT_EQ(refusal(each, 2 * least), "") << each.name;
    EXPECT_FALSE(refusal(mine, 2 * least).empty()) << each.name;
  }
}

// Nobody knows what becomes of them: nothing, a full turn, or an error.
TEST(Controls, RefuseArcsOfNearlyNothing) {
  for (const Control& each : controls()) {
    const auto taken = [&](double radius, double sweep) {
      return arc_refusal(each, arc_with(radius, sweep, 0), Units::kMillimetre).empty();
    };
    for (const double sweep : {1e-7, -1e-7, 1e-6, 9e-6}) {
      EXPECT_FALSE(taken(10, sweep)) << each.name << ": " << sweep;
      EXPECT_FALSE(taken(0.9 * each.max_radius, sweep)) << each.name << ": " << sweep;
    }
    EXPECT_FALSE(taken(0.00015, 3)) << each.name;
    EXPECT_TRUE(taken(10, 1)) << each.name;
    EXPECT_TRUE(taken(10, -3)) << each.name;
  }
}

// Firmware that may take a full circle for no motion is given none, however great it is.
TEST(Controls, RefuseFullTurnsWhereTheyMayBeNone) {
  for (const Control& each : controls()) {
    if (each.arc_rule != ArcRule::kGrbl && each.arc_rule != ArcRule::kUnchecked &&
        each.arc_rule != ArcRule::kTinyg) {
      continue;
    }
    for (const double sweep : {2 * std::numbers::pi, -2 * std::numbers::pi, 6.2}) {
      EXPECT_FALSE(arc_refusal(each, arc_with(10, sweep, 0), Units::kMillimetre).empty())
          << each.name << ": " << sweep;
    }
  }
}

// At 100,000 mm neighbouring 32-bit numbers are 0.0078 mm apart.
TEST(Controls, RefuseArcsWhose32BitsAreCoarserThanTheirDigits) {
  for (const char* name :
       {"grbl", "fluidnc", "g2core", "marlin", "smoothieware", "reprapfirmware"}) {
    for (const double far : {1e5, -1e5, 2e4}) {
      Arc arc = arc_with(10, 1, 0);
      for (Point3* place : {&arc.start, &arc.end, &arc.center}) place->x() += far;
      EXPECT_FALSE(arc_refusal(named_control(name), arc, Units::kMillimetre).empty()) << name;
    }
    Arc arc = arc_with(10, 1, 0);
    for (Point3* place : {&arc.start, &arc.end, &arc.center}) place->x() += 1000;
    EXPECT_EQ(arc_refusal(named_control(name), arc, Units::kMillimetre), "") << name;
  }
}

TEST(Controls, RefuseArcsOfNumbersThatNobodyWrites) {
  for (const Control& each : controls()) {
    for (const double radius : {1e9, 1e12, std::numeric_limits<double>::infinity()}) {
      EXPECT_FALSE(arc_refusal(each, arc_with(radius, 1, 0), Units::kMillimetre).empty())
          << each.name;
    }
  }
}

// --- lines and comments -------------------------------------------------------------------------

TEST(LineLength, CountsWhatTheControlKeeps) {
  struct Case {
    std::string control;
    std::string line;
    std::size_t expected;
  };
  for (const Case& test :
       {Case{"grbl", "G1 X1 (end) Y2", 6}, Case{"grbl", "G1X1 ; rest of it", 4},
        Case{"grbl", "\xC3\xA4", 2},  // other bytes are kept by grbl
        Case{"grbl", "", 0}, Case{"grbl", "G1 X1 (c) Y2 ; d", 6},
        Case{"reprapfirmware", "G1 X1 (c) Y2 ; d", 10}, Case{"linuxcnc", "G1 X1 (c) Y2 ; d", 16}}) {
    EXPECT_EQ(line_length(named_control(test.control), test.line), test.expected) << test.line;
  }
}

TEST(Controls, PutCommentsInParentheses) {
  for (const std::string_view name : {"linuxcnc", "grbl", "haas", "okuma", "mach3", "beckhoff"}) {
    EXPECT_EQ(comment_line(named_control(name), "slot 2"), "(slot 2)") << name;
  }
}

TEST(Controls, OfPrintersPutCommentsBehindASemicolon) {
  for (const std::string_view name : {"marlin", "klipper", "reprapfirmware"}) {
    EXPECT_EQ(comment_line(named_control(name), "slot 2"), "; slot 2") << name;
  }
}

TEST(Controls, SayNoCommentThatWouldActOrEndTooEarly) {
  for (const Control& each : controls()) {
    SCOPED_TRACE(each.name);
    for (const std::string text : {"a (b)", "a)", "two\nlines", "Gl\xC3\xA4ser", "MSG, hello",
                                   " debug, #1", "Print,x", "log,x", "P R O B E O P E N f"}) {
      EXPECT_EQ(comment_line(each, text), "") << text;
    }
  }
}

TEST(Controls, SayNoCommentLongerThanALine) {
  EXPECT_EQ(comment_line(named_control("linuxcnc"), std::string(251, 'x')), "");
  EXPECT_EQ(comment_line(named_control("linuxcnc"), std::string(250, 'x')).size(), 252U);
}

TEST(Grbl, SaysNoCommentWithACharacterThatItObeysInComments) {
  for (const std::string text : {"really?", "stop!", "a~b", "$H"}) {
    EXPECT_EQ(comment_line(named_control("grbl"), text), "") << text;
    EXPECT_NE(comment_line(named_control("linuxcnc"), text), "") << text;
  }
}

TEST(Fanuc, HasNoSmallLettersInComments) {
  EXPECT_EQ(comment_line(named_control("fanuc"), "slot 2"), "(SLOT 2)");
}

TEST(Codesys, HasNoComments) { EXPECT_EQ(comment_line(named_control("codesys"), "slot 2"), ""); }

TEST(Controls, RefuseWords) {
  EXPECT_TRUE(refuses_word(named_control("grbl"), 'M', 60));
  EXPECT_FALSE(refuses_word(named_control("grbl"), 'M', 30));
  EXPECT_TRUE(refuses_word(named_control("grbl"), 'H', 10));
  EXPECT_TRUE(refuses_word(named_control("okuma"), 'G', 540));
  EXPECT_FALSE(refuses_word(named_control("haas"), 'G', 540));
}

// --- byte for byte -----------------------------------------------------------------------------

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// A contour with a line, arcs in three planes, a helix, a feed change and a comment, restored at
// the end. What the target cannot say as an arc is a line.
std::string contour(const Control& control, Units units) {
  ModalState before = cutting_in(units);
  before.motion = MotionMode::kRapid;
  const double mm = millimetres_per(units);
  Writer out(control, {before, {Point3::Zero(), {true, true, true}}}, "\n");
  out.use_coordinates(arc_end_format(control, units));
  out.line_to(mm * Point3(1.5, 0, 0), *before.feed);
  const auto arc = [&](const Point3& center, const Vector3& axis, double sweep, double rise) {
    const geometry::Arc wanted =
        arc_round(out.state().position.mm, mm * center, axis, sweep, mm * rise);
    if (!out.arc_to(wanted, *before.feed / 2)) out.line_to(wanted.end, *before.feed / 2);
  };
  arc({1.5, 0.75, 0}, Vector3::UnitZ(), std::numbers::pi / 3, 0);
  const std::string comment = comment_line(control, "second wall");
  if (!comment.empty()) out.copy_line(comment);
  arc({1.5, 0.75, 0}, Vector3::UnitZ(), std::numbers::pi / 7, -0.125);
  arc({2, 2, -1}, Vector3::UnitY(), -1.0, 0);
  arc({0, 0.25, 0}, Vector3::UnitX(), 0.5, 0);
  out.line_to(mm * Point3(1.0 / 3, -2.0 / 3, 1), *before.feed);
  out.restore(cutting_in(units));
  return out.text();
}

TEST(Contours, AreByteForByteTheCases) {
  for (const Control& each : controls()) {
    for (const auto& [units, file] : {std::pair(Units::kMillimetre, "contour_mm.nc"),
                                      std::pair(Units::kInch, "contour_inch.nc")}) {
      const fs::path expected =
          fs::path(BATTEN_SOURCE_DIR) / "tests" / "cases" / std::string(each.name) / file;
      EXPECT_EQ(contour(each, units), text_of(expected)) << expected;
    }
  }
}

}  // namespace
}  // namespace batten::gcode
