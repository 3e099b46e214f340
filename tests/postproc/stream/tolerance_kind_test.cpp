// The two readings of the tolerance, from the option to the proof of the text.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/method_cases.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::ToleranceKind;

constexpr double kTolerance = 0.05;

std::string star_program() {
  const auto points = geometry::star_path();
  std::string text = fmt::format("G21 G90 G17\nG0 X{:.4f} Y{:.4f} Z5\nG1 Z0 F300\nF3000\n",
                                 points[0].x(), points[0].y());
  for (std::size_t i = 1; i < points.size(); ++i) {
    text += fmt::format("G1 X{:.4f} Y{:.4f}\n", points[i].x(), points[i].y());
  }
  return text + "G0 Z5\nM2\n";
}

SmoothResult smoothed_star(ToleranceKind kind) {
  SmoothOptions options = options_for("fanuc");
  options.method = Method::kGuo;
  options.output = Form::kArcs;
  options.tolerance_mm = kTolerance;
  options.tolerance_kind = kind;
  return smoothed(star_program(), options);
}

Verification verdict_of(const SmoothResult& result, ToleranceKind kind) {
  const ReadText before(star_program());
  const ReadText after(result.text);
  return verify({&before.program, &before.meaning}, {&after.program, &after.meaning},
                {kTolerance, kind});
}

// The tips have 36 degrees between their legs: bands of 0.05 meet 0.05 / sin(18) = 0.162 away.
TEST(ToleranceKind, OfABandLetsCornersBeCutByAllOfIt) {
  const SmoothResult band = smoothed_star(ToleranceKind::kBand);
  ASSERT_EQ(rewritten_runs(band), 1u);
  EXPECT_TRUE(band.proved);
  EXPECT_LE(band.deviation_mm, kTolerance);
  const double bound = kTolerance / std::sin(18 * std::numbers::pi / 180);
  EXPECT_GT(band.corner_mm, 1.5 * kTolerance);
  EXPECT_LE(band.corner_mm, bound);
  EXPECT_TRUE(verdict_of(band, ToleranceKind::kBand).proved());
  EXPECT_FALSE(verdict_of(band, ToleranceKind::kPath).proved());
}

TEST(ToleranceKind, OfAPathIsTheDefaultAndCutsNoCornerFurther) {
  EXPECT_EQ(SmoothOptions{}.tolerance_kind, ToleranceKind::kPath);
  const SmoothResult path = smoothed_star(ToleranceKind::kPath);
  ASSERT_EQ(rewritten_runs(path), 1u);
  EXPECT_EQ(path.corner_mm, 0);
  EXPECT_TRUE(verdict_of(path, ToleranceKind::kPath).proved());
  EXPECT_TRUE(verdict_of(path, ToleranceKind::kBand).proved()) << "the looser reading";
  EXPECT_LT(smoothed_star(ToleranceKind::kBand).runs_after_s, path.runs_after_s);
}

// A shift of the whole path by a little more than the tolerance is no cut corner.
TEST(ToleranceKind, OfABandFindsAShiftedPath) {
  SmoothResult shifted;
  const double x = geometry::star_path()[3].x();
  shifted.text =
      replaced(star_program(), fmt::format("X{:.4f}", x), fmt::format("X{:.4f}", x + 0.2));
  EXPECT_FALSE(verdict_of(shifted, ToleranceKind::kBand).proved());
}

}  // namespace
}  // namespace batten::postproc
