// Parts of a long run do not cross each other where they did not, though each is smoothed and
// proved for itself.
#include "postproc/stream/part_crossings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "gcode/state/reason.h"
#include "gcode/text/source_text.h"
#include "geometry/band/tolerance_band.h"
#include "postproc/smooth/part_runs.h"
#include "tests/support/in_windows.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr double kCrossingTolerance = 0.01;
constexpr LongRunLimits kCrossingRuns = {.whole_at_most = 400, .shortest = 100, .longest = 200};
constexpr LongRunLimits kAsOne = {};

// Teeth of two straight sides, which are turned by `turn` (degrees) at each, and back beside them:
// `gap` below, and at the corners by `more` further away and nearer in turn. Corners are rounded on
// their inner side, and swing wide before and after that.
struct Teeth {
  double turn;
  double gap;
  double more;
};

std::string two_clusters(const Teeth& teeth) {
  constexpr int kEdges = 30;  // of a side
  constexpr int kSides = 8;
  constexpr double kEdge = 0.2;
  constexpr double kRound = 3;  // mm, the loop between the strands
  constexpr int kApproach = 60;
  const double slope = teeth.turn / 2 * std::numbers::pi / 180;
  std::vector<geometry::Point2> there{{0, 0}};
  for (int i = 0; i < kSides * kEdges; ++i) {
    const double up = i / kEdges % 2 == 0 ? 1 : -1;
    there.push_back(there.back() + kEdge * geometry::Point2(std::cos(slope), up * std::sin(slope)));
  }
  std::string text = "G21 G90 G17\nM3 S9000\nG0 X0 Y0 Z5\nG1 Z-1 F300\nG1 F2000\n";
  const auto to = [&](double x, double y) { text += fmt::format("X{:.4f} Y{:.4f}\n", x, y); };
  for (std::size_t i = 1; i < there.size(); ++i) to(there[i].x(), there[i].y());
  const geometry::Point2 end = there.back();
  for (int i = 1; i < 60; ++i) {
    const double angle = std::numbers::pi * i / 60;
    to(end.x() + kRound * std::sin(angle), end.y() - kRound * (1 - std::cos(angle)));
  }
  for (int i = kSides * kEdges; i >= 0; --i) {
    const double far = std::max(0.0, 1.0 - (kSides * kEdges - i) / static_cast<double>(kApproach));
    const bool corner = i % kEdges == 0 && i > 0 && i < kSides * kEdges;
    const double beside = corner ? (i / kEdges % 2 == 1 ? teeth.more : -teeth.more) : 0;
    const auto& p = there[static_cast<std::size_t>(i)];
    to(p.x(), p.y() - teeth.gap - 2 * kRound * far * far - beside);
  }
  return text + "G0 Z5\nM30\n";
}

std::vector<Teeth> all_teeth() {
  std::vector<Teeth> all;
  for (const double turn : {30, 60}) {
    for (const double gap : {0.004, 0.009}) {
      for (const double more : {0.003, 0.006}) {
        if (more < gap) all.push_back({turn, gap, more});
      }
    }
  }
  return all;
}

SmoothOptions asked() {
  SmoothOptions options = options_for("linuxcnc");
  options.method = Method::kFair;
  options.tolerance_mm = kCrossingTolerance;
  return options;
}

geometry::Path cuts_of(const std::string& text) {
  const ReadText read(text);
  geometry::Path path;
  for (const gcode::Motion& motion : read.meaning.motions) {
    if (motion.kind != gcode::MotionKind::kRapid && motion.piece.start().z() < 0) {
      path.push_back(motion.piece);
    }
  }
  return path;
}

bool crosses_anew(const std::string& before, const std::string& after) {
  const auto source = [](const geometry::Path& path) {
    return geometry::PathSource{path.size(), [&path](std::size_t i) { return path[i]; }};
  };
  const geometry::Path old_path = cuts_of(before);
  const geometry::Path new_path = cuts_of(after);
  return !geometry::new_crossings(source(old_path), source(new_path), kCrossingTolerance).empty();
}

std::size_t kept_for_crossing(const SmoothResult& result) {
  return static_cast<std::size_t>(std::ranges::count_if(result.runs, [](const RunReport& run) {
    return run.reason == gcode::reason::kCrossesItself;
  }));
}

TEST(PartCrossings, AreFoundByTheWholeAndByWindows) {
  std::size_t gave_back = 0;
  std::size_t crossing = 0;
  const WindowLimits limits{.least_blocks = 100, .long_runs = kCrossingRuns};
  for (const Teeth& teeth : all_teeth()) {
    SCOPED_TRACE(testing::Message() << teeth.turn << " " << teeth.gap << " " << teeth.more);
    const std::string text = two_clusters(teeth);
    SmoothOptions options = asked();
    ASSERT_FALSE(crosses_anew(text, text));
    const SmoothResult whole = as_a_whole(text, options, kCrossingRuns);
    ASSERT_TRUE(whole.proved);
    EXPECT_FALSE(crosses_anew(text, whole.text));
    EXPECT_GE(rewritten_runs(whole), 1U) << "what is not near to anything is smoothed";
    gave_back += kept_for_crossing(whole) > 0 ? 1 : 0;
    EXPECT_FALSE(crosses_anew(text, as_a_whole(text, options, kAsOne).text));
    for (const int threads : {1, 3}) {
      options.threads = threads;
      const InWindows windows = in_windows(text, options, limits);
      EXPECT_TRUE(windows.cut());
      expect_same(windows, whole);
      crossing += threads == 1 && windows.restarts > 0 ? 1 : 0;
    }
  }
  EXPECT_GE(gave_back, 3U) << "else nothing was asked";
  EXPECT_GE(crossing, 3U);
}

TEST(LineRanges, AreJoinedWhereTheyOverlap) {
  const std::vector<LineRange> others = {{5, 9}, {40, 41}};
  const std::vector<LineRange> all = joined({{20, 30}, {8, 12}, {21, 22}}, others);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].first, 5U);
  EXPECT_EQ(all[0].last, 12U);
  EXPECT_EQ(all[1].last, 30U);
  EXPECT_EQ(lines_in(all), 8U + 11U + 2U);
  for (const std::uint32_t line : {5U, 12U, 20U, 41U}) EXPECT_TRUE(holds(all, line)) << line;
  for (const std::uint32_t line : {4U, 13U, 31U, 42U}) EXPECT_FALSE(holds(all, line)) << line;
}

}  // namespace
}  // namespace batten::postproc
