// What holds for the curve words of every control: the golden curve as files
// (tests/cases/golden_curve), random curves that are read within the rounding of their digits, and
// damaged texts.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "gcode/curves/g5_curve.h"
#include "gcode/curves/heidenhain_spl.h"
#include "gcode/curves/nurbs.h"
#include "gcode/curves/siemens_curves.h"
#include "gcode/writer/block_numbers.h"
#include "geometry/distance/path_distance.h"
#include "tests/support/curve_texts.h"
#include "tests/support/klartext_arc_alarms.h"
#include "tests/support/nurbs_alarms.h"
#include "tests/support/places.h"
#include "tests/support/poly_alarms.h"
#include "tests/support/spl_alarms.h"

namespace batten::gcode {
namespace {

using curve_tests::reading_of;
using curve_tests::starting_at;
using curve_tests::text_of;
using geometry::BsplineCurve;
using geometry::CubicBezier;
using geometry::Point3;

constexpr Units kMm = Units::kMillimetre;

// The proof takes each curve apart into thousands of chords; so many seeds show that it holds.
constexpr std::uint32_t kProvedSeeds = 5;

CurveAlarms no_alarms(const Program&) { return {}; }

struct FormatCase {
  std::string name;
  const char* file = "";  // the golden curve; empty: none
  CurveFormat format;
  Language language = Language::kRs274;
  NumberFormat places = {.decimals = 4};
  bool all_axes = false;
  bool feed_in_golden = true;
  double within = 0;            // mm: how far rounding may move a random curve
  double proved_within = 1e-3;  // mm
  CurveAlarms (*alarms)(const Program&) = &no_alarms;
};

NurbsRules fanuc_with_weights(Units units) {
  NurbsRules rules = fanuc_nurbs(units);
  rules.weights = true;
  return rules;
}

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
      {"fanuc", "fanuc.nc", nurbs_format(fanuc_with_weights), Language::kRs274, kPoint, false, true,
       coarse, coarse, [](const Program& p) { return nurbs_alarms(p, fanuc_with_weights(kMm)); }},
      {"fanuc_without_weights", "", fanuc_curves(), Language::kRs274, kPoint, false, true, coarse,
       coarse, [](const Program& p) { return nurbs_alarms(p, fanuc_nurbs(kMm)); }},
      {"syntec", "syntec.nc", syntec_curves(), Language::kRs274, kPoint, false, true, coarse,
       coarse, [](const Program& p) { return nurbs_alarms(p, syntec_nurbs(kMm)); }},
      {"mitsubishi", "mitsubishi.nc", mitsubishi_curves(), Language::kRs274, kPoint, true, true,
       moved_by_points_and_knots(1e-3), coarse,
       [](const Program& p) { return nurbs_alarms(p, mitsubishi_nurbs(kMm)); }},
      {"mitsubishi_fine", "", mitsubishi_curves(), Language::kRs274, kFinePoint, true, true, fine,
       fine, [](const Program& p) { return nurbs_alarms(p, mitsubishi_nurbs(kMm)); }},
      {"siemens_poly",
       "siemens_poly.mpf",
       siemens_poly(),
       Language::kSiemens,
       {.decimals = 4},
       false,
       false,
       ends,
       1e-3,
       &poly_alarms},
      {"siemens_bspline",
       "siemens_bspline.mpf",
       siemens_bspline(),
       Language::kSiemens,
       {.decimals = 4},
       false,
       false,
       fine,
       fine,
       &poly_alarms},
      {"heidenhain",
       "heidenhain.h",
       heidenhain_spl(),
       Language::kKlartext,
       {.decimals = 4},
       false,
       true,
       ends,
       1e-3,
       [](const Program& p) { return spl_alarms(p, kMm); }}};
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

  [[nodiscard]] CurveSetting setting() const {
    CurveSetting setting;
    setting.places = case_.places;
    setting.other = case_.format.other_mm;
    setting.feeds = {.decimals = 3, .always_point = case_.places.always_point};
    return setting;
  }
  [[nodiscard]] Program parsed(const std::string& text) const {
    return curve_tests::parsed(text, case_.language);
  }
};

TEST_P(CurveFormats, WriteTheGoldenCurveByteForByte) {
  if (*case_.file == '\0') return;
  const std::string text = bytes_of(case_.file);
  ASSERT_FALSE(text.empty()) << case_.file;
  const std::size_t begin = text.find('\n') + 1;
  const std::size_t end = text.rfind('\n', text.size() - 2) + 1;
  CurveSetting golden = setting();
  golden.axes = {true, true, case_.all_axes};
  if (case_.feed_in_golden) golden.feed = 3000;
  std::string written = text_of(case_.format.write(curve_tests::golden_curve(), golden));
  if (case_.language == Language::kKlartext) written = postproc::with_numbers(written, 8);
  EXPECT_EQ(written, text.substr(begin, end - begin));
}

