#include "gcode/writer/writer.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>

#include "gcode/controls/built_in.h"
#include "gcode/state/modal_state.h"
#include "tests/support/control_arcs.h"

namespace batten::gcode {
namespace {

using geometry::Point3;
using geometry::Vector3;

constexpr double kPi = std::numbers::pi;

Writer writer_at(std::string_view control, const ModalState& modal, const Point3& place,
                 std::string_view line_end = "\n") {
  return {named_control(control), {modal, {place, {true, true, true}}}, line_end};
}

// --- words --------------------------------------------------------------------------------------

TEST(Writer, RepeatsNoWordThatChangesNothing) {
  Writer out = writer_at("linuxcnc", cutting_in(Units::kMillimetre), Point3(0, 0, -1));
  out.line_to({1, 0, -1}, 1000);
  out.line_to({1, 2.5, -1}, 1000);
  out.line_to({1, 2.5, -2}, 600);
  out.line_to({-0.5, 2.5, -2}, 600);
  EXPECT_EQ(out.text(), "X1\nY2.5\nZ-2 F600\nX-0.5\n");
}

TEST(Writer, NamesTheMotionWhenItChanges) {
  ModalState modal = cutting_in(Units::kMillimetre);
  modal.motion = MotionMode::kRapid;
  Writer out = writer_at("linuxcnc", modal, Point3(0, 0, 0));
  out.line_to({1, 0, 0}, 1000);
  ASSERT_TRUE(out.arc_to(arc_round({1, 0, 0}, {1, 1, 0}, Vector3::UnitZ(), kPi / 2), 1000));
  ASSERT_TRUE(out.arc_to(arc_round({2, 1, 0}, {1, 1, 0}, Vector3::UnitZ(), kPi / 2), 1000));
  ASSERT_TRUE(out.arc_to(arc_round({1, 2, 0}, {1, 3, 0}, Vector3::UnitZ(), -kPi / 2), 1000));
  out.line_to({0, 4, 0}, 1000);
  EXPECT_EQ(out.text(), "G1 X1\nG3 X2 Y1 J1\nX1 Y2 I-1\nG2 X0 Y3 J1\nG1 Y4\n");
}

TEST(Writer, AMoveThatMovesNothingIsNotWritten) {
  Writer out = writer_at("linuxcnc", cutting_in(Units::kMillimetre), Point3(1, 2, 3));
  out.line_to({1, 2, 3}, 500);
  out.line_to({1.00001, 2, 3}, 500);
  EXPECT_EQ(out.text(), "");
  EXPECT_EQ(out.state().modal.feed, 1000);
}

TEST(Writer, AnAxisThatStaysKeepsDecimalsThatAreNotPrinted) {
  Writer out = writer_at("grbl", cutting_in(Units::kMillimetre), Point3(1.23456, 0, 0));
  out.line_to({1.23456, 5, 0}, 1000);
  EXPECT_EQ(out.text(), "Y5\n");
  EXPECT_EQ(out.state().position.mm.x(), 1.23456);
}

TEST(Writer, MeetsAPlaceWithMoreDecimalsWhereAskedTo) {
  Writer out = writer_at("grbl", cutting_in(Units::kMillimetre), Point3(0, 0, 0));
  out.line_to({1.23456, 0, 0}, 1000);
  out.use_coordinates({.decimals = 5});
  out.line_to({1.23456, 0, 0}, 1000);
  EXPECT_EQ(out.text(), "X1.235\nX1.23456\n");
}

TEST(Writer, AnUnknownAxisIsNamed) {
  Writer out(named_control("grbl"),
             {cutting_in(Units::kMillimetre), {Point3::Zero(), {true, false, true}}}, "\n");
  out.line_to({0, 0, 0}, 1000);
  EXPECT_EQ(out.text(), "Y0\n");
}

TEST(Writer, EndsLinesAsTheSourceDoes) {
  Writer out = writer_at("grbl", cutting_in(Units::kMillimetre), Point3(0, 0, 0), "\r\n");
  out.line_to({1, 0, 0}, 1000);
  out.copy_line("(slot 2)");
  EXPECT_EQ(out.text(), "X1\r\n(slot 2)\r\n");
}

TEST(Writer, WritesInchesInInchPrograms) {
  Writer out = writer_at("linuxcnc", cutting_in(Units::kInch), Point3(0, 0, 0));
  out.line_to({25.4, 12.7, 0}, 10.5 * 25.4);
  EXPECT_EQ(out.text(), "X1 Y0.5 F10.5\n");
  EXPECT_DOUBLE_EQ(out.state().position.mm.x(), 25.4);
}

TEST(Writer, ReproducesTheFeedsOfInchPrograms) {
  for (const double feed : {39.3701, 0.1, 7.874, 118.11, 1.000001}) {
    ModalState modal = cutting_in(Units::kInch);
    Writer out = writer_at("grbl", modal, Point3(0, 0, 0));
    out.line_to({25.4, 0, 0}, feed * 25.4);
    EXPECT_EQ(*out.state().modal.feed, feed * 25.4) << out.text();
  }
}

TEST(Writer, RefusesStatesInWhichItsNumbersWouldMeanSomethingElse) {
  ModalState no_units = cutting_in(Units::kMillimetre);
  no_units.units = Units::kUnknown;
  ModalState incremental = cutting_in(Units::kMillimetre);
  incremental.distance = DistanceMode::kIncremental;
  ModalState inverse_time = cutting_in(Units::kMillimetre);
  inverse_time.feed_mode = FeedMode::kInverseTime;
  for (const ModalState& modal : {no_units, incremental, inverse_time}) {
    EXPECT_THROW(writer_at("grbl", modal, Point3(0, 0, 0)), std::invalid_argument);
  }
}

// --- arcs ---------------------------------------------------------------------------------------

struct PlaneCase {
  Point3 start;
  Point3 center;
  Vector3 axis;
  double sweep;
  double rise;
  std::string expected;
};

// Expected by hand: a quarter turn of radius 10. In G18 the first axis is Z and the second X, so
// that counter-clockwise seen from +Y goes from Z to X.
TEST(Writer, WritesArcsInTheirPlanes) {
  const Vector3 x = Vector3::UnitX();
  const Vector3 y = Vector3::UnitY();
  const Vector3 z = Vector3::UnitZ();
  const PlaneCase rows[] = {{{10, 0, 0}, {0, 0, 0}, z, kPi / 2, 0, "G3 X0 Y10 I-10\n"},
                            {{10, 0, 0}, {0, 0, 0}, z, -kPi / 2, 0, "G2 X0 Y-10 I-10\n"},
                            {{10, 0, 0}, {0, 0, 0}, -z, kPi / 2, 0, "G2 X0 Y-10 I-10\n"},
                            {{0, 5, 10}, {0, 5, 0}, y, kPi / 2, 0, "G18 G3 X10 Z0 K-10\n"},
                            {{10, 5, 0}, {0, 5, 0}, y, -kPi / 2, 0, "G18 G2 X0 Z10 I-10\n"},
                            {{5, 10, 0}, {5, 0, 0}, x, kPi / 2, 0, "G19 G3 Y0 Z10 J-10\n"},
                            {{10, 0, 0}, {0, 0, 0}, z, kPi / 2, -1.5, "G3 X0 Y10 Z-1.5 I-10\n"},
                            {{0, 5, 10}, {0, 5, 0}, y, kPi / 2, 2, "G18 G3 X10 Y7 Z0 K-10\n"},
                            {{10, 0, 0}, {0, 0, 0}, z, kPi, 0, "G3 X-10 I-10\n"},
                            {{10, 1, 0}, {0, 1, 0}, z, 2 * kPi, 0, "G3 X10 I-10\n"}};
  for (const PlaneCase& test : rows) {
    Writer out = writer_at("linuxcnc", cutting_in(Units::kMillimetre), test.start);
    EXPECT_TRUE(
        out.arc_to(arc_round(test.start, test.center, test.axis, test.sweep, test.rise), 1000));
    EXPECT_EQ(out.text(), test.expected);
  }
}

// LinuxCNC reads R and centres; a short arc has the shorter words.
TEST(Writer, SaysShortArcsByTheirRadius) {
  for (const auto& [sweep, expected] : {std::pair(kPi / 4, "G3 X7.0711 Y7.0711 R10.00002\n"),
                                        std::pair(-kPi / 4, "G2 X7.0711 Y-7.0711 R10.00002\n"),
                                        std::pair(kPi / 3, "G3 X5 Y8.6603 I-10.00001 J0.00004\n"),
                                        std::pair(kPi / 2, "G3 X0 Y10 I-10\n")}) {
    Writer out = writer_at("linuxcnc", cutting_in(Units::kMillimetre), Point3(10, 0, 0));
    ASSERT_TRUE(out.arc_to(arc_round({10, 0, 0}, {0, 0, 0}, Vector3::UnitZ(), sweep), 1000));
    EXPECT_EQ(out.text(), expected);
  }
}

// The ends of an arc are turned by their own rounding, and by that of R a fifth as much at most.
TEST(Writer, SaysRadiiInTheDigitsThatMatter) {
  const auto text_and_turn = [](double radius, double sweep) {
    Writer out = writer_at("linuxcnc", cutting_in(Units::kMillimetre), Point3(radius, 0, 0));
    const auto arc =
        out.arc_to(arc_round({radius, 0, 0}, {0, 0, 0}, Vector3::UnitZ(), sweep), 1000);
    if (!arc) throw std::logic_error(fmt::format("no arc of {} by {}", radius, sweep));
    const double half = (arc->end - arc->start).norm() / 2;
    const double turn = std::asin(half / geometry::radius_of(*arc)) - std::asin(half / radius);
    return std::pair(out.text(), turn * 2 * half);
  };
  EXPECT_EQ(text_and_turn(123.456789, 0.004).first, "G3 X123.4558 Y0.4938 R123\n");
  EXPECT_EQ(text_and_turn(12.3456789, 0.04).first, "G3 X12.3358 Y0.4937 R12.35\n");
  EXPECT_EQ(text_and_turn(1.23456789, 0.9).first, "G3 X0.7674 Y0.9671 R1.23457\n");
  constexpr double kStep = 1e-4;
  for (double radius = 0.3; radius < 500; radius *= 1.37) {
    for (double sweep = 0.8; sweep * radius > 0.1 && sweep > 0.002; sweep /= 2) {
      EXPECT_LE(std::abs(text_and_turn(radius, sweep).second), 0.2 * kStep / 2) << radius;
    }
  }
}

TEST(Writer, WritesAbsoluteCentersWhereTheProgramSaysSo) {
  ModalState modal = cutting_in(Units::kMillimetre);
  modal.arc_distance = DistanceMode::kAbsolute;
  Writer out = writer_at("linuxcnc", modal, Point3(13, 4, 0));
  ASSERT_TRUE(out.arc_to(arc_round({13, 4, 0}, {3, 4, 0}, Vector3::UnitZ(), kPi / 2), 1000));
  EXPECT_EQ(out.text(), "G3 X3 Y14 I3 J4\n");
}

TEST(Writer, WritesNoArcWhereItIsNotKnownHowCentersAreGiven) {
  ModalState unknown = cutting_in(Units::kMillimetre);
  unknown.arc_distance = DistanceMode::kUnknown;
  Writer linuxcnc = writer_at("linuxcnc", unknown, Point3(10, 0, 0));
  ModalState absolute = cutting_in(Units::kMillimetre);
  absolute.arc_distance = DistanceMode::kAbsolute;
  Writer grbl = writer_at("grbl", absolute, Point3(10, 0, 0));  // has no G90.1
  const geometry::Arc arc = arc_round({10, 0, 0}, {0, 0, 0}, Vector3::UnitZ(), 1);
  EXPECT_FALSE(linuxcnc.arc_to(arc, 1000));
  EXPECT_FALSE(grbl.arc_to(arc, 1000));
  EXPECT_EQ(linuxcnc.text() + grbl.text(), "");
}

TEST(Writer, WritesNoFullTurnForAnArcThatRoundsToNothing) {
  for (const std::string_view name : {"linuxcnc", "grbl"}) {
    for (const double sweep : {1e-9, 1e-7, -1e-7, 1e-6, -1e-6}) {
      Writer out = writer_at(name, cutting_in(Units::kMillimetre), Point3(10, 0, 0));
      EXPECT_FALSE(out.arc_to(arc_round({10, 0, 0}, {0, 0, 0}, Vector3::UnitZ(), sweep), 1000))
          << name << ' ' << sweep << ' ' << out.text();
      EXPECT_EQ(out.text(), "");
    }
  }
}

TEST(Writer, AnArcNeedsAnAxisOfTheCoordinateSystem) {
  Writer out = writer_at("linuxcnc", cutting_in(Units::kMillimetre), Point3(10, 0, 0));
  EXPECT_THROW((void)out.arc_to(arc_round({10, 0, 0}, {0, 0, 0}, Vector3(0, 0.6, 0.8), 1), 1000),
               std::invalid_argument);
}

// --- restoring ----------------------------------------------------------------------------------

TEST(Writer, RestoresOnlyWhatDiffers) {
  Writer out = writer_at("linuxcnc", cutting_in(Units::kMillimetre), Point3(0, 0, 10));
  out.restore(cutting_in(Units::kMillimetre));
  EXPECT_EQ(out.text(), "");
  ASSERT_TRUE(out.arc_to(arc_round({0, 0, 10}, {0, 0, 0}, Vector3::UnitY(), kPi / 2), 500));
  out.restore(cutting_in(Units::kMillimetre));
  EXPECT_EQ(out.text(), "G18 G3 X10 Z0 K-10 F500\nG17 G1 F1000\n");
  EXPECT_EQ(out.state().modal, cutting_in(Units::kMillimetre));
}

TEST(Writer, LeavesWhatNobodyExpects) {
  Writer out = writer_at("linuxcnc", cutting_in(Units::kMillimetre), Point3(0, 0, 10));
  ASSERT_TRUE(out.arc_to(arc_round({0, 0, 10}, {0, 0, 0}, Vector3::UnitY(), kPi / 2), 500));
  ModalState anything;
  anything.plane = Plane::kUnknown;
  const std::string before = out.text();
  out.restore(anything);
  EXPECT_EQ(out.text(), before);
}

TEST(Writer, CannotRestoreAMotionThatCannotStandAlone) {
  Writer out = writer_at("linuxcnc", cutting_in(Units::kMillimetre), Point3(0, 0, 0));
  ModalState expected = cutting_in(Units::kMillimetre);
  expected.motion = MotionMode::kClockwise;
  EXPECT_THROW(out.restore(expected), std::invalid_argument);
}

// --- what the control reads ---------------------------------------------------------------------

// A reader of its own: letters and the numbers after them. A letter alone has none (L of Klartext).
std::map<char, double> words_of(const std::string& line) {
  std::map<char, double> words;
  std::istringstream in(line);
  for (std::string word; in >> word;) {
    if (word.size() == 1) continue;
    if (word[0] == 'G') {
      words[std::stod(word.substr(1)) < 17 ? 'G' : 'P'] = std::stod(word.substr(1));
    } else {
      words[word[0]] = std::stod(word.substr(1));
    }
  }
  return words;
}

TEST(Writer, PrintedPlacesAreItsOwnPosition) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-500, 500);
  for (const Control& each : controls()) {
    for (const Units units : {Units::kMillimetre, Units::kInch}) {
      Writer out(each, {cutting_in(units), {Point3::Zero(), {true, true, true}}}, "\n");
      Point3 control = Point3::Zero();
      std::size_t read = 0;
      for (int i = 0; i < 2000; ++i) {
        out.line_to({place(random), place(random), i % 3 == 0 ? place(random) : control.z()}, 1000);
        for (const auto& [letter, value] : words_of(out.text().substr(read))) {
          if (letter >= 'X') control[letter - 'X'] = value * millimetres_per(units);
        }
        read = out.text().size();
        ASSERT_EQ(control, out.state().position.mm);
      }
    }
  }
}

}  // namespace
}  // namespace batten::gcode
