// The path, the speeds and the columns of the report's page, against programs whose distances and
// speeds are known by hand.
#include "postproc/report/page_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "postproc/report/html_report.h"
#include "tests/support/interpreted.h"
#include "tests/support/machine_limits.h"
#include "tests/support/paths.h"
#include "tests/support/report_words.h"

namespace batten::postproc {
namespace {

using geometry::Point3;
using geometry::Vector3;

ReadProgram read_of(const tests::Interpreted& text) { return {&text.program, &text.read}; }

PagePath path_of(const std::string& before, const std::string& after, double tolerance,
                 const std::vector<PageLines>& runs = {}, std::size_t most = 1000) {
  const tests::Interpreted old_text(before);
  const tests::Interpreted new_text(after);
  const Verification found = verify(read_of(old_text), read_of(new_text), Promise(tolerance));
  EXPECT_TRUE(found.proved());
  return page_path(read_of(old_text), read_of(new_text), found, runs,
                   {tolerance, geometry::ToleranceKind::kPath, most});
}

const std::string kKinked = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F600\nX20 Y0.01\nX30 Y0\nG0 X0\n";
const std::string kStraight = "G21 G90\nG0 X0 Y0 Z0\nG1 X30 F600\nG0 X0\n";

const PageVertex& worst_of(const PagePath& path) {
  return *std::ranges::max_element(path.vertices, {},
                                   [](const PageVertex& v) { return v.offset.norm(); });
}

TEST(PagePath, ShowsTheDistanceThatTheProofFound) {
  const PagePath path = path_of(kKinked, kStraight, 0.02);
  const PageVertex& worst = worst_of(path);
  EXPECT_NEAR(worst.offset.norm(), 0.01, 1e-6);
  EXPECT_NEAR(worst.place.x(), 20, 1e-9);
  EXPECT_NEAR(worst.offset.y(), -0.01, 1e-6);
  EXPECT_EQ(worst.old_line, 4U);
  EXPECT_EQ(worst.new_line, 3U);
  EXPECT_EQ(path.sections, 1U);
  EXPECT_EQ(path.sections_not_shown, 0U);
}

TEST(PagePath, FollowsTheOldPathFromEndToEnd) {
  const PagePath path = path_of(kKinked, kStraight, 0.02);
  double length = 0;
  for (std::size_t i = 1; i < path.vertices.size(); ++i) {
    const PageVertex& v = path.vertices[i];
    const double step = (v.place - path.vertices[i - 1].place).norm();
    if (v.step == PageStep::kNone) {
      EXPECT_LT(step, 1e-9);  // no gap in this program
    } else if (v.step == PageStep::kRewritten) {
      length += step;
    }
  }
  EXPECT_NEAR(length, 10 + 2 * std::hypot(10, 0.01), 1e-6);
  EXPECT_EQ(path.vertices.back().step, PageStep::kRapid);
  EXPECT_EQ(path.vertices.back().place, Point3(0, 0, 0));
}

TEST(PagePath, TellsWhichRunAPlaceBelongsTo) {
  PageLines run;
  run.first_line = 3;
  run.last_line = 5;
  const PagePath path = path_of(kKinked, kStraight, 0.02, {run});
  for (const PageVertex& v : path.vertices) {
    EXPECT_EQ(v.run, v.old_line >= 3 && v.old_line <= 5 ? 0 : -1) << v.old_line;
  }
}

TEST(PagePath, HasNoDeviationWhereMovesAreCopied) {
  const PagePath path = path_of(kKinked, kKinked, 0.02);
  EXPECT_EQ(path.sections, 0U);
  for (const PageVertex& v : path.vertices) {
    EXPECT_TRUE(v.offset.isZero(0));
    EXPECT_NE(v.step, PageStep::kRewritten);
    EXPECT_EQ(v.new_line, v.old_line);
  }
}

TEST(PagePath, KeepsTheLinesOfCopiedMovesBehindARun) {
  const std::string tail = "M8\nG1 X40 Y5\nX50 Y0\n";
  const PagePath path = path_of(kKinked + tail, kStraight + tail, 0.02);
  EXPECT_EQ(path.vertices.back().old_line, 9U);
  EXPECT_EQ(path.vertices.back().new_line, 7U);
  EXPECT_EQ(path.vertices.back().step, PageStep::kCopied);
}

TEST(PagePath, BeginsAnewWhereThePlaceIsNotKnown) {
  const std::string text = "G21 G90\nG1 X0 Y0 Z0 F100\nX10\nG28\nG1 X50 Y50 Z0\nX60\n";
  const PagePath path = path_of(text, text, 0.02);
  for (std::size_t i = 1; i < path.vertices.size(); ++i) {
    if (path.vertices[i].step == PageStep::kNone) continue;
    EXPECT_LE((path.vertices[i].place - path.vertices[i - 1].place).norm(), 10 + 1e-9);
  }
}

TEST(PagePath, StaysWithinTheNumberOfVertices) {
  std::string before = "G21 G90\nG1 X0 Y0 Z0 F600\n";
  for (int i = 1; i <= 2000; ++i) {
    before += "X" + std::to_string(i) + " Y" + (i % 2 == 0 ? "0" : "0.5") + "\n";
  }
  EXPECT_LE(path_of(before, before, 0.02, {}, 500).vertices.size(), 500U);
  EXPECT_GE(path_of(before, before, 0.02, {}, 100000).vertices.size(), 2000U);
}

// A circle of radius 5 by its chords: the circle through three neighbouring vertices is that
// circle.
TEST(ChainCurvature, OfAPolygonIsThatOfItsCircle) {
  const geometry::Path chain = geometry::path_through(geometry::arc_path(5, 2, 40));
  const ChainCurvature curvature(chain);
  EXPECT_NEAR(curvature.at(10, geometry::start_point(chain[10])), 0.2, 1e-9);
  EXPECT_NEAR(curvature.at(10, geometry::end_point(chain[10])), 0.2, 1e-9);
}

TEST(ChainCurvature, OfAnArcIsItsOwn) {
  const geometry::Path chain = {geometry::Line{Point3(-3, -2, 0), Point3(0, -2, 0)},
                                geometry::Arc{Point3(0, -2, 0), Point3(2, 0, 0), Point3(0, 0, 0),
                                              Vector3(0, 0, 1), std::numbers::pi / 2}};
  const ChainCurvature curvature(chain);
  EXPECT_NEAR(curvature.at(1, Point3(std::sqrt(2), -std::sqrt(2), 0)), 0.5, 1e-12);
  EXPECT_EQ(curvature.at(0, Point3(-3, -2, 0)), 0);
  EXPECT_NEAR(curvature.at(0, Point3(0, -2, 0)), 0.5, 1e-12);
}

TEST(ShareOfPiece, OfAnArcGoesWithItsAngle) {
  const double s = std::sqrt(0.5);
  // Three quarters of a circle, clockwise from +x: -y after a third of it.
  const geometry::PathPiece arc = geometry::Arc{Point3(1, 0, 0), Point3(0, 1, 0), Point3(0, 0, 0),
                                                Vector3(0, 0, 1), -1.5 * std::numbers::pi};
  EXPECT_NEAR(share_of_piece(arc, Point3(0, -1, 0)), 1.0 / 3, 1e-12);
  EXPECT_NEAR(share_of_piece(arc, Point3(-s, s, 0)), 2.5 / 3, 1e-12);
  EXPECT_NEAR(share_of_piece(arc, Point3(0, 1, 0)), 1, 1e-9);
  EXPECT_NEAR(share_of_piece(arc, Point3(1, 0, 0)), 0, 1e-9);
}

PageVertex vertex(double x, double y, double speed = 0, double off = 0) {
  PageVertex v;
  v.place = Point3(x, y, 0);
  v.offset = Vector3(0, off, 0);
  v.step = PageStep::kCopied;
  v.speed_after = speed;
  return v;
}

TEST(Thinning, KeepsWhatIsFurtherOffThanTheErrors) {
  const auto left = [](const std::vector<PageVertex>& line) {
    return thinned(line, {0.001, 1}).size();
  };
  EXPECT_EQ(left({vertex(0, 0), vertex(1, 0), vertex(2, 0), vertex(3, 0)}), 2U) << "straight";
  EXPECT_EQ(left({vertex(0, 0), vertex(1, 0.002), vertex(2, 0)}), 3U) << "place";
  EXPECT_EQ(left({vertex(0, 0), vertex(1, 0, 0, 0.002), vertex(2, 0)}), 3U) << "offset";
  EXPECT_EQ(left({vertex(0, 0), vertex(1, 0, 5), vertex(2, 0)}), 3U) << "speed";
  EXPECT_EQ(left({vertex(0, 0), vertex(1, 0.0005, 0.5, 0.0005), vertex(2, 0)}), 2U) << "all near";
  EXPECT_EQ(left({vertex(0, 0), vertex(5, 0), vertex(2, 0)}), 3U) << "a fold on the way it came";
}

TEST(Thinning, KeepsWhereTheKindOfMoveChanges) {
  std::vector<PageVertex> line = {vertex(0, 0), vertex(1, 0), vertex(2, 0)};
  line[2].step = PageStep::kRewritten;
  EXPECT_EQ(thinned(line, {0.001, 1}).size(), 3U);
}

// --- speeds --------------------------------------------------------------------------------------

constexpr double kAcceleration = 100;  // mm/s^2

Machine steady_machine() {
  Machine m;
  m.name = "test";
  set_max_velocity(m, 400);
  set_max_acceleration(m, kAcceleration);
  set_rapid_velocity(m, 400);
  m.look_ahead = 1000;
  return m;
}

// From rest at 100 mm/s2: sqrt(2 a s) after s, 100 mm/s = 6000 mm/min in the middle. At a sharp
// corner of the generic control no axis changes its speed by more than a * period. With a limit on
// jerk: after 0.2 s at 500 mm/s3 it has 100 mm/s2, 10 mm/s and 2/3 mm after it; the rest of the
// first mm takes 0.0292 s at that acceleration.
TEST(ProgramSpeeds, AreThoseOfTheModel) {
  const Machine m = steady_machine();
  Machine with_jerk = m;
  set_max_jerk(with_jerk, 500);
  const std::string line = "G21 G90\nG0 X0 Y0 Z0\nG1 X100 F6000\n";
  const std::string slow = "G21 G90\nG0 X0 Y0 Z0\nG1 X100 F3000\n";
  const double after_a_mm = 60 * std::sqrt(2 * kAcceleration);
  const double at_corner = 60 * kAcceleration * m.servo_period;
  struct Row {
    const char* name;
    std::string program;
    const Machine& machine;
    std::size_t line;
    double share;
    double speed;
    double within;
  };
  const Row rows[] = {
      {"start", line, m, 3, 0, 0, 1e-9},
      {"after a mm", line, m, 3, 0.01, after_a_mm, 1e-6},
      {"middle", line, m, 3, 0.5, 6000, 1e-6},
      {"a mm before the end", line, m, 3, 0.99, after_a_mm, 1e-6},
      {"end", line, m, 3, 1, 0, 1e-9},
      {"rapid", "G21 G90\nG0 X0 Y0 Z0\nG0 X100\nG1 X0 F600\n", m, 3, 0.5, 0, 0},
      {"before a corner", slow + "Y100\n", m, 3, 1, at_corner, 1e-6},
      {"after it", slow + "Y100\n", m, 4, 0, at_corner, 1e-6},
      {"away from it", slow + "Y100\n", m, 4, 0.5, 3000, 1e-6},
      {"jerk, after a mm", slow, with_jerk, 3, 0.01, 60 * (10 + 0.0292 * kAcceleration), 4},
      {"jerk, middle", slow, with_jerk, 3, 0.5, 3000, 1e-3}};
  for (const Row& row : rows) {
    const tests::Interpreted text(row.program);
    const ProgramSpeeds speeds(read_of(text), list_events(read_of(text)), row.machine);
    const auto motion = static_cast<std::uint32_t>(text.line(row.line).motion);
    EXPECT_NEAR(speeds.at(motion, row.share), row.speed, row.within) << row.name;
  }
}

// --- columns, taken apart again ------------------------------------------------------------------

std::vector<std::uint8_t> bytes_of_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(letters.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  return bytes;
}

// Numbers that were packed as steps.
std::vector<std::int64_t> column(const Json& text) {
  std::vector<std::int64_t> numbers;
  std::uint64_t zigzag = 0;
  int shift = 0;
  std::int64_t last = 0;
  for (const std::uint8_t byte : bytes_of_base64(text.get<std::string>())) {
    zigzag |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
    shift += 7;
    if ((byte & 0x80U) != 0) continue;
    const auto half = static_cast<std::int64_t>(zigzag >> 1U);
    last += (zigzag & 1U) != 0 ? -half - 1 : half;
    numbers.push_back(last);
    zigzag = 0;
    shift = 0;
  }
  return numbers;
}

// A kink of 0.02 rad at 50 mm, and the straight line that may stand for it within 1 mm.
constexpr const char* kSlowKink = "G21 G90\nG0 X0 Y0 Z0\nG1 X50 Y0.5 F6000\nX100 Y0\n";
constexpr const char* kFast = "G21 G90\nG0 X0 Y0 Z0\nG1 X100 F6000\n";

// At the kink the Y axis turns round, from 0.01 v to -0.01 v, which this control allows by one
// servo period's acceleration; on the straight line there is room to reach the 6000 mm/min.
TEST(PageData, HasTheSpeedOfTheOldProgramBeforeAndOfTheNewOneAfter) {
  const gcode::SourceText source("part.nc", kSlowKink);
  const Machine machine = steady_machine();
  SmoothOptions options = linuxcnc_options();
  options.machine = &machine;
  options.tolerance_mm = 1;
  SmoothResult result;
  result.understood = true;
  result.proved = true;
  result.text = kFast;
  const Json path = page_data(
      {.source = source, .options = options, .result = result, .output_file = ""}, "")["path"];

  const std::vector<std::int64_t> x = column(path["x"]);
  const std::vector<std::int64_t> before = column(path["speed_before"]);
  const std::vector<std::int64_t> after = column(path["speed_after"]);
  ASSERT_EQ(x.size(), path["count"].get<std::size_t>());
  const double mm = path["unit_mm"];
  const double mm_per_min = path["speed_unit"];
  int kinks = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::abs(mm * static_cast<double>(x[i]) - 50) > 1e-6) continue;
    ++kinks;
    EXPECT_NEAR(mm_per_min * static_cast<double>(before[i]), 60 * 100 * machine.servo_period / 0.02,
                2 * mm_per_min);
    EXPECT_NEAR(mm_per_min * static_cast<double>(after[i]), 6000, 2 * mm_per_min);
  }
  EXPECT_GE(kinks, 1);
}

}  // namespace
}  // namespace batten::postproc
