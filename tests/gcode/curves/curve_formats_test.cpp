// What holds for the curve words of every control: the golden curve as files
// (tests/cases/golden_curve), random curves that are read within the rounding of their digits,
// damaged texts, and tables of what is read and refused.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <regex>
#include <sstream>
#include <string>

#include "gcode/curves/curve_print.h"
#include "gcode/curves/g5_curve.h"
#include "gcode/curves/heidenhain_spl.h"
#include "gcode/curves/nurbs.h"
#include "gcode/curves/siemens_curves.h"
#include "gcode/writer/block_numbers.h"
#include "geometry/distance/path_distance.h"
#include "tests/support/curve_texts.h"
#include "tests/support/places.h"

namespace batten::gcode {
namespace {

using curve_tests::curve_of;
using curve_tests::golden_curve;
using curve_tests::reading_of;
using curve_tests::refusal_of;
using curve_tests::starting_at;
using curve_tests::text_of;
using geometry::BsplineCurve;
using geometry::CubicBezier;
using geometry::Point3;

constexpr Units kMm = Units::kMillimetre;

// The proof takes each curve apart into thousands of chords; so many seeds show that it holds.
constexpr std::uint32_t kProvedSeeds = 5;

struct FormatCase {
  std::string name;
  const char* file = "";  // the golden curve; empty: none
  const CurveFormat* format = nullptr;
  const char* line = "";  // what every line that is written matches: the digits that controls take
  Language language = Language::kRs274;
  NumberFormat places = {.decimals = 4};
  bool feed_in_golden = true;
  double within = 0;            // mm: how far rounding may move a random curve
  double proved_within = 1e-3;  // mm
};

// Half a step on every axis for the points, one step for the knots.
double moved_by_points_and_knots(double step) { return (std::sqrt(3.0) / 2 + 1) * step; }

// Ends move by half a step on every axis, and the curve with them; a coefficient that is off by e
// moves the middle by e / 4 (p^2) and 0.385 e (p^3), which the control points exceed by a third.
double moved_by_ends_and_coefficients() { return std::sqrt(3.0) * (0.5e-4 + 0.5e-6); }

const std::vector<FormatCase>& cases() {
  constexpr NumberFormat kPoint = {.decimals = 3, .always_point = true};
  constexpr NumberFormat kFinePoint = {.decimals = 4, .always_point = true};
  const double coarse = moved_by_points_and_knots(1e-3);
  const double fine = moved_by_points_and_knots(1e-4);
  const double ends = moved_by_ends_and_coefficients();
  static const std::vector<FormatCase> kCases = {
      {.name = "fanuc",
       .file = "fanuc.nc",
       .format = &fanuc_curves(),
       .line = R"((G06\.2 P4 )?K\d{1,6}\.\d{0,3}( [XYZ]-?\d{1,6}\.\d{0,3})*( F\d+\.)?)",
       .places = kPoint,
       .within = coarse,
       .proved_within = coarse},
      {.name = "syntec",
       .file = "syntec.nc",
       .format = &syntec_curves(),
       .line = R"(G05 P10000|G05 P0|)"
               R"((G06\.2 P4 )?K\d{1,6}\.\d{0,3}(( [XYZ]-?\d{1,6}\.\d{0,3})+ R1\.( F\d+\.)?)?)",
       .places = kPoint,
       .within = coarse,
       .proved_within = coarse},
      {.name = "mitsubishi",
       .file = "mitsubishi.nc",
       .format = &mitsubishi_curves(),
       .line = R"(G05 P10000|G05 P0|)"
               R"((G06\.2 P4 )?K\d{1,4}\.\d{0,4}(( [XYZ]-?\d{1,6}\.\d{0,3}){3}( F\d+\.)?)?)",
       .places = kPoint,
       .within = coarse,
       .proved_within = coarse},
      {.name = "mitsubishi_fine",
       .format = &mitsubishi_curves(),
       .line = R"(G05 P10000|G05 P0|)"
               R"((G06\.2 P4 )?K\d{1,4}\.\d{0,4}(( [XYZ]-?\d{1,6}\.\d{0,4}){3}( F\d+\.)?)?)",
       .places = kFinePoint,
       .within = fine,
       .proved_within = fine},
      {.name = "siemens_poly",
       .file = "siemens_poly.mpf",
       .format = &siemens_poly(),
       .line = R"((POLY )?PO\[X\]=\([-,.\d]+\)( PO\[[YZ]\]=\([-,.\d]+\))*( F\d+)?)",
       .language = Language::kSiemens,
       .feed_in_golden = false,
       .within = ends},
      {.name = "siemens_bspline",
       .file = "siemens_bspline.mpf",
       .format = &siemens_bspline(),
       .line = R"((BSPLINE SD=3 )?X[-.\d]+( [YZ][-.\d]+)+ PL=\d{1,5}(\.\d{1,4})?( F\d+)?)",
       .language = Language::kSiemens,
       .feed_in_golden = false,
       .within = fine,
       .proved_within = fine},
      {.name = "heidenhain",
       .file = "heidenhain.h",
       .format = &heidenhain_spl(),
       .line = R"(SPL( [XYZ][+-]\d{1,5}(\.\d{1,4})?)+ ~|)"
               R"(  (K[123][XYZ][+-]\d(\.\d{1,8})?(E\+\d{3})? ?){3}(~|F\d+)?)",
       .language = Language::kKlartext,
       .within = ends}};
  return kCases;
}

std::string bytes_of(const char* file) {
  std::ifstream in(std::string(BATTEN_SOURCE_DIR "/tests/cases/golden_curve/") + file);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

class CurveFormats : public testing::TestWithParam<std::size_t> {
 protected:
  const FormatCase& case_ = cases()[GetParam()];
  const CurveFormat& format_ = *case_.format;

  [[nodiscard]] CurveSetting setting() const {
    CurveSetting setting;
    setting.places = case_.places;
    setting.other = format_.other_mm;
    setting.feeds = {.decimals = 3, .always_point = case_.places.always_point};
    return setting;
  }
  [[nodiscard]] Program parsed(const std::string& text) const {
    return curve_tests::parsed(text, case_.language);
  }
};

BsplineCurve scaled(const BsplineCurve& curve, double factor) {
  std::vector<Point3> points = curve.control_points();
  for (Point3& point : points) point *= factor;
  return {curve.basis(), points};
}

TEST_P(CurveFormats, WriteTheGoldenCurveByteForByte) {
  if (*case_.file == '\0') return;
  const std::string text = bytes_of(case_.file);
  ASSERT_FALSE(text.empty()) << case_.file;
  const std::size_t begin = text.find('\n') + 1;
  const std::size_t end = text.rfind('\n', text.size() - 2) + 1;
  for (const Units units : {kMm, Units::kInch}) {
    CurveSetting golden = setting();
    golden.units = units;
    golden.axes = {true, true, format_.names_all_axes};
    if (case_.feed_in_golden) golden.feed = 3000 * millimetres_per(units);
    const BsplineCurve curve = scaled(golden_curve(), millimetres_per(units));
    std::string written = text_of(format_.write(curve, golden));
    if (case_.language == Language::kKlartext) written = postproc::with_numbers(written, 8);
    EXPECT_EQ(written, text.substr(begin, end - begin));
  }
}

TEST_P(CurveFormats, ReadTheGoldenCurveAtItsFiveValues) {
  if (*case_.file == '\0') return;
  const Program program = parsed(bytes_of(case_.file));
  for (const Units units : {kMm, Units::kInch}) {
    const double unit = millimetres_per(units);
    const auto motions =
        reading_of(format_.read(program, 1, starting_at(Point3::Zero(), units))).motions;
    ASSERT_EQ(motions.size(), 2U);
    for (const auto& [u, x, y] : curve_tests::kGoldenValues) {
      const Point3 at = u <= 0.4 ? geometry::point_at(motions[0].piece, u / 0.4)
                                 : geometry::point_at(motions[1].piece, (u - 0.4) / 0.6);
      EXPECT_LT((at / unit - Point3(x, y, 0)).norm(), 1e-12) << u;
    }
    // Two-fold insertion of the knot 0.4 by hand.
    const auto& piece = std::get<CubicBezier>(motions[0].piece);
    EXPECT_LT((piece.control[2] / unit - Point3(14, 4, 0)).norm(), 1e-12);
    EXPECT_LT((piece.control[3] / unit - Point3(18, 6.4, 0)).norm(), 1e-12);
  }
  const CurveStart nowhere = {{Point3::Zero(), {true, false, true}}, kMm};
  EXPECT_EQ(refusal_of(format_.read(program, 1, nowhere)), "the tool's position is not known");
}

// The block before a curve: where the tool stands.
std::string approach(const Point3& start, Language language) {
  const auto text = [](double value) { return to_text(value, {.decimals = 3}); };
  const bool klartext = language == Language::kKlartext;
  return (klartext ? "1 L X" : "G1 X") + text(start.x()) + " Y" + text(start.y()) + " Z" +
         text(start.z()) + " F100\n";
}

TEST_P(CurveFormats, ReadRandomCurvesWithinTheirRounding) {
  const std::regex shape(case_.line);
  double worst = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << case_.name << ", seed " << seed);
    const bool in_space = seed % 2 != 0;
    const BsplineCurve curve = curve_tests::random_curve(seed, in_space);
    const std::vector<CubicBezier> pieces = curve.bezier_pieces();
    CurveSetting wanted = setting();
    wanted.start = curve.control_points().front();
    wanted.axes = {true, true, in_space || format_.names_all_axes};
    wanted.feed = 900;
    const std::string text = text_of(format_.write(curve, wanted));
    const std::string before = approach(wanted.start, case_.language);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_TRUE(std::regex_match(line, shape)) << line;
    }
    const CurveReading reading =
        reading_of(format_.read(parsed(before + text), 1, starting_at(wanted.start)));
    EXPECT_EQ(reading.blocks, curve_tests::lines_in(text));
    EXPECT_EQ(reading.axes, wanted.axes);
    EXPECT_EQ(reading.feed, 900);
    const auto read = curve_tests::beziers_of(reading);
    ASSERT_EQ(read.size(), pieces.size());
    EXPECT_EQ(read[0].control[0], wanted.start);
    for (std::size_t i = 1; i < read.size(); ++i) {
      EXPECT_LT((read[i].control[0] - read[i - 1].control[3]).norm(), 1e-12) << "does not chain";
    }
    const double move = greatest_move(pieces, read);
    EXPECT_LE(move, case_.within);
    worst = std::max(worst, move);
    if (seed >= kProvedSeeds) continue;
    EXPECT_EQ(geometry::compare_paths(curve_tests::pieces_of(curve),
                                      curve_tests::pieces_of(reading), case_.proved_within)
                  .verdict,
              geometry::Verdict::kProved);
  }
  EXPECT_GT(worst, 0.1 * case_.within) << "nothing was rounded";
}