TEST_P(CurveFormats, ReadTheGoldenCurveAtItsFiveValuesWithoutAlarms) {
  if (*case_.file == '\0') return;
  const Program program = parsed(bytes_of(case_.file));
  EXPECT_EQ(curve_tests::short_forms(case_.alarms(program)), std::vector<std::string>{});
  const auto motions =
      reading_of(case_.format.read(program, 1, starting_at(Point3::Zero()))).motions;
  ASSERT_EQ(motions.size(), 2U);
  for (const auto& [u, x, y] : curve_tests::kGoldenValues) {
    const Point3 at = u <= 0.4 ? geometry::point_at(motions[0].piece, u / 0.4)
                               : geometry::point_at(motions[1].piece, (u - 0.4) / 0.6);
    EXPECT_LT((at - Point3(x, y, 0)).norm(), 1e-12) << u;
  }
  // Two-fold insertion of the knot 0.4 by hand.
  const auto& piece = std::get<CubicBezier>(motions[0].piece);
  EXPECT_LT((piece.control[2] - Point3(14, 4, 0)).norm(), 1e-12);
  EXPECT_LT((piece.control[3] - Point3(18, 6.4, 0)).norm(), 1e-12);
}

// The block before a curve: where the tool stands.
std::string approach(const Point3& start, Language language) {
  const auto text = [](double value) { return to_text(value, {.decimals = 3}); };
  const bool klartext = language == Language::kKlartext;
  return (klartext ? "1 L X" : "G1 X") + text(start.x()) + " Y" + text(start.y()) + " Z" +
         text(start.z()) + " F100\n";
}

TEST_P(CurveFormats, ReadRandomCurvesWithinTheirRounding) {
  double worst = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << case_.name << ", seed " << seed);
    const bool in_space = seed % 2 != 0;
    const BsplineCurve curve = curve_tests::random_curve(seed, in_space);
    const std::vector<CubicBezier> pieces = curve.bezier_pieces();
    CurveSetting wanted = setting();
    wanted.start = curve.control_points().front();
    wanted.axes = {true, true, in_space || case_.format.names_all_axes};
    wanted.feed = 900;
    const std::string text = text_of(case_.format.write(curve, wanted));
    const std::string before = approach(wanted.start, case_.language);
    for (const CurveAlarm& alarm : case_.alarms(parsed(before + text + "G1\n"))) {
      // Corners of the given curve are kinks of its splines.
      EXPECT_EQ(alarm.id, "spl-kink") << text;
    }
    const CurveReading reading =
        reading_of(case_.format.read(parsed(before + text), 1, starting_at(wanted.start)));
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
      const CurveResult result = each.format.read(program, at, starting_at(Point3::Zero()));
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
  for (const FormatCase& each : cases()) (void)each.alarms(program);
  (void)klartext_arc_alarms(program, kMm);
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

INSTANTIATE_TEST_SUITE_P(Curves, CurveFormats, testing::Range<std::size_t>(0, 8),
                         [](const auto& test) { return cases()[test.param].name; });

// --- what forbids a curve -----------------------------------------------------------------------

struct ForbiddenState {
  std::string name;
  void (*change)(ModalState&);
};

class CurveStates : public testing::TestWithParam<ForbiddenState> {};

TEST_P(CurveStates, ForbidACurveOfAnyControl) {
  ModalState state;
  state.units = kMm;
  for (const CurveFormat* format : {&fanuc_curves(), &siemens_poly(), &heidenhain_spl()}) {
    EXPECT_TRUE(may_start(*format, state));
  }
  GetParam().change(state);
  for (const CurveFormat* format : {&fanuc_curves(), &siemens_poly(), &heidenhain_spl()}) {
    EXPECT_FALSE(may_start(*format, state)) << format->name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Curves, CurveStates,
    testing::Values(
        ForbiddenState{"G41", [](ModalState& s) { s.cutter_compensation = TriState::kOn; }},
        ForbiddenState{"PerhapsG41",
                       [](ModalState& s) { s.cutter_compensation = TriState::kUnknown; }},
        ForbiddenState{"G93", [](ModalState& s) { s.feed_mode = FeedMode::kInverseTime; }},
        ForbiddenState{"G95", [](ModalState& s) { s.feed_mode = FeedMode::kPerRevolution; }},
        ForbiddenState{"G91", [](ModalState& s) { s.distance = DistanceMode::kIncremental; }},
        ForbiddenState{"G12_1", [](ModalState& s) { s.polar = TriState::kOn; }},
        ForbiddenState{"G51", [](ModalState& s) { s.scaling = TriState::kOn; }},
        ForbiddenState{"G68", [](ModalState& s) { s.rotation = TriState::kOn; }},
        ForbiddenState{"Mirror", [](ModalState& s) { s.mirror = TriState::kOn; }},
        ForbiddenState{"Plane", [](ModalState& s) { s.tilted_plane = TriState::kOn; }},
        ForbiddenState{"PerhapsTraori",
                       [](ModalState& s) { s.tool_center_point = TriState::kUnknown; }}),
    [](const auto& test) { return test.param.name; });

TEST(CurveStates, OfG5AreInXy) {
  ModalState state;
  state.units = kMm;
  EXPECT_TRUE(may_start(linuxcnc_g5(), state));
  state.plane = Plane::kZX;
  EXPECT_FALSE(may_start(linuxcnc_g5(), state));
  EXPECT_TRUE(may_start(fanuc_curves(), state));
}

}  // namespace
}  // namespace batten::gcode
