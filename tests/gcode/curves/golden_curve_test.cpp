// The golden curve in the words of every control, as files: tests/cases/golden_curve.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "gcode/curves/heidenhain_spl.h"
#include "gcode/curves/nurbs.h"
#include "gcode/curves/siemens_bspline.h"
#include "gcode/curves/siemens_poly.h"
#include "tests/support/curve_texts.h"
#include "tests/support/nurbs_alarms.h"
#include "tests/support/places.h"
#include "tests/support/poly_alarms.h"
#include "tests/support/spl_alarms.h"

namespace batten::gcode {
namespace {

using geometry::Point3;

constexpr Units kMm = Units::kMillimetre;

struct GoldenCase {
  const char* file;
  CurveSetting setting;
  CurveWriting (*write)(const CurveSetting&);
  CurveResult (*read)(const Program&, const CurveStart&);
  CurveAlarms (*alarms)(const Program&);
};

CurveSetting with_points() {
  CurveSetting setting;
  setting.places = {.decimals = 3, .always_point = true};
  setting.other = setting.places;
  setting.feeds = setting.places;
  setting.axes = {true, true, false};
  setting.feed = 3000;
  return setting;
}

CurveSetting with_three_axes() {
  CurveSetting setting = with_points();
  setting.axes = {true, true, true};
  return setting;
}

CurveSetting plain() {
  CurveSetting setting;
  setting.places = {.decimals = 4};
  setting.other = {.decimals = 6};
  setting.axes = {true, true, false};
  return setting;
}

CurveSetting plain_with_feed() {
  CurveSetting setting = plain();
  setting.feed = 3000;
  return setting;
}

NurbsRules fanuc_with_weights() {
  NurbsRules rules = fanuc_nurbs(kMm);
  rules.weights = true;
  return rules;
}

const std::vector<GoldenCase>& golden_cases() {
  using curve_tests::golden_curve;
  static const std::vector<GoldenCase> kCases = {
      {"fanuc.nc", with_points(),
       [](const CurveSetting& s) { return write_nurbs(golden_curve(), s, fanuc_with_weights()); },
       [](const Program& p, const CurveStart& at) {
         return read_nurbs(p, 1, at, fanuc_with_weights());
       },
       [](const Program& p) { return nurbs_alarms(p, fanuc_with_weights()); }},
      {"syntec.nc", with_points(),
       [](const CurveSetting& s) { return write_nurbs(golden_curve(), s, syntec_nurbs(kMm)); },
       [](const Program& p, const CurveStart& at) {
         return read_nurbs(p, 1, at, syntec_nurbs(kMm));
       },
       [](const Program& p) { return nurbs_alarms(p, syntec_nurbs(kMm)); }},
      {"mitsubishi.nc", with_three_axes(),
       [](const CurveSetting& s) { return write_nurbs(golden_curve(), s, mitsubishi_nurbs()); },
       [](const Program& p, const CurveStart& at) {
         return read_nurbs(p, 1, at, mitsubishi_nurbs());
       },
       [](const Program& p) { return nurbs_alarms(p, mitsubishi_nurbs()); }},
      {"siemens_poly.mpf", plain(),
       [](const CurveSetting& s) { return write_poly(golden_curve().bezier_pieces(), s); },
       [](const Program& p, const CurveStart& at) { return read_poly(p, 1, at); },
       [](const Program& p) { return poly_alarms(p); }},
      {"siemens_bspline.mpf", plain(),
       [](const CurveSetting& s) {
         return write_bspline(golden_curve(), s, BsplineUse::kAcceptedUnverified);
       },
       [](const Program& p, const CurveStart& at) {
         return read_bspline(p, 1, at, BsplineUse::kAcceptedUnverified);
       },
       [](const Program& p) { return poly_alarms(p); }},
      {"heidenhain.h", plain_with_feed(),
       [](const CurveSetting& s) {
         return write_spl(golden_curve().bezier_pieces(), s, {.first_number = 8});
       },
       [](const Program& p, const CurveStart& at) { return read_spl(p, 1, at); },
       [](const Program& p) { return spl_alarms(p, kMm); }}};
  return kCases;
}

std::string bytes_of(const char* file) {
  std::ifstream in(std::string(BATTEN_SOURCE_DIR "/tests/cases/golden_curve/") + file);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

class GoldenCurve : public testing::TestWithParam<std::size_t> {
 protected:
  [[nodiscard]] const GoldenCase& golden() const { return golden_cases()[GetParam()]; }
};

TEST_P(GoldenCurve, IsWrittenByteForByte) {
  const std::string text = bytes_of(golden().file);
  ASSERT_FALSE(text.empty()) << golden().file;
  const std::size_t begin = text.find('\n') + 1;
  const std::size_t end = text.rfind('\n', text.size() - 2) + 1;
  EXPECT_EQ(curve_tests::text_of(golden().write(golden().setting)),
            text.substr(begin, end - begin));
}

TEST_P(GoldenCurve, IsReadAtItsFiveValues) {
  const auto result = golden().read(curve_tests::parsed(bytes_of(golden().file)),
                                    curve_tests::starting_at(Point3::Zero()));
  ASSERT_TRUE(std::holds_alternative<CurveReading>(result)) << std::get<CurveRefusal>(result).why;
  const auto& motions = std::get<CurveReading>(result).motions;
  ASSERT_EQ(motions.size(), 2U);
  for (const auto& [u, x, y] : curve_tests::kGoldenValues) {
    const Point3 at = u <= 0.4 ? geometry::point_at(motions[0].piece, u / 0.4)
                               : geometry::point_at(motions[1].piece, (u - 0.4) / 0.6);
    EXPECT_LT((at - Point3(x, y, 0)).norm(), 1e-12) << u;
  }
}

TEST_P(GoldenCurve, GivesNoAlarm) {
  const CurveAlarms alarms = golden().alarms(curve_tests::parsed(bytes_of(golden().file)));
  EXPECT_EQ(curve_tests::short_forms(alarms), std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Cases, GoldenCurve, testing::Range<std::size_t>(0, 6),
                         [](const auto& test) {
                           std::string name = golden_cases()[test.param].file;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace batten::gcode