// One to three bytes exchanged, taken out, or put in, of those that such texts consist of.
std::string damaged(std::string text, std::mt19937& random) {
  constexpr std::string_view kBytes = "0123456789.-+=()[],~;XYZKPRGFEN \n";
  const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  for (std::size_t i = below(3) + 1; i > 0; --i) {
    const std::size_t at = below(text.size());
    const char byte = kBytes[below(kBytes.size())];
    switch (below(3)) {
      case 0:
        text[at] = byte;
        break;
      case 1:
        text.erase(at, 1);
        break;
      default:
        text.insert(at, 1, byte);
    }
  }
  return text;
}

// All readers at every block; how many curves they found.
int curves_in(const Program& program) {
  int found = 0;
  for (std::uint32_t at = 0; at < program.blocks.size(); ++at) {
    for (const FormatCase& each : cases()) {
      const CurveResult result = each.format->read(program, at, starting_at(Point3::Zero()));
      const auto* reading = std::get_if<CurveReading>(&result);
      if (reading == nullptr || reading->motions.empty()) continue;
      ++found;
      EXPECT_LE(at + reading->blocks, program.blocks.size());
      const Point3 first = geometry::start_point(reading->motions.front().piece);
      EXPECT_LT(first.cwiseAbs().maxCoeff(), kSplClosure);
      for (const CurveMotion& motion : reading->motions) {
        for (const double t : {0.0, 0.3, 1.0}) {
          EXPECT_TRUE(geometry::point_at(motion.piece, t).allFinite());
        }
      }
    }
  }
  return found;
}

