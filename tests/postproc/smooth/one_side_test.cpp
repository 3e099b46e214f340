// --side: from the option to the written program, and what the verifier makes of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gcode/state/reason.h"
#include "geometry/fitting/one_sided/one_sided_fair.h"
#include "geometry/path/path.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::Point3;
using geometry::Side;

constexpr double kTolerance = 0.05;

SmoothOptions one_sided(Side side, double tolerance = kTolerance) {
  SmoothOptions options = options_for("linuxcnc");
  options.tolerance_mm = tolerance;
  options.side = side;
  return options;
}

Verification verdict_of(const std::string& before, const std::string& after, Side side,
                        double tolerance = kTolerance) {
  const ReadText old_text(before);
  const ReadText new_text(after);
  return verify({&old_text.program, &old_text.meaning}, {&new_text.program, &new_text.meaning},
                {tolerance, geometry::ToleranceKind::kPath, side});
}

std::string noisy_wave(double height = 2) {
  return wave_program({.lines = 300, .height = height, .noise = 0.01});
}

// The cutting moves of a program in the plane, as places a hundredth of a millimetre apart.
std::vector<Point3> places_of(const std::string& text, double step) {
  std::vector<Point3> places;
  const ReadText read(text);
  for (const gcode::Motion& motion : read.meaning.motions) {
    if (motion.kind == gcode::MotionKind::kRapid || !motion.start_known) continue;
    const int parts = static_cast<int>(geometry::length_of(motion.piece) / step) + 1;
    for (int k = 0; k <= parts; ++k) {
      places.push_back(geometry::point_at(motion.piece, static_cast<double>(k) / parts));
    }
  }
  return places;
}

// The signed distance to the left of the nearest place of a polyline.
double left_of_polyline(const Point3& place, const std::vector<Point3>& line) {
  double nearest = std::numeric_limits<double>::infinity();
  double left = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const geometry::Vector3 along = line[i + 1] - line[i];
    if (along.norm() < 1e-9) continue;
    const double t = std::clamp((place - line[i]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const geometry::Vector3 off = place - line[i] - t * along;
    if (off.norm() < nearest) {
      nearest = off.norm();
      left = (along.x() * off.y() - along.y() * off.x()) / along.norm();
    }
  }
  return left;
}

TEST(OneSided, NoisyWaveIsSmoothedOnTheAllowedSideOnly) {
  const std::string before = noisy_wave();
  const std::vector<Point3> line = places_of(before, 1e9);
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const SmoothResult result = smoothed(before, one_sided(side));
    ASSERT_EQ(rewritten_runs(result), 1u) << name_of(side);
    EXPECT_TRUE(result.proved);
    EXPECT_LE(result.deviation_mm, kTolerance);
    EXPECT_TRUE(verdict_of(before, result.text, side).proved());
    const double sign = side == Side::kLeft ? 1 : -1;
    double furthest = 0;
    for (const Point3& place : places_of(result.text, 0.05)) {
      const double left = sign * left_of_polyline(place, line);
      EXPECT_GE(left, -kOverSide * kTolerance) << place.transpose();
      furthest = std::max(furthest, left);
    }
    EXPECT_GT(furthest, 0.005) << "it has to go somewhere";
  }
}

TEST(OneSided, ACircleIsLeftOnItsInsideOrItsOutside) {
  std::string text = "G21 G90 G17\nG0 X10 Y0 Z5\nG1 Z-1 F300\n";
  for (int i = 1; i <= 180; ++i) {
    const double angle = i * 3.14159265358979 / 90;
    text += fmt::format("G1 X{:.4f} Y{:.4f}{}\n", 10 * std::cos(angle), 10 * std::sin(angle),
                        i == 1 ? " F2000" : "");
  }
  text += "G0 Z5\nM2\n";
  for (const Side side : {Side::kLeft, Side::kRight}) {
    SmoothOptions options = one_sided(side);
    options.output = Form::kArcs;  // a longer way outside takes more time
    const SmoothResult result = smoothed(text, options);
    ASSERT_EQ(rewritten_runs(result), 1u) << name_of(side);
    EXPECT_TRUE(verdict_of(text, result.text, side).proved());
    const Side other = side == Side::kLeft ? Side::kRight : Side::kLeft;
    EXPECT_FALSE(verdict_of(text, result.text, other).proved());
  }
}

