#include "gcode/writer/writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "gcode/controls/built_in.h"
#include "gcode/state/modal_state.h"
#include "tests/support/places.h"

namespace batten::gcode {
namespace {

using geometry::Arc;
using geometry::Point3;
using geometry::Vector3;

constexpr double kPi = std::numbers::pi;

ModalState cutting(Units units = Units::kMillimetre) {
  ModalState modal;
  modal.motion = MotionMode::kLine;
  modal.units = units;
  modal.feed = units == Units::kInch ? 40 * 25.4 : 1000;
  return modal;
}

Writer writer_at(std::string_view control, const ModalState& modal, const Point3& place,
                 std::string_view line_end = "\n") {
  return {*find_control(control), {modal, {place, {true, true, true}}}, line_end};
}

// Counter-clockwise seen from the tip of `axis` for a positive sweep.
Arc arc_about(const Point3& start, const Point3& center, const Vector3& axis, double sweep,
              double rise = 0) {
  const Vector3 out = start - center - (start - center).dot(axis) * axis;
  const Vector3 turned = std::cos(sweep) * out + std::sin(sweep) * axis.cross(out);
  return {start, start - out + turned + rise * axis, center, axis, sweep};
}

// --- words --------------------------------------------------------------------------------------

TEST(Writer, RepeatsNoWordThatChangesNothing) {
  Writer out = writer_at("linuxcnc", cutting(), Point3(0, 0, -1));
  out.line_to({1, 0, -1}, 1000);
  out.line_to({1, 2.5, -1}, 1000);
  out.line_to({1, 2.5, -2}, 600);
  out.line_to({-0.5, 2.5, -2}, 600);
  EXPECT_EQ(out.text(), "X1\nY2.5\nZ-2 F600\nX-0.5\n");
}

TEST(Writer, NamesTheMotionWhenItChanges) {
  ModalState modal = cutting();
  modal.motion = MotionMode::kRapid;
  Writer out = writer_at("linuxcnc", modal, Point3(0, 0, 0));
  out.line_to({1, 0, 0}, 1000);
  ASSERT_TRUE(out.arc_to(arc_about({1, 0, 0}, {1, 1, 0}, Vector3::UnitZ(), kPi / 2), 1000));
  ASSERT_TRUE(out.arc_to(arc_about({2, 1, 0}, {1, 1, 0}, Vector3::UnitZ(), kPi / 2), 1000));
  ASSERT_TRUE(out.arc_to(arc_about({1, 2, 0}, {1, 3, 0}, Vector3::UnitZ(), -kPi / 2), 1000));
  out.line_to({0, 4, 0}, 1000);
  EXPECT_EQ(out.text(), "G1 X1\nG3 X2 Y1 J1\nX1 Y2 I-1\nG2 X0 Y3 J1\nG1 Y4\n");
}

TEST(Writer, AMoveThatMovesNothingIsNotWritten) {
  Writer out = writer_at("linuxcnc", cutting(), Point3(1, 2, 3));
  out.line_to({1, 2, 3}, 500);
  out.line_to({1.00001, 2, 3}, 500);
  EXPECT_EQ(out.text(), "");
  EXPECT_EQ(out.state().modal.feed, 1000);
}

TEST(Writer, AnAxisThatStaysKeepsDecimalsThatAreNotPrinted) {
  Writer out = writer_at("grbl", cutting(), Point3(1.23456, 0, 0));
  out.line_to({1.23456, 5, 0}, 1000);
  EXPECT_EQ(out.text(), "Y5\n");
  EXPECT_EQ(out.state().position.mm.x(), 1.23456);
}

TEST(Writer, MeetsAPlaceWithMoreDecimalsWhereAskedTo) {
  Writer out = writer_at("grbl", cutting(), Point3(0, 0, 0));
  out.line_to({1.23456, 0, 0}, 1000);
  out.use_coordinates({.decimals = 5});
  out.line_to({1.23456, 0, 0}, 1000);
  EXPECT_EQ(out.text(), "X1.235\nX1.23456\n");
}

TEST(Writer, AnUnknownAxisIsNamed) {
  Writer out(*find_control("grbl"), {cutting(), {Point3::Zero(), {true, false, true}}}, "\n");
  out.line_to({0, 0, 0}, 1000);
  EXPECT_EQ(out.text(), "Y0\n");
}

TEST(Writer, EndsLinesAsTheSourceDoes) {
  Writer out = writer_at("grbl", cutting(), Point3(0, 0, 0), "\r\n");
  out.line_to({1, 0, 0}, 1000);
  out.copy_line("(slot 2)");
  EXPECT_EQ(out.text(), "X1\r\n(slot 2)\r\n");
}

TEST(Writer, WritesInchesInInchPrograms) {
  Writer out = writer_at("linuxcnc", cutting(Units::kInch), Point3(0, 0, 0));
  out.line_to({25.4, 12.7, 0}, 10.5 * 25.4);
  EXPECT_EQ(out.text(), "X1 Y0.5 F10.5\n");
  EXPECT_DOUBLE_EQ(out.state().position.mm.x(), 25.4);
}

TEST(Writer, ReproducesTheFeedsOfInchPrograms) {
  for (const double feed : {39.3701, 0.1, 7.874, 118.11, 1.000001}) {
    ModalState modal = cutting(Units::kInch);
    Writer out = writer_at("grbl", modal, Point3(0, 0, 0));
    out.line_to({25.4, 0, 0}, feed * 25.4);
    EXPECT_EQ(*out.state().modal.feed, feed * 25.4) << out.text();
  }
}

TEST(Writer, RefusesStatesInWhichItsNumbersWouldMeanSomethingElse) {
  ModalState no_units = cutting();
  no_units.units = Units::kUnknown;
  ModalState incremental = cutting();
  incremental.distance = DistanceMode::kIncremental;
  ModalState inverse_time = cutting();
  inverse_time.feed_mode = FeedMode::kInverseTime;
  for (const ModalState& modal : {no_units, incremental, inverse_time}) {
    EXPECT_THROW(writer_at("grbl", modal, Point3(0, 0, 0)), std::invalid_argument);
  }
}

// --- arcs ---------------------------------------------------------------------------------------

struct PlaneCase {
  std::string name;
  Point3 start;
  Point3 center;
  Vector3 axis;
  double sweep;
  double rise;
  std::string expected;
};

class ArcPlanes : public testing::TestWithParam<PlaneCase> {};

// Expected by hand: a quarter turn of radius 10. In G18 the first axis is Z and the second X, so
// that counter-clockwise seen from +Y goes from Z to X.
TEST_P(ArcPlanes, AreWrittenSo) {
  const PlaneCase& test = GetParam();
  Writer out = writer_at("linuxcnc", cutting(), test.start);
  ASSERT_TRUE(
      out.arc_to(arc_about(test.start, test.center, test.axis, test.sweep, test.rise), 1000));
  EXPECT_EQ(out.text(), test.expected);
}

INSTANTIATE_TEST_SUITE_P(
    Writer, ArcPlanes,
    testing::Values(
        PlaneCase{
            "XyCounterclockwise", {10, 0, 0}, {0, 0, 0}, {0, 0, 1}, kPi / 2, 0, "G3 X0 Y10 I-10\n"},
        PlaneCase{
            "XyClockwise", {10, 0, 0}, {0, 0, 0}, {0, 0, 1}, -kPi / 2, 0, "G2 X0 Y-10 I-10\n"},
        PlaneCase{
            "XySeenFromBelow", {10, 0, 0}, {0, 0, 0}, {0, 0, -1}, kPi / 2, 0, "G2 X0 Y-10 I-10\n"},
        PlaneCase{"ZxCounterclockwise",
                  {0, 5, 10},
                  {0, 5, 0},
                  {0, 1, 0},
                  kPi / 2,
                  0,
                  "G18 G3 X10 Z0 K-10\n"},
        PlaneCase{
            "ZxClockwise", {10, 5, 0}, {0, 5, 0}, {0, 1, 0}, -kPi / 2, 0, "G18 G2 X0 Z10 I-10\n"},
        PlaneCase{"YzCounterclockwise",
                  {5, 10, 0},
                  {5, 0, 0},
                  {1, 0, 0},
                  kPi / 2,
                  0,
                  "G19 G3 Y0 Z10 J-10\n"},
        PlaneCase{
            "HelixInXy", {10, 0, 0}, {0, 0, 0}, {0, 0, 1}, kPi / 2, -1.5, "G3 X0 Y10 Z-1.5 I-10\n"},
        PlaneCase{
            "HelixInZx", {0, 5, 10}, {0, 5, 0}, {0, 1, 0}, kPi / 2, 2, "G18 G3 X10 Y7 Z0 K-10\n"},
        PlaneCase{"HalfTurn", {10, 0, 0}, {0, 0, 0}, {0, 0, 1}, kPi, 0, "G3 X-10 I-10\n"},
        PlaneCase{"FullTurn", {10, 1, 0}, {0, 1, 0}, {0, 0, 1}, 2 * kPi, 0, "G3 X10 I-10\n"}),
    [](const auto& test) { return test.param.name; });

TEST(Writer, WritesAbsoluteCentersWhereTheProgramSaysSo) {
  ModalState modal = cutting();
  modal.arc_distance = DistanceMode::kAbsolute;
  Writer out = writer_at("linuxcnc", modal, Point3(13, 4, 0));
  ASSERT_TRUE(out.arc_to(arc_about({13, 4, 0}, {3, 4, 0}, Vector3::UnitZ(), kPi / 2), 1000));
  EXPECT_EQ(out.text(), "G3 X3 Y14 I3 J4\n");
}

TEST(Writer, WritesNoArcWhereItIsNotKnownHowCentersAreGiven) {
  ModalState unknown = cutting();
  unknown.arc_distance = DistanceMode::kUnknown;
  Writer linuxcnc = writer_at("linuxcnc", unknown, Point3(10, 0, 0));
  ModalState absolute = cutting();
  absolute.arc_distance = DistanceMode::kAbsolute;
  Writer grbl = writer_at("grbl", absolute, Point3(10, 0, 0));  // has no G90.1
  const Arc arc = arc_about({10, 0, 0}, {0, 0, 0}, Vector3::UnitZ(), 1);
  EXPECT_FALSE(linuxcnc.arc_to(arc, 1000));
  EXPECT_FALSE(grbl.arc_to(arc, 1000));
  EXPECT_EQ(linuxcnc.text() + grbl.text(), "");
}

TEST(Writer, WritesNoFullTurnForAnArcThatRoundsToNothing) {
  for (const std::string_view name : {"linuxcnc", "grbl"}) {
    for (const double sweep : {1e-9, 1e-7, -1e-7, 1e-6, -1e-6}) {
      Writer out = writer_at(name, cutting(), Point3(10, 0, 0));
      EXPECT_FALSE(out.arc_to(arc_about({10, 0, 0}, {0, 0, 0}, Vector3::UnitZ(), sweep), 1000))
          << name << ' ' << sweep << ' ' << out.text();
      EXPECT_EQ(out.text(), "");
    }
  }
}

TEST(Writer, AnArcNeedsAnAxisOfTheCoordinateSystem) {
  Writer out = writer_at("linuxcnc", cutting(), Point3(10, 0, 0));
  EXPECT_THROW((void)out.arc_to(arc_about({10, 0, 0}, {0, 0, 0}, Vector3(0, 0.6, 0.8), 1), 1000),
               std::invalid_argument);
}

// --- restoring ----------------------------------------------------------------------------------

TEST(Writer, RestoresOnlyWhatDiffers) {
  Writer out = writer_at("linuxcnc", cutting(), Point3(0, 0, 10));
  out.restore(cutting());
  EXPECT_EQ(out.text(), "");
  ASSERT_TRUE(out.arc_to(arc_about({0, 0, 10}, {0, 0, 0}, Vector3::UnitY(), kPi / 2), 500));
  out.restore(cutting());
  EXPECT_EQ(out.text(), "G18 G3 X10 Z0 K-10 F500\nG17 G1 F1000\n");
  EXPECT_EQ(out.state().modal, cutting());
}

TEST(Writer, LeavesWhatNobodyExpects) {
  Writer out = writer_at("linuxcnc", cutting(), Point3(0, 0, 10));
  ASSERT_TRUE(out.arc_to(arc_about({0, 0, 10}, {0, 0, 0}, Vector3::UnitY(), kPi / 2), 500));
  ModalState anything;
  anything.plane = Plane::kUnknown;
  const std::string before = out.text();
  out.restore(anything);
  EXPECT_EQ(out.text(), before);
}

TEST(Writer, CannotRestoreAMotionThatCannotStandAlone) {
  Writer out = writer_at("linuxcnc", cutting(), Point3(0, 0, 0));
  ModalState expected = cutting();
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

struct RandomArc {
  Arc arc;
  Units units;
};

// Radii from 0.1 mm to the control's greatest, sweeps from 1 degree to 172, all planes, both
// directions, some helical, both units, centres up to 300 mm out.
RandomArc random_arc(std::mt19937& random, const Control& control) {
  std::uniform_real_distribution<double> unit(0, 1);
  // A printed centre is off by up to 0.0018 mm (half of 0.0001 in, on two axes): with less room a
  // radius of 0.1 mm may be printed as one that the control does not take.
  const double least = 1.05 * control.min_radius;
  const double radius = least * std::pow(0.99 * control.max_radius / least, unit(random));
  const Vector3 axis =
      Vector3::Unit(static_cast<int>(3 * unit(random)) % 3) * (unit(random) < 0.5 ? -1 : 1);
  const double sweep = (0.02 + 2.98 * unit(random)) * (unit(random) < 0.5 ? -1 : 1);
  const double rise = unit(random) < 0.3 ? radius * (unit(random) - 0.5) : 0;
  const Point3 center = 300 * Point3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
  const Vector3 out = Vector3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
  const Vector3 across = (out - out.dot(axis) * axis).normalized();
  return {arc_about(center + radius * across, center, axis, sweep, rise),
          unit(random) < 0.3 ? Units::kInch : Units::kMillimetre};
}

// The start, as it would have been printed.
Point3 on_grid(const Point3& place, const Control& control, Units units) {
  Point3 printed;
  const int decimals = arc_end_format(control, units).decimals;
  for (int i = 0; i < 3; ++i) {
    printed[i] = rounded(place[i] / millimetres_per(units), decimals) * millimetres_per(units);
  }
  return printed;
}

struct ReadArc {
  Plane plane = Plane::kXY;
  bool clockwise = false;
  Point3 start, end, offset;  // mm
  int first = 0, second = 1;
};

ReadArc read_back(const std::string& text, const Point3& start, Units units) {
  const auto words = words_of(text);
  ReadArc arc;
  const double mm = units == Units::kInch ? 25.4 : 1;
  arc.start = arc.end = start;
  arc.offset = Point3::Zero();
  for (const auto& [letter, value] : words) {
    if (letter >= 'X' && letter <= 'Z') arc.end[letter - 'X'] = value * mm;
    if (letter >= 'I' && letter <= 'K') arc.offset[letter - 'I'] = value * mm;
  }
  if (words.contains('P')) {
    arc.plane = words.at('P') == 18 ? Plane::kZX : (words.at('P') == 19 ? Plane::kYZ : Plane::kXY);
  }
  arc.first = arc.plane == Plane::kXY ? 0 : (arc.plane == Plane::kZX ? 2 : 1);
  arc.second = (arc.first + 1) % 3;
  arc.clockwise = words.at('G') == 2;
  return arc;
}

// Error 33 of grbl, from its rule in single precision.
bool grbl_refuses(const ReadArc& arc) {
  const auto x = static_cast<float>(arc.end[arc.first]) - static_cast<float>(arc.start[arc.first]);
  const auto y =
      static_cast<float>(arc.end[arc.second]) - static_cast<float>(arc.start[arc.second]);
  const auto i = static_cast<float>(arc.offset[arc.first]);
  const auto j = static_cast<float>(arc.offset[arc.second]);
  const float r = std::hypot(i, j);
  const float delta = std::fabs(std::hypot(x - i, y - j) - r);
  return delta > 0.005F && (delta > 0.5F || delta > 0.001F * r);
}

double mismatch_of(const ReadArc& arc) {
  const double r = std::hypot(arc.offset[arc.first], arc.offset[arc.second]);
  return std::abs(std::hypot(arc.end[arc.first] - arc.start[arc.first] - arc.offset[arc.first],
                             arc.end[arc.second] - arc.start[arc.second] - arc.offset[arc.second]) -
                  r);
}

class WrittenArcs : public testing::TestWithParam<std::string> {
 protected:
  const Control& control_ = *find_control(GetParam());

  Writer writer_from(const Point3& start, Units units) const {
    Writer out(control_, {cutting(units), {start, {true, true, true}}}, "\n");
    out.use_coordinates(arc_end_format(control_, units));
    return out;
  }
};

TEST_P(WrittenArcs, HaveRadiiThatTheControlTakes) {
  std::mt19937 random(1);
  double worst = 0;  // in steps of the offsets
  double mean = 0;
  for (int i = 0; i < 10000; ++i) {
    const RandomArc wanted = random_arc(random, control_);
    const Point3 start = on_grid(wanted.arc.start, control_, wanted.units);
    Writer out = writer_from(start, wanted.units);
    ASSERT_TRUE(out.arc_to(wanted.arc, *cutting(wanted.units).feed)) << "arc " << i;
    const ReadArc read = read_back(out.text(), start, wanted.units);
    const double step = printed_step(center_format(control_, wanted.units), wanted.units);
    worst = std::max(worst, mismatch_of(read) / step);
    mean += mismatch_of(read) / step / 10000;
    ASSERT_LE(mismatch_of(read), 0.0283) << "arc " << i << ": " << out.text();
    if (GetParam() == "grbl") {
      ASSERT_FALSE(grbl_refuses(read)) << "arc " << i << ": " << out.text();
      ASSERT_LE(line_length(control_, out.text()), 79U);
    }
  }
  // A centre off across the bisector by e makes a mismatch of 2 e sin(sweep / 2), and e is never
  // more than plain rounding has: half a step on both axes. The mean of plain rounding on these
  // arcs is 0.307 steps; seeking a centre near the bisector must be felt.
  EXPECT_LE(worst, std::sqrt(2) + 1e-6);
  EXPECT_LT(mean, 0.25);
}

TEST_P(WrittenArcs, LeadToTheWritersOwnPosition) {
  std::mt19937 random(2);
  for (int i = 0; i < 2000; ++i) {
    const RandomArc wanted = random_arc(random, control_);
    const Point3 start = on_grid(wanted.arc.start, control_, wanted.units);
    Writer out = writer_from(start, wanted.units);
    ASSERT_TRUE(out.arc_to(wanted.arc, 1000));
    const ReadArc read = read_back(out.text(), start, wanted.units);
    ASSERT_EQ(read.end, out.state().position.mm) << out.text();
    ASSERT_EQ(read.plane, out.state().modal.plane);
  }
}

// The middle of the printed arc against the middle of the wanted one: this sees a wrong plane, a
// wrong direction and a wrong side of the chord.
TEST_P(WrittenArcs, GoTheWayThatWasWanted) {
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    const RandomArc wanted = random_arc(random, control_);
    const Point3 start = on_grid(wanted.arc.start, control_, wanted.units);
    Writer out = writer_from(start, wanted.units);
    ASSERT_TRUE(out.arc_to(wanted.arc, 1000));
    const ReadArc read = read_back(out.text(), start, wanted.units);
    const Vector3 axis = Vector3::Unit(3 - read.first - read.second);
    const double sweep = (read.clockwise ? -1 : 1) * std::abs(wanted.arc.sweep);
    const double rise = (read.end - read.start).dot(axis);
    const Arc half = arc_about(read.start, read.start + read.offset, axis, sweep / 2, rise / 2);
    const Arc& arc = wanted.arc;
    const Arc wanted_half = arc_about(arc.start, arc.center, arc.axis, arc.sweep / 2,
                                      (arc.end - arc.start).dot(arc.axis) / 2);
    const double step = printed_step(place_format(control_, wanted.units), wanted.units);
    ASSERT_LT((half.end - wanted_half.end).norm(), 2.5 * step) << out.text();
  }
}

INSTANTIATE_TEST_SUITE_P(Writer, WrittenArcs, testing::Values("linuxcnc", "grbl"),
                         [](const auto& test) { return test.param; });

TEST(Writer, PrintedPlacesAreItsOwnPosition) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-500, 500);
  for (const Control& each : controls()) {
    for (const Units units : {Units::kMillimetre, Units::kInch}) {
      Writer out(each, {cutting(units), {Point3::Zero(), {true, true, true}}}, "\n");
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

// --- byte for byte
// --------------------------------------------------------------------------------

// A contour with lines, arcs in three planes, a helix, a feed change and a comment, then restored.
std::string contour(std::string_view control, Units units) {
  const double mm = millimetres_per(units);
  ModalState before = cutting(units);
  before.motion = MotionMode::kRapid;
  Writer out = writer_at(control, before, Point3::Zero());
  out.use_coordinates(arc_end_format(*find_control(control), units));
  out.line_to(mm * Point3(1.5, 0, 0), *before.feed);
  const auto arc = [&](const Point3& center, const Vector3& axis, double sweep, double rise) {
    const Point3 start = out.state().position.mm;
    if (!out.arc_to(arc_about(start, mm * center, axis, sweep, mm * rise), *before.feed / 2)) {
      throw std::runtime_error("arc refused");
    }
  };
  arc({1.5, 0.75, 0}, Vector3::UnitZ(), kPi / 3, 0);
  out.copy_line("(second wall)");
  arc({1.5, 0.75, 0}, Vector3::UnitZ(), kPi / 7, -0.125);
  arc({2, 2, -1}, Vector3::UnitY(), -1.0, 0);
  arc({0, 0.25, 0}, Vector3::UnitX(), 0.5, 0);
  out.line_to(mm * Point3(1.0 / 3, -2.0 / 3, 1), *before.feed);
  out.restore(cutting(units));
  return out.text();
}

std::string expected_text(const std::string& file) {
  const auto folder = std::filesystem::path(BATTEN_SOURCE_DIR) / "tests" / "cases";
  std::ifstream in(folder / "written_moves" / file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

struct ContourCase {
  std::string control;
  Units units;
  std::string file;
};

class ContourText : public testing::TestWithParam<ContourCase> {};

TEST_P(ContourText, IsByteForByteTheCase) {
  const ContourCase& test = GetParam();
  EXPECT_EQ(contour(test.control, test.units), expected_text(test.file));
}

INSTANTIATE_TEST_SUITE_P(Writer, ContourText,
                         testing::Values(ContourCase{"linuxcnc", Units::kMillimetre,
                                                     "linuxcnc_mm.ngc"},
                                         ContourCase{"linuxcnc", Units::kInch, "linuxcnc_inch.ngc"},
                                         ContourCase{"grbl", Units::kMillimetre, "grbl_mm.nc"},
                                         ContourCase{"grbl", Units::kInch, "grbl_inch.nc"}),
                         [](const auto& test) {
                           const auto& file = test.param.file;
                           return file.substr(0, file.find('.'));
                         });

}  // namespace
}  // namespace batten::gcode