// Read to a curve that starts where the tool stands and is finite, or refused; nothing is thrown.
TEST_P(CurveFormats, ReadDamagedBytesAsCurvesOrRefuseThem) {
  if (*case_.file == '\0') return;
  const std::string text = bytes_of(case_.file);
  std::mt19937 random(11);
  int read = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::string bad = damaged(text, random);
    SCOPED_TRACE(bad);
    read += curves_in(parsed(bad)) > 0 ? 1 : 0;
  }
  EXPECT_GT(read, 0);
}

INSTANTIATE_TEST_SUITE_P(Curves, CurveFormats, testing::Range<std::size_t>(0, 7),
                         [](const auto& test) { return cases()[test.param].name; });

// --- what forbids a curve -----------------------------------------------------------------------

TEST(CurveStates, ForbidACurveOfAnyControl) {
  const std::vector<void (*)(ModalState&)> changes = {
      [](ModalState& s) { s.cutter_compensation = TriState::kOn; },
      [](ModalState& s) { s.cutter_compensation = TriState::kUnknown; },
      [](ModalState& s) { s.feed_mode = FeedMode::kInverseTime; },
      [](ModalState& s) { s.feed_mode = FeedMode::kPerRevolution; },
      [](ModalState& s) { s.distance = DistanceMode::kIncremental; },
      [](ModalState& s) { s.polar = TriState::kOn; },
      [](ModalState& s) { s.scaling = TriState::kOn; },
      [](ModalState& s) { s.rotation = TriState::kOn; },
      [](ModalState& s) { s.mirror = TriState::kOn; },
      [](ModalState& s) { s.tilted_plane = TriState::kOn; },
      [](ModalState& s) { s.tool_center_point = TriState::kUnknown; }};
  for (const CurveFormat* format : {&fanuc_curves(), &siemens_poly(), &heidenhain_spl()}) {
    ModalState state;
    state.units = kMm;
    EXPECT_TRUE(may_start(*format, state));
    for (std::size_t i = 0; i < changes.size(); ++i) {
      ModalState changed = state;
      changes[i](changed);
      EXPECT_FALSE(may_start(*format, changed)) << format->name << ", change " << i;
    }
  }
}

TEST(CurveStates, OfG5AreInXy) {
  ModalState state;
  state.units = kMm;
  EXPECT_TRUE(may_start(linuxcnc_g5(), state));
  state.plane = Plane::kZX;
  EXPECT_FALSE(may_start(linuxcnc_g5(), state));
  EXPECT_TRUE(may_start(fanuc_curves(), state));
}

// --- what is written ----------------------------------------------------------------------------

// A setting for the golden curve in X and Y.
CurveSetting setting_of(const CurveFormat& format) {
  CurveSetting setting;
  setting.places = {.decimals = format.other_mm.always_point ? 3 : 4,
                    .always_point = format.other_mm.always_point};
  setting.other = format.other_mm;
  setting.axes = {true, true, false};
  return setting;
}

