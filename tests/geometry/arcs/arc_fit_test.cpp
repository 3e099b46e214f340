#include "geometry/arcs/arc_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "geometry/chords/linearize.h"
#include "tests/support/arc_path_measure.h"
#include "tests/support/curve_of.h"

namespace batten::geometry {
namespace {

using std::numbers::pi;
constexpr double kGrid = 0.001;
constexpr double kSampling = 1.002;  // the chords between samples of measure()

ArcFitOptions on_grid() {
  ArcFitOptions options;
  options.grid = kGrid;
  return options;
}

BsplineCurve circle(double radius, int spans) {
  return curve_of(
      [radius](double t) { return Point3(radius * std::cos(t), radius * std::sin(t), 0); }, 0,
      2 * pi, spans);
}

Path fitted(const BsplineCurve& curve, const ArcFitOptions& options) {
  const auto path = fit_arcs(curve, curve.first(), curve.last(), options);
  EXPECT_TRUE(path);
  return path.value_or(Path{});
}

TEST(FitArcs, ACircleIsAFewArcsOfItsRadius) {
  for (int spans : {40, 400, 10'000}) {
    for (double grid : {0.0, kGrid}) {
      SCOPED_TRACE(testing::Message() << spans << " spans, grid " << grid);
      ArcFitOptions options;
      options.grid = grid;
      const Path path = fitted(circle(20, spans), options);
      EXPECT_LE(path.size(), 4u);
      const ArcPathMeasure found = measure(circle(20, spans), path, 0.05);
      EXPECT_NEAR(found.least_radius, 20, 1e-3 + 2 * grid);
      EXPECT_NEAR(found.greatest_radius, 20, 1e-3 + 2 * grid);
      EXPECT_LE(found.greatest_sweep, 3.0);
      EXPECT_LE(found.kink_grids, 2 * grid + 1e-9);
    }
  }
}

TEST(FitArcs, ASlotIsTwoLinesAndItsArcs) {
  const BsplineCurve slot = Drawing({0, 0, 0})
                                .line_to({50, 0, 0})
                                .arc_about({50, 5, 0}, pi)
                                .line_to({0, 10, 0})
                                .arc_about({0, 5, 0}, pi)
                                .curve();
  const Path path = fitted(slot, on_grid());
  ASSERT_LE(path.size(), 6u);
  const auto* first = std::get_if<Line>(&path.front());
  ASSERT_TRUE(first);
  EXPECT_EQ(first->end, Point3(50, 0, 0));
  const ArcPathMeasure found = measure(slot, path, 0.05);
  EXPECT_LE(found.kink, 1e-9);
  EXPECT_NEAR(found.least_radius, 5, 1e-4);
}

TEST(FitArcs, ARoundedCornerIsOneArcBetweenTwoLines) {
  const BsplineCurve corner = Drawing({0, 0, 0})
                                  .line_to({20, 0, 0})
                                  .arc_about({20, 3, 0}, pi / 2)
                                  .line_to({23, 30, 0})
                                  .curve();
  const Path path = fitted(corner, on_grid());
  ASSERT_EQ(path.size(), 3u);
  EXPECT_TRUE(std::holds_alternative<Arc>(path[1]));
  EXPECT_NEAR(curvature_at(path[1], 0.5), 1.0 / 3, 1e-4);
}

TEST(FitArcs, KeepsCorners) {
  const BsplineCurve square =
      Drawing({0, 0, 0}).line_to({10, 0, 0}).line_to({10, 10, 0}).line_to({0, 10, 0}).curve();
  const Path path = fitted(square, on_grid());
  ASSERT_EQ(path.size(), 3u);
  EXPECT_EQ(end_point(path[0]), Point3(10, 0, 0));
  EXPECT_EQ(end_point(path[1]), Point3(10, 10, 0));
}

TEST(FitArcs, AStraightCurveIsOneLine) {
  const BsplineCurve line = curve_of([](double t) { return Point3(t, 0.4 * t, 0); }, 0, 50, 200);
  EXPECT_EQ(fitted(line, on_grid()).size(), 1u);
}

TEST(FitArcs, AnSIsTwoArcsThatMeetInTheInflection) {
  const BsplineCurve s = Drawing({0, 0, 0})
                             .arc_about({0, 10, 0}, 1)
                             .arc_about({20 * std::sin(1), 10 - 20 * std::cos(1), 0}, -1)
                             .curve();
  const Path path = fitted(s, ArcFitOptions{});
  EXPECT_LE(path.size(), 4u);
  EXPECT_LE(measure(s, path, 0.02).away, 0.005 * kSampling);
}

// One piece, straight in its middle.
TEST(FitArcs, ChordsAlongAnSAreThoseOfBothItsBends) {
  const BsplineCurve s(BsplineBasis::clamped(3, {0, 1}),
                       {{0, 0, 0}, {4, 6, 0}, {6, -6, 0}, {10, 0, 0}});
  const double chords = chord_vertices(s, 0, 1, {.max_deviation = 1e-4}).size() - 1.0;
  EXPECT_NEAR(chords_along(CurvePieces(s, 0, 1), 1e-4), chords, 0.12 * chords);
}

TEST(FitArcs, AHelixIsHelicalArcs) {
  ArcFitOptions options = on_grid();
  options.helical = true;
  const BsplineCurve helix = curve_of(
      [](double t) { return Point3(20 * std::cos(t), 20 * std::sin(t), -0.5 * t); }, 0, 12, 300);
  const Path path = fitted(helix, options);
  EXPECT_LE(path.size(), 6u);
  const ArcPathMeasure found = measure(helix, path, 0.05);
  EXPECT_LE(found.away, 0.005 * kSampling);
  EXPECT_EQ(found.arcs, static_cast<int>(path.size()));
}

TEST(FitArcs, ARampedContourHasLinesAndHelicalArcs) {
  ArcFitOptions options = on_grid();
  options.helical = true;
  // Rise per mm 0.02 all along: 40 mm of line, a quarter of radius 10, 20 mm of line.
  const double arc_rise = 0.02 * 5 * pi;
  const BsplineCurve ramp = Drawing({0, 0, 0})
                                .line_to({40, 0, 0.8})
                                .arc_about({40, 10, 0}, pi / 2, arc_rise)
                                .line_to({50, 30, 1.2 + arc_rise})
                                .curve();
  const Path path = fitted(ramp, options);
  EXPECT_LE(path.size(), 4u);
  EXPECT_LE(measure(ramp, path, 0.02).kink_grids, 2 * kGrid);
}

TEST(FitArcs, GivesNothingOffThePlaneWhereHelicesAreNotAllowedOrDoNotPay) {
  struct Row {
    bool helical;
    double rise;
    double to;
    int spans;
  };
  for (const Row& row : {Row{false, 1, 6, 100}, {true, 3, 20, 300}, {true, 3, 450, 6750}}) {
    ArcFitOptions options = on_grid();
    options.helical = row.helical;
    const auto at = [&row](double t) {
      return Point3(10 * t, 5 * std::sin(t), row.rise * std::sin(2 * t));
    };
    const BsplineCurve wave = curve_of(at, 0, row.to, row.spans);
    EXPECT_FALSE(fit_arcs(wave, wave.first(), wave.last(), options)) << row.spans;
  }
}

TEST(FitArcs, FollowsALongHelixToItsEnd) {
  ArcFitOptions options = on_grid();
  options.helical = true;
  constexpr int kPieces = 7000;
  const BsplineCurve helix =
      Drawing({10, 0, 0}).arc_about({0, 0, 0}, kPieces * pi / 4, 0.01 * kPieces).curve();
  const Path path = fitted(helix, options);
  // No arc sweeps more than max_sweep; some more joints come of the grid.
  EXPECT_GE(static_cast<double>(path.size()), kPieces * pi / 4 / options.max_sweep);
  EXPECT_LE(path.size(), kPieces / 2U);
  EXPECT_LE((end_point(path.back()) - helix.point_at(helix.last())).norm(), 1e-12);
}

TEST(FitArcs, CrossesPlacesTighterThanTheLeastRadiusByShortLines) {
  const BsplineCurve bend = Drawing({0, 0, 0})
                                .line_to({10, 0, 0})
                                .arc_about({10, 0.05, 0}, pi / 2)
                                .line_to({10.05, 9, 0})
                                .curve();
  const Path path = fitted(bend, on_grid());
  EXPECT_LE(path.size(), 6u);
  const ArcPathMeasure found = measure(bend, path, 0.002);
  EXPECT_LE(found.away, 0.005 * kSampling);
  EXPECT_TRUE(found.arcs == 0 || found.least_radius >= 0.1);
}

TEST(FitArcs, MeetsTheEndsOfAPartExactly) {
  const BsplineCurve curve = circle(20, 100);
  const auto path = fit_arcs(curve, 0.123, 1.77, on_grid());
  ASSERT_TRUE(path);
  EXPECT_LE((start_point(path->front()) - curve.point_at(0.123)).norm(), 1e-12);
  EXPECT_LE((end_point(path->back()) - curve.point_at(1.77)).norm(), 1e-12);
}

TEST(FitArcs, RefusesOptionsWithoutAMeaning) {
  const BsplineCurve curve = circle(20, 100);
  ArcFitOptions options;
  options.max_deviation = 0;
  EXPECT_THROW((void)fit_arcs(curve, 0, 1, options), std::invalid_argument);
  options = {};
  options.max_sweep = 4;
  EXPECT_THROW((void)fit_arcs(curve, 0, 1, options), std::invalid_argument);
}

// The least number of arcs that any chain of tangent arcs can have is the integral of
// (|k'| / (124.7 T))^(1/3) over the length, k' the change of the curvature per mm: 23.6 for
// the spiral, 35.3 for the sine, 22.1 for the ellipse (computed numerically). Chains whose
// tangents are the curve's need 1.45 times as many.
TEST(FitArcs, NeedsFewMoreArcsThanTheLeastPossible) {
  struct Row {
    const char* name;
    Point3 (*at)(double);
    double to;
    std::size_t most;
  };
  const Row rows[] = {
      {"spiral", [](double t) { return Point3((5 + t) * std::cos(t), (5 + t) * std::sin(t), 0); },
       20, 34},
      {"sine", [](double t) { return Point3(10 * t, 5 * std::sin(t), 0); }, 20, 51},
      {"ellipse", [](double t) { return Point3(30 * std::cos(t), 5 * std::sin(t), 0); }, 2 * pi,
       34},
  };
  for (const Row& row : rows) {
    const BsplineCurve curve = curve_of(row.at, 0, row.to, 300);
    for (double grid : {0.0, kGrid}) {
      SCOPED_TRACE(testing::Message() << row.name << ", grid " << grid);
      ArcFitOptions options;
      options.grid = grid;
      const Path path = fitted(curve, options);
      EXPECT_LE(path.size(), row.most);
      EXPECT_LE(measure(curve, path, 0.02).away, 0.005 * kSampling);
    }
  }
}

}  // namespace
}  // namespace batten::geometry
