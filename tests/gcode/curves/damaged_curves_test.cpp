// Curve blocks with damaged bytes: read to a curve that starts where the tool stands and is
// finite, or refused; nothing is thrown.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "gcode/curves/heidenhain_spl.h"
#include "gcode/curves/nurbs.h"
#include "gcode/curves/siemens_bspline.h"
#include "gcode/curves/siemens_poly.h"
#include "tests/support/curve_texts.h"
#include "tests/support/klartext_arc_alarms.h"
#include "tests/support/nurbs_alarms.h"
#include "tests/support/places.h"
#include "tests/support/poly_alarms.h"
#include "tests/support/spl_alarms.h"

namespace batten::gcode {
namespace {

using geometry::Point3;

constexpr Units kMm = Units::kMillimetre;
constexpr int kDamages = 1000;

std::string case_text(const std::string& file) {
  std::ifstream in(std::string(BATTEN_SOURCE_DIR "/tests/cases/golden_curve/") + file);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
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
  const CurveStart start = curve_tests::starting_at(Point3::Zero());
  int found = 0;
  for (std::uint32_t at = 0; at < program.blocks.size(); ++at) {
    for (const CurveResult& result :
         {read_nurbs(program, at, start, fanuc_nurbs(kMm)),
          read_nurbs(program, at, start, mitsubishi_nurbs()), read_poly(program, at, start),
          read_bspline(program, at, start, BsplineUse::kAcceptedUnverified),
          read_spl(program, at, start)}) {
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
  (void)nurbs_alarms(program, fanuc_nurbs(kMm));
  (void)poly_alarms(program);
  (void)spl_alarms(program, kMm);
  (void)klartext_arc_alarms(program, kMm);
  return found;
}

class DamagedCurves : public testing::TestWithParam<const char*> {};

TEST_P(DamagedCurves, AreReadAsCurvesOrRefused) {
  const std::string text = case_text(GetParam());
  ASSERT_FALSE(text.empty());
  std::mt19937 random(11);
  int read = 0;
  for (int i = 0; i < kDamages; ++i) {
    const std::string bad = damaged(text, random);
    SCOPED_TRACE(bad);
    read += curves_in(curve_tests::parsed(bad)) > 0 ? 1 : 0;
  }
  EXPECT_GT(read, 0);
}

INSTANTIATE_TEST_SUITE_P(Cases, DamagedCurves,
                         testing::Values("fanuc.nc", "mitsubishi.nc", "siemens_poly.mpf",
                                         "siemens_bspline.mpf", "heidenhain.h"),
                         [](const auto& test) {
                           const std::string name = test.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace batten::gcode