std::string written(
    const CurveFormat& format, const BsplineCurve& curve,
    void (*change)(CurveSetting&) = [](CurveSetting&) {}) {
  CurveSetting setting = setting_of(format);
  change(setting);
  return text_of(format.write(curve, setting));
}

// The golden curve with one control point elsewhere.
BsplineCurve golden_with(std::size_t index, const Point3& point) {
  std::vector<Point3> points = golden_curve().control_points();
  points[index] = point;
  return {golden_curve().basis(), points};
}

TEST(CurveWriting, RefusesWhatItCannotSay) {
  const auto elsewhere = [](CurveSetting& setting) { setting.start = {0.01, 0, 0}; };
  for (const CurveFormat* format : {&siemens_poly(), &siemens_bspline(), &heidenhain_spl()}) {
    EXPECT_EQ(written(*format, golden_curve(), elsewhere),
              "the curve does not start at the tool's position");
  }
  EXPECT_EQ(written(heidenhain_spl(), golden_curve(),
                    [](CurveSetting& setting) { setting.axes[1] = false; }),
            "SPL names two axes or more");
  EXPECT_EQ(written(heidenhain_spl(), golden_with(4, {1.2e5, 2, 0})),
            "a position beyond 99999.9999");
  EXPECT_EQ(written(fanuc_curves(), golden_curve(),
                    [](CurveSetting& setting) { setting.start.x() = 0.0004; }),
            "the start has more decimals than the control reads");
  EXPECT_EQ(written(fanuc_curves(), golden_with(2, {20, 10, 1})), "an axis moves and has no word");
  EXPECT_EQ(written(fanuc_curves(), golden_curve(),
                    [](CurveSetting& setting) {
                      setting.axes = {false, false, false};
                    }),
            "no axis is named");
  EXPECT_EQ(written(mitsubishi_curves(), golden_curve()), "this control's G06.2 names X, Y and Z");
  EXPECT_EQ(written(fanuc_curves(), golden_with(2, {1e6, 10, 0})), "a position beyond 999999.999");
  const std::vector<Point3> points = golden_curve().control_points();
  const BsplineCurve loose(geometry::BsplineBasis(3, {0, 1, 2, 3, 4, 5, 6, 7, 8}), points);
  EXPECT_EQ(written(fanuc_curves(), loose), "G06.2 is written for clamped cubic curves only");
  EXPECT_EQ(written(siemens_bspline(), loose), "BSPLINE is written for clamped cubics only");
  for (const CurveFormat* format : {&fanuc_curves(), &siemens_bspline()}) {
    const BsplineCurve close(geometry::BsplineBasis::clamped(3, {0, 1e-10, 1}), points);
    EXPECT_EQ(written(*format, close), "distinct knots meet when they are rounded");
  }
}

TEST(CurveWriting, OfG062MeetsItsEndsWithMoreDecimalsWhereTheSourceHasThem) {
  const std::string text =
      written(fanuc_curves(), golden_with(4, {40.00034, 0, 0}), [](CurveSetting& setting) {
        setting.start = {0.00012, 0, 0};
        setting.last_decimals = 5;
      });
  EXPECT_NE(text.find("K0. X0.00012 "), std::string::npos) << text;
  EXPECT_NE(text.find("X40.00034 "), std::string::npos) << text;
}

TEST(CurveWriting, OfPolyLeavesOutZerosAtTheEnd) {
  const CubicBezier line{{{0, 0, 0}, {1, 2, 0}, {2, 4, 0}, {3, 6, 0}}};
  EXPECT_EQ(written(siemens_poly(), curve_of({line})), "POLY PO[X]=(3) PO[Y]=(6)\n");
}

TEST(CurveWriting, OfBsplineIsReported) {
  EXPECT_TRUE(siemens_bspline().caution.starts_with("BSPLINE is not verified"));
}

// With four, the curvature would jump where pieces meet.
TEST(CurveWriting, OfPolyHasSixDecimalsWherePiecesMeetAndFourAtItsEnd) {
  const Point3 joint(1.2345678, 2.3456789, 0);
  const CubicBezier pieces[] = {{{{0, 0, 0}, {0.5, 1, 0}, {1, 2, 0}, joint}},
                                {{joint, {1.5, 2.7, 0}, {2, 3, 0}, {3.3333333, 3.1, 0}}}};
  const std::string text = written(siemens_poly(), curve_of({pieces[0], pieces[1]}));
  EXPECT_NE(text.find("PO[X]=(1.234568,"), std::string::npos) << text;
  EXPECT_NE(text.find("PO[X]=(3.3333,"), std::string::npos) << text;
}

TEST(CurveWriting, OfPolyRoundsEndsWithoutKinks) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = curve_tests::random_curve(seed, true);
    CurveSetting setting = setting_of(siemens_poly());
    setting.axes = {true, true, true};
    setting.start = curve.control_points().front();
    const std::vector<CubicBezier> pieces = curve.bezier_pieces();
    const Program program = curve_tests::parsed(text_of(siemens_poly().write(curve, setting)));
    const auto read = curve_tests::beziers_of(
        reading_of(siemens_poly().read(program, 0, starting_at(setting.start))));
    for (std::size_t i = 1; i < read.size(); ++i) {
      EXPECT_EQ(read[i].control[0], read[i - 1].control[3]) << "blocks that do not chain";
      // Half a step e of a2 and a3 changes the derivative at the end by 3 e, at the start by
      // 2 e, on every axis.
      const double arriving = 3 * (pieces[i - 1].control[3] - pieces[i - 1].control[2]).norm();
      const double leaving = 3 * (pieces[i].control[1] - pieces[i].control[0]).norm();
      const double turn = std::sqrt(3.0) * 0.5e-6 * (3 / arriving + 2 / leaving);
      EXPECT_LE(kink_between(read[i - 1], read[i]),
                kink_between(pieces[i - 1], pieces[i]) + turn + 1e-9);
    }
  }
}