// What has nothing to smooth has nothing to move.
TEST(OneSided, StraightLinesStayWhereTheyAre) {
  std::vector<Point3> points;
  for (int i = 0; i <= 100; ++i) points.emplace_back(0.5 * i, 0, 0);
  geometry::OneSidedOptions options;
  options.fair.tolerance = kTolerance;
  options.margin = 0.005;
  const auto path = geometry::one_sided_fair_path(points, options);
  ASSERT_TRUE(path);
  for (const double u : path->vertex_parameters) {
    EXPECT_LT(std::abs(path->curve.point_at(u).y()), 1e-9);
  }
}

TEST(OneSided, TheMirroredRunGivesTheMirroredCurve) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.004);
  std::vector<Point3> points;
  for (int i = 0; i <= 200; ++i) {
    points.emplace_back(0.2 * i, 3 * std::sin(0.05 * i) + noise(random), 0.01 * i);
  }
  std::vector<Point3> mirrored = points;
  for (Point3& p : mirrored) p.y() = -p.y();
  geometry::OneSidedOptions options;
  options.fair.tolerance = kTolerance;
  options.margin = 0.002;
  const auto left = geometry::one_sided_fair_path(points, options);
  options.side = Side::kRight;
  const auto right = geometry::one_sided_fair_path(mirrored, options);
  ASSERT_TRUE(left);
  ASSERT_TRUE(right);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Point3 there = right->curve.point_at(right->vertex_parameters[i]);
    there.y() = -there.y();
    EXPECT_LT((left->curve.point_at(left->vertex_parameters[i]) - there).norm(), 1e-6);
  }
}

TEST(OneSided, PointsThatStandStillAreNoMatter) {
  std::vector<Point3> points = {{0, 0, 0}, {0, 0, 0}, {5, 0.1, 0}, {5, 0.1, 0}, {10, 0, 0}};
  geometry::OneSidedOptions options;
  options.fair.tolerance = kTolerance;
  const auto path = geometry::one_sided_fair_path(points, options);
  ASSERT_TRUE(path);
  ASSERT_EQ(path->vertex_parameters.size(), points.size());
  EXPECT_EQ(path->vertex_parameters[0], path->vertex_parameters[1]);
  EXPECT_TRUE(std::ranges::is_sorted(path->vertex_parameters));
}

// --- the proof ----------------------------------------------------------------------------------

// A path with a corner to either side, moved by hand.
std::string cornered(double off) {
  return fmt::format(
      "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\nG1 X10 Y{0:.4f} F1000\nX20 Y{0:.4f}\nX{1:.4f} Y10\n"
      "X30 Y{2:.4f}\nX40 Y10\nG0 Z5\nM2\n",
      off, 20 - off, 10 + off);
}

TEST(SideProof, RefusesTheWrongSideAndAcceptsTheOther) {
  const std::string before = cornered(0);
  const std::string left = cornered(0.02);
  EXPECT_TRUE(verdict_of(before, left, Side::kBoth).proved());
  const Verification right_one = verdict_of(before, left, Side::kLeft);
  EXPECT_TRUE(right_one.proved()) << right_one.violations[0].message;
  const Verification wrong = verdict_of(before, left, Side::kRight);
  ASSERT_FALSE(wrong.proved());
  EXPECT_EQ(wrong.violations[0].kind, ViolationKind::kSide);
  EXPECT_EQ(wrong.violations[0].id, "wrong-side");
  EXPECT_GE(wrong.violations[0].new_line, 4u);
  EXPECT_LE(wrong.violations[0].new_line, 8u);
}

TEST(SideProof, AllowsATenthOfTheToleranceForRounding) {
  const std::string before = cornered(0);
  EXPECT_TRUE(verdict_of(before, cornered(0.9 * kOverSide * kTolerance), Side::kRight).proved());
  EXPECT_FALSE(verdict_of(before, cornered(1.2 * kOverSide * kTolerance), Side::kRight).proved());
  // The tolerance is the same on the allowed side.
  EXPECT_FALSE(verdict_of(cornered(0), cornered(1.1 * kTolerance), Side::kLeft).proved());
}

TEST(SideOption, NeedsThePathReading) {
  SmoothOptions options = one_sided(Side::kLeft);
  EXPECT_TRUE(problems_of(options).empty());
  options.tolerance_kind = geometry::ToleranceKind::kBand;
  ASSERT_EQ(problems_of(options).size(), 1u);
  EXPECT_TRUE(problems_of(options)[0].starts_with("--side:"));
}

}  // namespace
}  // namespace batten::postproc
