// SPL with too few digits: its polynomials do not begin where the blocks before them end, which the
// proof finds, and the run goes back.
#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "gcode/curves/curve_format.h"
#include "tests/support/klartext_programs.h"
#include "tests/support/random_curves.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// Behind each K, the digits behind its point: K3X-6.25E+001 becomes K3X-6E+001.
void cut_digits(std::string& line) {
  for (std::size_t k = line.find('K'); k != std::string::npos; k = line.find('K', k + 1)) {
    const std::size_t end = std::min(line.find(' ', k), line.size());
    const std::size_t point = line.find('.', k);
    if (point >= end) continue;
    const std::size_t behind = std::min(line.find_first_not_of("0123456789", point + 1), end);
    line.erase(point, behind - point);
  }
}

TEST(CoarseSplines, AreNotProvedAndGoBack) {
  const gcode::Control& fine = *gcode::find_control("itnc530");
  // As SPL, with no digit behind the point of its coefficients.
  int written = 0;
  gcode::CurveFormat coarse = *fine.curves;
  coarse.write = [&](const geometry::BsplineCurve& curve, const gcode::CurveSetting& setting) {
    gcode::CurveWriting text = fine.curves->write(curve, setting);
    auto* lines = std::get_if<gcode::CurveLines>(&text);
    if (lines == nullptr) return text;
    for (std::string& line : *lines) cut_digits(line);
    ++written;
    return text;
  };
  gcode::Control target = fine;
  target.curves = &coarse;
  target.planes = {false, false, false};  // splines or what was there
  const std::string before =
      tests::numbered_from_zero(tests::klartext_program_of(tests::random_curve(1, true)));
  SmoothOptions options = options_for("itnc530");
  options.output = Form::kCurves;
  ASSERT_NE(smoothed(before, options).text.find("SPL"), std::string::npos);
  options.target = &target;
  const SmoothResult result = smoothed(before, options);
  EXPECT_GT(written, 0);
  EXPECT_EQ(result.text.find("SPL"), std::string::npos);
  // What is left of it is the program as it was, or lines that were proved.
  EXPECT_TRUE(result.proved || result.text == before);
}

}  // namespace
}  // namespace batten::postproc