// Two pieces of 0.03 mm: a coefficient that is off by 0.0005 turns the joint by half a degree.
TEST(CurveWriting, OfSplTakesMoreDigitsWhereAJointWouldHaveAKink) {
  CubicBezier first{{{0, 0, 0}, {0.0101, 0.0023, 0}, {0.0199, 0.0049, 0}, {0.03, 0.008, 0}}};
  const geometry::Vector3 leg = first.control[3] - first.control[2];
  const Point3 joint = first.control[3];
  CubicBezier second{
      {joint, joint + leg, joint + Point3(0.0197, 0.0071, 0), joint + Point3(0.029, 0.011, 0)}};
  const std::string text = written(heidenhain_spl(), curve_of({first, second}),
                                   [](CurveSetting& setting) { setting.other.decimals = 3; });
  const Program program = curve_tests::parsed(text, Language::kKlartext);
  const auto read = curve_tests::beziers_of(
      reading_of(heidenhain_spl().read(program, 0, starting_at(Point3::Zero()))));
  EXPECT_LT(kink_between(read.at(0), read.at(1)), 0.1 * M_PI / 180);
  // The same a hundred thousand times as small: eight decimals are not enough.
  for (int i = 0; i < 4; ++i) {
    first.control[i] *= 1e-5;
    second.control[i] *= 1e-5;
  }
  EXPECT_EQ(written(heidenhain_spl(), curve_of({first, second}),
                    [](CurveSetting& setting) {
                      setting.places.decimals = 9;
                      setting.other.decimals = 8;
                    }),
            "rounding bends a joint by 0.1 degrees or more");
}

TEST(CurveWriting, OfSplFollowsTheRuleOfTheExponent) {
  const std::tuple<double, int, const char*> rows[] = {{0, 6, "+0"},
                                                       {-0.0000001, 6, "+0"},
                                                       {5.6, 6, "+5.6"},
                                                       {-0.0468812, 6, "-0.046881"},
                                                       {9.99999999, 8, "+9.99999999"},
                                                       {9.9999999, 6, "+1E+001"},
                                                       {10, 6, "+1E+001"},
                                                       {-12, 6, "-1.2E+001"},
                                                       {12.3456789, 6, "+1.2345679E+001"},
                                                       {99.9999999, 6, "+1E+002"},
                                                       {1234.5678912, 8, "+1.23456789E+003"}};
  for (const auto& [value, decimals, digits] : rows) {
    const auto printed = print_spl_coefficient(value, decimals);
    ASSERT_TRUE(printed);
    EXPECT_EQ(printed->digits, digits);
    EXPECT_DOUBLE_EQ(printed->value, std::stod(digits));
  }
}

// --- what is read -------------------------------------------------------------------------------

CurveReading read_of(const CurveFormat& format, const std::string& text, std::uint32_t first = 0,
                     const Point3& start = Point3::Zero()) {
  return reading_of(
      format.read(curve_tests::parsed(
                      text, &format == &heidenhain_spl() ? Language::kKlartext : Language::kRs274),
                  first, starting_at(start)));
}

// The sample of the Syntec mill manual, p. 21: a parabola of order 3.
TEST(CurveReading, OfG062ReadsTheSampleOfSyntec) {
  const CurveReading reading =
      read_of(syntec_curves(),
              "N001 G0 X0.0 Y0.0 Z0.0\nN002 G05 P10000\n"
              "N003 G06.2 P3 K0.0 X0.0 Y0.0 Z0.0 R1.0 F5000.\nN004 K0.0 X0.0 Y5.0 Z0.0 R1.0\n"
              "N005 K0.0 X5.0 Y5.0 Z0.0 R1.0\nN006 K1.0\nN007 K1.0\nN008 K1.0\nN009 G05 P0\n",
              1);
  EXPECT_EQ(reading.blocks, 8U);
  ASSERT_EQ(reading.motions.size(), 1U);
  EXPECT_LT((geometry::point_at(reading.motions[0].piece, 0.5) - Point3(1.25, 3.75, 0)).norm(),
            1e-12);
}

