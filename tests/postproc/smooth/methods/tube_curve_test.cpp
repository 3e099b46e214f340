// What the curve in a tube costs: counted, not timed.
#include "postproc/smooth/methods/tube_curve.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "geometry/fitting/tube/tube_smoothing.h"
#include "geometry/path/curve_pieces.h"
#include "postproc/machine/planner/feed_plan.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

// `feed`: mm/min.
CurveRequest request_at(double feed, double tolerance = 0.01) {
  CurveRequest request;
  request.tolerance = tolerance;
  request.limits = limits_of(*find_machine("high-speed"), feed);
  request.jerk = find_machine("high-speed")->max_jerk();
  return request;
}

// Lines that turn by 60 degrees, to one side and to the other: all vertices are corners.
std::vector<Point3> zigzag(int points, double edge = 2) {
  std::vector<Point3> run;
  for (int i = 0; i < points; ++i) {
    run.emplace_back(edge * i * std::cos(std::numbers::pi / 6), i % 2 == 0 ? 0 : edge / 2, 0);
  }
  return run;
}

// Circles with a ripple of 0.1 mm, one after the other up a helix: no vertex is a corner.
std::vector<Point3> rippled_helix(int points) {
  std::vector<Point3> run;
  for (int i = 0; i < points; ++i) {
    const double a = 0.05 * i;
    const double radius = 30 + 0.1 * std::sin(9 * a);
    run.emplace_back(radius * std::cos(a / 2), radius * std::sin(a / 2), 0.1 * a);
  }
  return run;
}

struct TubeRun {
  const char* name;
  std::vector<Point3> (*points)(int);
  double feed;  // mm/min
  double tolerance;
  int parts;  // of a long run, of 60 points each
};

class TubeWork : public testing::TestWithParam<TubeRun> {
 protected:
  [[nodiscard]] CurveRequest request() const {
    return request_at(GetParam().feed, GetParam().tolerance);
  }
  [[nodiscard]] TubeCurve tube(int points) const {
    const auto made = tube_curve(GetParam().points(points), request());
    fmt::print("{} points: {}, {:.0f} visits for each, {} nodes planned\n", points,
               geometry::name_of(made->method), static_cast<double>(made->visits) / points,
               made->planned);
    return made.value();
  }
};

TEST_P(TubeWork, IsLinearInThePointsAndThatOfThePlansIsBounded) {
  constexpr std::size_t kMostPlanned = 35000;
  const TubeCurve one = tube(100);
  for (const int times : {4, 16}) {
    const TubeCurve many = tube(100 * times);
    EXPECT_LE(static_cast<double>(many.visits), 1.25 * times * static_cast<double>(one.visits));
    EXPECT_LE(many.planned, kMostPlanned);
  }
}

// A short run is planned as a whole, a long one of equal parts by samples.
TEST_P(TubeWork, TakesTheMethodOfItsPartsForALongRun) {
  EXPECT_EQ(tube(60 * GetParam().parts + 1).method, tube(61).method);
}

INSTANTIATE_TEST_SUITE_P(
    Runs, TubeWork,
    testing::Values(
        TubeRun{"CornersAtAHighFeed", [](int points) { return zigzag(points); }, 12000, 0.01, 8},
        TubeRun{"CornersAtALowFeed", [](int points) { return zigzag(points); }, 500, 0.01, 8},
        TubeRun{"FarCornersAtALowFeed", [](int points) { return zigzag(points, 200); }, 500, 0.01,
                8},
        TubeRun{"RippleAtAHighFeed", rippled_helix, 24000, 0.15, 40}),
    [](const auto& test) { return test.param.name; });

// A ripple at both ends of a long run does not decide for the corners between them.
TEST(TubeCurve, TakesTheMethodOfTheGreaterPartOfARun) {
  const CurveRequest request = request_at(24000, 0.15);
  const std::vector<Point3> ripple = rippled_helix(1700);
  const std::vector<Point3> corners = zigzag(150, 20);
  std::vector<Point3> run;
  for (const auto* part : {&ripple, &corners, &ripple}) {
    const Point3 start = run.empty() ? Point3::Zero() : Point3(run.back() - part->front());
    for (const Point3& p : *part) run.push_back(start + p);
  }
  const auto method = tube_curve(corners, request)->method;
  EXPECT_NE(method, tube_curve(ripple, request)->method);
  EXPECT_EQ(method, tube_curve(run, request)->method);
}

// Between far corners is more of the same line.
TEST(TubeCurve, TakesTheSameMethodHoweverFarCornersAre) {
  const CurveRequest request = request_at(500);
  const auto near = tube_curve(zigzag(61), request);
  const auto far = tube_curve(zigzag(61, 200), request);
  EXPECT_NE(near->method, geometry::TubeMethod::kOriginal);
  EXPECT_EQ(near->method, far->method);
}

// The first curve tells. What is no slower than the rest is not lost by it, though the fit itself
// is far behind where a ripple is smoothed.
TEST(TubeCurve, IsLeftOutWhereItIsFarBehindWhatThereIs) {
  struct Case {
    CurveRequest request;
    std::vector<Point3> run;
  };
  for (auto& [request, run] :
       {Case{request_at(12000), zigzag(61)}, Case{request_at(24000, 0.15), rippled_helix(61)}}) {
    const auto without = tube_curve(run, request);
    const geometry::Path path = geometry::beziers_of(without->path.curve);
    const double time = plan_feed(path, plan_limits(request)).time;
    CurveRequest with_rival = request;
    with_rival.rival = time / (1.1 * kTube.behind);
    EXPECT_FALSE(tube_curve(run, with_rival));
    with_rival.rival = 1.01 * time;
    const auto faster = tube_curve(run, with_rival);
    ASSERT_TRUE(faster);
    EXPECT_EQ(faster->method, without->method);
    EXPECT_EQ(faster->planned, without->planned);
  }
}

}  // namespace
}  // namespace batten::postproc
