#include "gcode/control/dialect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include "gcode/controls/arc_rules.h"
#include "gcode/controls/built_in.h"
#include "gcode/state/modal_state.h"

namespace batten::gcode {
namespace {

using geometry::Arc;
using geometry::Point3;
using geometry::Vector3;

const Dialect& dialect(std::string_view name) {
  const Dialect* found = find_dialect(name);
  if (found == nullptr) throw std::invalid_argument("no dialect " + std::string(name));
  return *found;
}

// From (radius, 0) by `sweep` about the origin; the end lies `mismatch` farther out.
Arc arc_with(double radius, double sweep, double mismatch) {
  const double end_radius = radius + mismatch;
  return {Point3(radius, 0, 0),
          Point3(end_radius * std::cos(sweep), end_radius * std::sin(sweep), 0), Point3::Zero(),
          Vector3::UnitZ(), sweep};
}

TEST(Dialects, HaveDifferentNamesAndAreFoundByThem) {
  std::set<std::string_view> names;
  for (const Dialect* each : dialects()) {
    EXPECT_TRUE(names.insert(each->name()).second) << each->name();
    EXPECT_EQ(find_dialect(each->name()), each);
    EXPECT_FALSE(each->description().empty());
    EXPECT_FALSE(each->default_machine().empty());
  }
  EXPECT_EQ(find_dialect("no such control"), nullptr);
  EXPECT_EQ(find_dialect(""), nullptr);
}

TEST(Dialects, PrintInchesAtLeastAboutAsFinelyAsMillimetres) {
  for (const Dialect* each : dialects()) {
    SCOPED_TRACE(each->name());
    // One decimal more is a step 2.54 times as wide.
    EXPECT_LE(printed_step(each->coordinates(Units::kInch), Units::kInch),
              2.6 * printed_step(each->coordinates(Units::kMillimetre), Units::kMillimetre));
    EXPECT_LE(each->arc_ends(Units::kInch).decimals, 9);
    EXPECT_GE(each->arc_ends(Units::kInch).decimals, each->coordinates(Units::kInch).decimals);
  }
}

TEST(Dialects, StepOfAFormatIsItsLastDecimal) {
  EXPECT_DOUBLE_EQ(printed_step({.decimals = 3}, Units::kMillimetre), 0.001);
  EXPECT_DOUBLE_EQ(printed_step({.decimals = 4}, Units::kInch), 0.00254);
  EXPECT_DOUBLE_EQ(printed_step({.decimals = 0}, Units::kMillimetre), 1);
}

TEST(Dialects, UnknownUnitsHaveNoSize) {
  EXPECT_THROW((void)millimetres_per(Units::kUnknown), std::invalid_argument);
}

// --- which arcs are taken ---------------------------------------------------------------------

struct ArcCase {
  std::string name;
  std::string dialect;
  double radius;
  double sweep_deg;
  double mismatch;  // mm
  bool taken;
};

class ArcRule : public testing::TestWithParam<ArcCase> {};

TEST_P(ArcRule, TakesOrRefuses) {
  const ArcCase& test = GetParam();
  const Arc arc = arc_with(test.radius, test.sweep_deg * std::numbers::pi / 180, test.mismatch);
  const auto complaint = arc_refusal(dialect(test.dialect), arc, Units::kMillimetre);
  EXPECT_EQ(complaint.empty(), test.taken) << complaint;
}

INSTANTIATE_TEST_SUITE_P(
    Dialects, ArcRule,
    testing::Values(
        // grbl: refused above 0.005 mm, if also above 0.1 % of the radius or above 0.5 mm
        ArcCase{"GrblExact", "grbl", 10, 90, 0, true},
        ArcCase{"GrblJustBelow5Micrometres", "grbl", 1, 90, 0.0049, true},
        ArcCase{"GrblAbove5MicrometresAndAbove0_1Percent", "grbl", 1, 90, 0.0055, false},
        ArcCase{"GrblAbove5MicrometresBelow0_1Percent", "grbl", 10, 90, 0.0090, true},
        ArcCase{"GrblAbove0_1Percent", "grbl", 10, 90, 0.0110, false},
        ArcCase{"GrblInwards", "grbl", 10, 90, -0.0110, false},
        ArcCase{"GrblAboveHalfAMillimetre", "grbl", 900, 90, 0.51, false},
        ArcCase{"GrblBelowHalfAMillimetre", "grbl", 900, 90, 0.49, true},
        ArcCase{"GrblTooTight", "grbl", 0.09, 90, 0, false},
        ArcCase{"GrblTightest", "grbl", 0.11, 90, 0, true},
        ArcCase{"GrblTooShort", "grbl", 10, 0.45, 0, false},
        ArcCase{"GrblShortest", "grbl", 10, 0.55, 0, true},
        ArcCase{"GrblNearlyAFullTurn", "grbl", 10, 355, 0, false},
        ArcCase{"GrblLongest", "grbl", 10, 345, 0, true},
        ArcCase{"GrblClockwise", "grbl", 10, -90, 0, true},
        // LinuxCNC: 0.0283 mm, or 0.1 % of the radius up to 2.83 mm
        // and a least radius of 0.05 mm, ours
        ArcCase{"LinuxcncTooTight", "linuxcnc", 0.0499, 90, 0, false},
        ArcCase{"LinuxcncOfMicrometres", "linuxcnc", 0.00015, 90, 0, false},
        ArcCase{"LinuxcncTightest", "linuxcnc", 0.05, 90, 0, true},
        ArcCase{"LinuxcncExact", "linuxcnc", 10, 90, 0, true},
        ArcCase{"LinuxcncBelow28Micrometres", "linuxcnc", 1, 90, 0.0280, true},
        ArcCase{"LinuxcncAbove28Micrometres", "linuxcnc", 1, 90, 0.0290, false},
        ArcCase{"LinuxcncBelow0_1Percent", "linuxcnc", 100, 90, 0.0990, true},
        ArcCase{"LinuxcncAbove0_1Percent", "linuxcnc", 100, 90, 0.1010, false},
        ArcCase{"LinuxcncAboveItsLimit", "linuxcnc", 5000, 90, 2.9, false},
        ArcCase{"LinuxcncFullTurn", "linuxcnc", 10, 360, 0, true},
        ArcCase{"LinuxcncReadAsAFullTurn", "linuxcnc", 10, 1e-5, 0, false}),
    [](const auto& test) { return test.param.name; });

TEST(Grbl, JudgesArcsInEveryPlaneAlike) {
  const Arc flat = arc_with(10, 1, 0.02);
  const Arc in_zx{Point3(0, 5, 10), Point3(flat.end.y(), 5, flat.end.x()), Point3(0, 5, 0),
                  Vector3::UnitY(), 1};
  const Arc in_yz{Point3(5, 10, 0), Point3(5, flat.end.x(), flat.end.y()), Point3(5, 0, 0),
                  Vector3::UnitX(), 1};
  for (const Arc& arc : {flat, in_zx, in_yz}) {
    EXPECT_FALSE(arc_refusal(dialect("grbl"), arc, Units::kMillimetre).empty());
    EXPECT_FALSE(arc_refusal(dialect("grbl"), arc, Units::kInch).empty());
  }
}

// Digits that grbl reads of X100000.009: eight. Its end, one digit shorter, it reads to the last.
TEST(Grbl, RefusesAnArcWhoseRadiiDifferInTheDigitsThatItReads) {
  const auto half_turn = [](double start) {
    return Arc{Point3(start, 0, 0), Point3(start - 2, 0, 0), Point3(start - 1, 0, 0),
               Vector3::UnitZ(), std::numbers::pi};
  };
  for (const char* name : {"grbl", "grblhal", "fluidnc"}) {
    EXPECT_EQ(arc_refusal(dialect(name), half_turn(1000.009), Units::kMillimetre), "") << name;
    EXPECT_FALSE(arc_refusal(dialect(name), half_turn(100000.009), Units::kMillimetre).empty())
        << name;
  }
}

TEST(Dialects, RefuseArcsBelowTheLeastRadiusOfTheirTableAndOfAProfile) {
  for (const Dialect* each : dialects()) {
    const auto refusal = [&](const Dialect& target, double radius) {
      return arc_refusal(target, arc_with(radius, 1, 0), Units::kMillimetre);
    };
    const double least = each->min_arc_radius();
    EXPECT_GE(least, 0.05) << each->name();
    EXPECT_FALSE(refusal(*each, 0.99 * least).empty()) << each->name();
    TargetTable table = table_of(*each);
    table.min_radius = 3 * least;
    const auto mine = each->with_values(table);
    EXPECT_EQ(refusal(*each, 2 * least), "") << each->name();
    EXPECT_FALSE(refusal(*mine, 2 * least).empty()) << each->name();
  }
}

TEST(Dialects, RefuseArcsOfNumbersThatNobodyWrites) {
  for (const Dialect* each : dialects()) {
    for (const double radius : {1e9, 1e12, std::numeric_limits<double>::infinity()}) {
      EXPECT_FALSE(arc_refusal(*each, arc_with(radius, 1, 0), Units::kMillimetre).empty())
          << each->name();
    }
  }
}

// --- lines and comments -------------------------------------------------------------------------

TEST(Grbl, CountsNeitherBlanksNorComments) {
  EXPECT_EQ(dialect("grbl").line_length("G1 X1 (end) Y2"), 6U);
  EXPECT_EQ(dialect("grbl").line_length("G1X1 ; rest of the line"), 4U);
  EXPECT_EQ(dialect("grbl").line_length("\xC3\xA4"), 2U);  // other bytes are kept by grbl
  EXPECT_EQ(dialect("grbl").line_length(""), 0U);
}

TEST(Linuxcnc, CountsEveryByte) {
  EXPECT_EQ(dialect("linuxcnc").line_length("G1 X1 (end) Y2"), 14U);
  EXPECT_EQ(dialect("linuxcnc").max_line_length(), 252U);
}

TEST(Dialects, PutCommentsInParentheses) {
  for (const std::string_view name : {"linuxcnc", "grbl", "haas", "okuma", "mach3", "beckhoff"}) {
    EXPECT_EQ(dialect(name).comment("slot 2"), "(slot 2)") << name;
  }
}

TEST(Dialects, OfPrintersPutCommentsBehindASemicolon) {
  for (const std::string_view name : {"marlin", "klipper", "reprapfirmware"}) {
    EXPECT_EQ(dialect(name).comment("slot 2"), "; slot 2") << name;
  }
}

TEST(Dialects, SayNoCommentThatWouldActOrEndTooEarly) {
  for (const Dialect* each : dialects()) {
    SCOPED_TRACE(each->name());
    for (const std::string text : {"a (b)", "a)", "two\nlines", "Gl\xC3\xA4ser", "MSG, hello",
                                   " debug, #1", "Print,x", "log,x", "P R O B E O P E N f"}) {
      EXPECT_EQ(each->comment(text), "") << text;
    }
  }
}

TEST(Dialects, SayNoCommentLongerThanALine) {
  EXPECT_EQ(dialect("linuxcnc").comment(std::string(251, 'x')), "");
  EXPECT_EQ(dialect("linuxcnc").comment(std::string(250, 'x')).size(), 252U);
}

TEST(Grbl, SaysNoCommentWithACharacterThatItObeysInComments) {
  for (const std::string text : {"really?", "stop!", "a~b", "$H"}) {
    EXPECT_EQ(dialect("grbl").comment(text), "") << text;
    EXPECT_NE(dialect("linuxcnc").comment(text), "") << text;
  }
}

}  // namespace
}  // namespace batten::gcode