// Programming guide 840D advanced 04.00, p. 5-165, its places given: PL, a straight axis beside a
// curved one.
TEST(CurveReading, OfPolyReadsTheSampleWithIntervals) {
  const CurveReading reading = read_of(siemens_poly(),
                                       "N11 POLY PO[X]=(1,2.5,0.7) PO[Y]=(0.3,1,3.2) PL=1.5\n"
                                       "N12 PO[X]=(0,2.5,1.7) PO[Y]=(2.3,1.7) PL=3\n"
                                       "N25 X70 PO[Y]=(9.3,1,7.67) PL=5\n"
                                       "N30 G1 X0 Y0 Z0\n");
  ASSERT_EQ(reading.motions.size(), 3U);
  EXPECT_EQ(reading.blocks, 3U);
  const auto at = [&](std::size_t piece, double p, double length) {
    return geometry::point_at(reading.motions[piece].piece, p / length);
  };
  // p = 0.5 of N11.
  const double a1 = (1 - 2.5 * 2.25 - 0.7 * 3.375) / 1.5;
  EXPECT_NEAR(at(0, 0.5, 1.5).x(), 0.5 * a1 + 2.5 * 0.25 + 0.7 * 0.125, 1e-12);
  EXPECT_LT((at(0, 1.5, 1.5) - Point3(1, 0.3, 0)).norm(), 1e-12);
  EXPECT_LT((at(1, 0, 3) - Point3(1, 0.3, 0)).norm(), 1e-12);
  // Straight in X: halfway at half the interval.
  EXPECT_NEAR(at(2, 2.5, 5).x(), 35, 1e-9);
  EXPECT_LT((at(2, 5, 5) - Point3(70, 9.3, 0)).norm(), 1e-9);
}

// A quarter circle: programming guide 840D advanced 04.00, p. 5-167.
TEST(CurveReading, OfPolyReadsADenominator) {
  const CurveReading reading =
      read_of(siemens_poly(), "POLY G90 X10 Y0 F100\nPO[X]=(0,-10) PO[Y]=(10) PO[]=(2,1)\nG1 X0\n");
  EXPECT_EQ(reading.blocks, 2U);
  EXPECT_TRUE(reading.is_near);
  ASSERT_GT(reading.motions.size(), 2U);
  EXPECT_EQ(geometry::start_point(reading.motions[1].piece), Point3(10, 0, 0));
  EXPECT_EQ(geometry::end_point(reading.motions.back().piece), Point3(0, 10, 0));
  for (std::size_t i = 1; i < reading.motions.size(); ++i) {
    EXPECT_EQ(reading.motions[i].block, 1U);
    for (int k = 0; k <= 10; ++k) {
      const Point3 on = geometry::point_at(reading.motions[i].piece, k / 10.0);
      EXPECT_NEAR(on.norm(), 10, kReadWithin);
    }
  }
}

// Z goes evenly with p.
TEST(CurveReading, OfPolyReadsTheFifthDegree) {
  const CurveReading reading =
      read_of(siemens_poly(), "POLY PO[X]=(2,1,1,0,1) PO[Y]=(3,0.5) Z=1 PL=2\n");
  EXPECT_TRUE(reading.is_near);
  EXPECT_EQ(reading.axes, (std::array<bool, 3>{true, true, true}));
  ASSERT_GT(reading.motions.size(), 1U);
  const double x1 = (2 - 1 * 4 - 1 * 8 - 1 * 32) / 2.0;
  const double y1 = (3 - 0.5 * 4) / 2;
  for (const CurveMotion& motion : reading.motions) {
    for (int k = 0; k <= 8; ++k) {
      const Point3 on = geometry::point_at(motion.piece, k / 8.0);
      const double p = 2 * on.z();
      const Point3 expected(x1 * p + p * p + p * p * p + std::pow(p, 5), y1 * p + 0.5 * p * p,
                            on.z());
      EXPECT_LT((on - expected).norm(), kReadWithin) << p;
    }
  }
}

// Quarter of a circle: weights 1, sqrt(1/2), 1.
TEST(CurveReading, OfG062ReadsWeights) {
  const CurveReading reading =
      read_of(fanuc_curves(),
              "G06.2 P3 K0 X0 Y0 R1\nK0 X0 Y10 R.70710678118654752\nK0 X10 Y10 R1\nK1\nK1\nK1\n");
  EXPECT_TRUE(reading.is_near);
  EXPECT_EQ(reading.blocks, 6U);
  ASSERT_FALSE(reading.motions.empty());
  for (const CurveMotion& motion : reading.motions) {
    EXPECT_EQ(motion.block, 2U);
    for (int k = 0; k <= 10; ++k) {
      const Point3 on = geometry::point_at(motion.piece, k / 10.0);
      EXPECT_NEAR((on - Point3(10, 0, 0)).norm(), 10, kReadWithin);
    }
  }
}

TEST(CurveReading, OfG062IsExactWhereAllWeightsAreTheSame) {
  constexpr const char* kText =
      "G06.2 K0 X0 Y0 R2\nK0 X1 Y2 R2\nK0 X2 Y0 R2\nK0 X3 Y1 R2\nK1\nK1\nK1\nK1\n";
  const CurveReading reading = read_of(fanuc_curves(), kText);
  EXPECT_FALSE(reading.is_near);
  EXPECT_EQ(reading.motions.size(), 1U);
}

TEST(CurveReading, OfPolyTakesLinesAndWordsWithAndWithoutBlanks) {
  const CurveReading line =
      read_of(siemens_poly(), "POLY G90 X10 Y0 F100\nPO[X]=(4) PO[]=(1)\nG1 X3\nPO[X]=(4,1)\n");
  ASSERT_EQ(line.motions.size(), 2U);
  EXPECT_EQ(line.feed, 100);
  EXPECT_TRUE(std::holds_alternative<geometry::Line>(line.motions[0].piece));
  const CurveReading blanks =
      read_of(siemens_poly(), "N10 POLY PO[X] = (0.25, 0.5 ,-1)PL=2 Z=3Y-.5 ; PO[Y]=(1)\n");
  EXPECT_EQ(geometry::end_point(blanks.motions.at(0).piece), Point3(0.25, -0.5, 3));
}

// iTNC 530 user manual 60642x-04, p. 539: two blocks in three axes.
TEST(CurveReading, OfSplReadsTheSampleOfTheManual) {
  const Point3 start(28.338, 19.385, -0.5);
  const CurveReading reading = read_of(heidenhain_spl(),
                                       "7 L X+28.338 Y+19.385 Z-0.5 FMAX\n"
                                       "8 SPL X24.875 Y15,924 Z-0.5\n"
                                       "K3X-4.688E-002 K2X2.459E-002 K1X3.486E+000\n"
                                       "K3Y-4.563 E-2 K2Y2.155E-002 K1Y3.486E+000\n"
                                       "K3Z0.000E+000 K2Z0.000E+000 K1Z0.000E+000 F10000\n"
                                       "9 SPL X17.952 Y9.003 Z-0.500\n"
                                       "K3X5.159E-002 K2X-5.644E-002 K1X6.928E+000\n"
                                       "K3Y3.753E-002 K2Y-2.644E-002 K1Y6.910E+000\n"
                                       "K3Z0.000E+000 K2Z0.000E+000 K1Z0.000E+000\n",
                                       1, start);
  ASSERT_EQ(reading.motions.size(), 2U);
  EXPECT_EQ(reading.blocks, 8U);
  EXPECT_EQ(reading.feed, 10000);
  const auto pieces = curve_tests::beziers_of(reading);
  const geometry::Vector3 first = pieces[0].control[0] - start;
  const geometry::Vector3 second = pieces[1].control[0] - pieces[0].control[3];
  // Sums of the printed numbers: 0.71 and 0.92 um, then 0.15 and 0.09 um.
  EXPECT_NEAR(first.x(), 0.00071, 1e-9);
  EXPECT_NEAR(first.y(), 0.00092, 1e-9);
  EXPECT_NEAR(second.x(), 0.00015, 1e-9);
  EXPECT_NEAR(second.y(), 0.00009, 1e-9);
  EXPECT_NEAR(kink_between(pieces[0], pieces[1]) * 180 / M_PI, 0.0007, 0.00005);
}

TEST(CurveReading, OfSplEndsWhereABlockHasAFeedOfItsOwn) {
  const std::string block = "SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0 F5\n";
  const std::string next = "SPL X+6 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0 F6\n";
  const CurveReading reading = read_of(heidenhain_spl(), block + next);
  EXPECT_EQ(reading.blocks, 3U);
  EXPECT_EQ(reading.motions.size(), 1U);
}

// --- what is refused ----------------------------------------------------------------------------

struct Refused {
  const char* text;
  const char* why;
};

void expect_refused(const CurveFormat& format, Language language, std::span<const Refused> rows) {
  for (const auto& [text, why] : rows) {
    const Program program = curve_tests::parsed(text, language);
    EXPECT_EQ(refusal_of(format.read(program, 0, starting_at(Point3::Zero()))), why) << text;
  }
}

TEST(CurveReading, OfG062RefusesWhatIsAnAlarmOfTheControl) {
  constexpr const char* kOthers = "other words inside the curve";
  const Refused rows[] = {
      {"G1 X1\n", "no G06.2"},
      {"(c)\n", "no G06.2"},
      {"G6.1 X1 K0\n", "no G06.2"},
      {"G05 P10000\n", "no G06.2"},
      {"", "no block"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nX2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n", "a block without a knot"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nG1 X5\n", kOthers},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\n",
       "the program ends inside the curve"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nG0 X5\n", kOthers},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK.1 X3 Y0\nK1\nK1\nK1\nK1\n",
       "the first or the last knots are not all the same"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK2\n",
       "the first or the last knots are not all the same"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1 X4 Y0\nK1 X5 Y0\nK1 X6 Y0\nK1 X7 Y0\n"
       "K1 X8 Y0\nK2\nK2\nK2\nK2\n",
       "an inner knot is repeated as often as the order"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK0 X4 Y0\nK1\nK1\nK1\nK1\n",
       "a knot is repeated more often than the order"},
      {"G06.2 K0 X.001 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
       "the first point is not the tool's position"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0 M8\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n", kOthers},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0 Z1\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
       "an axis that the first block does not name"},
      {"G06.2 P5 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
       "P5, expected P2 to P4"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK.6 X4 Y0\nK.5 X5 Y0\nK1\nK1\nK1\nK1\n",
       "a knot that decreases"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK1\nK1\nK1\nK1\n", "fewer points than the order"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1 X4 Y0\nK1\nK1\nK1\n",
       "a point after the ending knots"},
      {"G06.2 K0 X0 Y0\nK0 X1 Y0 R0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
       "a weight that is not positive"}};
  expect_refused(fanuc_curves(), Language::kRs274, rows);
}

TEST(CurveReading, InAFrameRefusesWhatIsOutsideOfOne) {
  const Refused rows[] = {
      {"G06.2 K0 X0 Y0 Z0\nK0 X1\nK0 X2\nK0 X3\nK1\nK1\nK1\nK1\n", "no G05 P10000 before it"},
      {"G5P10000\nG06.2 K0 X0 Y0 Z0\nK0 X1\nK0 X2\nK0 X3\nK1\nK1\nK1\nK1\nG1\n",
       "no G05 P0 after it"},
      {"G5P10000\nG06.2 K0 X0 Y0\nK0 X1\nK0 X2 Z1\nK0 X3\nK1\nK1\nK1\nK1\nG5P0\n",
       "X, Y and Z are not all named beside G06.2"}};
  expect_refused(mitsubishi_curves(), Language::kRs274, rows);
}

TEST(CurveReading, OfPolyRefusesWhatItDoesNotUnderstand) {
  constexpr const char* kNegative = "a denominator that changes too much or is not positive";
  std::vector<Refused> rows = {{"G1 X1\nPO[X]=(2,1)\n", "no POLY"},
                               {"POLY PO[X]=(2,1) PL=0.00001\n", "PL out of range"},
                               {"POLY PO[X]=(2,1) PO[]=(1,8)\n", kNegative},
                               {"POLY PO[X]=(2,1) PO[]=(-1)\n", kNegative},
                               {"G41 D1\nPOLY PO[X]=(2,1)\n", "no POLY"}};
  for (const char* text :
       {"POLY PO[X]=(R1,1)\n", "POLY PO[X]=(2,1) M8\n", "POLY X=R1\n", "POLY X=AC(10)\n",
        "POLY X1=10\n", "POLY MSG(\"a\")\n", "POLY X1EX3\n", "POLY PO[X]=(1,2\n", "POLY PO[X=(1)\n",
        "POLY X\n", "LABEL: POLY X1\n", "POLY X--1\n", "POLY PO[X]=()\n", "POLY X=1000000000\n",
        "POLY PO[X]=(1) PO[A]=(2)\n"}) {
    rows.push_back({text, "no POLY"});
  }
  expect_refused(siemens_poly(), Language::kSiemens, rows);
}

TEST(CurveReading, OfBsplineRefusesIntervalsThatAreNoClampedCubic) {
  constexpr const char* kLoose = "PL of the blocks is no clamped cubic";
  const Refused rows[] = {{"BSPLINE SD=3 X1 PL=1\nX2 PL=0\n", kLoose},
                          {"BSPLINE X1 PL=1\nX2 PL=0\nX3 PL=1\n", kLoose},
                          {"BSPLINE X1 PL=0\nX2 PL=0\nX3 PL=0\n", kLoose},
                          {"BSPLINE X1 PL=0\nX2 PL=1\nX3 PL=0\nX4 PL=0\n", kLoose},
                          {"G1 X1\n", "no BSPLINE"},
                          {"BSPLINE SD=2 X1 PL=1\n", "no BSPLINE"},
                          {"BSPLINE X1\n", "no BSPLINE"}};
  expect_refused(siemens_bspline(), Language::kSiemens, rows);
}

TEST(CurveReading, OfSplRefusesWhatItDoesNotUnderstand) {
  std::vector<Refused> rows = {{"1 L X+0 Y+0\n", "no SPL"},
                               {"2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-2.9989 ~\n K3Y+0 K2Y+0 K1Y+0\n",
                                "a spline that starts 1 um or more from the tool's position"}};
  // The last one is the manual's sample in five axes, which does not close and misprints K1Y.
  for (const char* text :
       {"2 SPL X+3 A+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3A+0 K2A+0 K1A+0\n",
        "2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0\n",
        "2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n",
        "2 SPL X+3 Y+0 ~\n K1X-3 K2X+0 K3X+0 ~\n K3Y+0 K2Y+0 K1Y+0\n",
        "2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3X+0 K2X+0 K1X-3\n",
        "2 SPL X+3 ~\n K3X+0 K2X+0 K1X-3\n",
        "2 SPL X+3 Y+0 RL ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0\n",
        "2 SPL X+3 Y+0 ~\n3 K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0\n",
        "2 SPL X+3 Y+0 ~\n K3X+0 K2X+E2 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0\n",
        "2 SPL X+3 Y+1000000000 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0\n", "8 SPL X+\n",
        "8 SPL ~ X+1\n",
        "8 SPL X+39.824 Y-28.378 Z+77.425 A+17.32 B-12.75\nK3X+0.0983 K2X-0.441 K1X-5.5724\n"
        "K3Y-0.0422 K2Y+0.1893 K1Y+2.3929\nK3Z+0.0015 K2Z-0.9549 K1Z+3.0875\n"
        "K3A+0.1283 K2A-0.141 K1A-0.5724\nK3B+0.0083 K2B-0.413 E+2 K1B-1.5724 E+1 F10000\n"}) {
    rows.push_back({text, "an SPL block that is not understood"});
  }
  expect_refused(heidenhain_spl(), Language::kKlartext, rows);
}

}  // namespace
}  // namespace batten::gcode
