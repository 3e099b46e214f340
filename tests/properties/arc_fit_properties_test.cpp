#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <variant>
#include <vector>

#include "geometry/arcs/arc_fit.h"
#include "tests/support/arc_path_measure.h"
#include "tests/support/curve_of.h"
#include "tests/support/processor_time.h"

namespace batten::geometry {
namespace {

constexpr double kSampling = 1.002;  // the chords between samples of measure()

// A smooth plane curve whose heading is a sum of slow waves, so with inflections, stretches
// that are nearly straight and radii of a few millimetres and more; it rises by `slope` per mm.
struct Wander {
  double amplitude[3];
  double phase[3];
  double slope;

  explicit Wander(int seed, double rise = 0) : slope(rise) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 3; ++i) {
      amplitude[i] = 1.2 * uniform(random) / (i + 1);
      phase[i] = 6.28 * uniform(random);
    }
  }

  double heading(double s) const {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += amplitude[i] * std::sin(0.08 * (i + 1) * s + phase[i]);
    return sum;
  }

  BsplineCurve curve(double length, int spans) const {
    // Integrated by the middle rule, finely, once; read back by linear interpolation of a
    // table that is as fine as the curve's knots need.
    const int fine = 64;
    const double h = length / spans;
    std::vector<Point3> table;
    Point3 at = Point3::Zero();
    for (int k = 0; k <= (spans + 4) * fine; ++k) {
      if (k % fine == 0) table.push_back(at);
      const double s = (k + 0.5) * h / fine - 2 * h;
      at += h / fine * Vector3(std::cos(heading(s)), std::sin(heading(s)), slope);
    }
    return curve_of(
        [&](double s) { return table[static_cast<std::size_t>(std::lround(s / h)) + 2]; }, 0,
        length, spans);
  }
};

BsplineCurve turned_to(const BsplineCurve& curve, const Vector3& axis) {
  std::vector<Point3> points;
  for (const Point3& p : curve.control_points()) {
    points.push_back(axis.x() != 0   ? Point3(p.z(), p.x(), p.y())
                     : axis.y() != 0 ? Point3(p.y(), p.z(), p.x())
                                     : p);
  }
  return {curve.basis(), points};
}

TEST(FitArcs, KeepsItsPromisesOnRandomCurvesInEveryPlane) {
  constexpr int kCurves = 45;
  for (int seed = 0; seed < kCurves; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ArcFitOptions options;
    options.axis = Vector3::Unit(seed % 3);
    options.grid = seed % 2 == 0 ? 0 : 0.001;
    options.max_deviation = seed % 4 < 2 ? 0.005 : 0.02;
    options.max_radius = 1e6;
    const BsplineCurve curve = turned_to(Wander(seed).curve(100, 120), options.axis);
    const auto path = fit_arcs(curve, curve.first(), curve.last(), options);
    ASSERT_TRUE(path);
    const ArcPathMeasure found = measure(curve, *path, 0.02);
    EXPECT_LE(found.away, options.max_deviation * kSampling);
    EXPECT_EQ(found.gap, 0);
    EXPECT_GE(found.least_radius, options.min_radius);
    EXPECT_LE(found.greatest_radius, options.max_radius * (1 + 1e-6));
    EXPECT_LE(found.greatest_sweep, options.max_sweep);
    // Rounding moves a joint by up to grid / sqrt(2), and each arc's tangent there by twice
    // that over its length.
    EXPECT_LE(found.kink_grids, 2 * std::sqrt(2.0) * options.grid + 1e-7);
    EXPECT_LE((start_point(path->front()) - curve.point_at(curve.first())).norm(), 1e-12);
    EXPECT_LE((end_point(path->back()) - curve.point_at(curve.last())).norm(), 1e-12);
  }
}

// A flat arc that becomes a line turns at its ends by half its length over the radius.
TEST(FitArcs, GivesLinesForArcsAboveTheGreatestRadius) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ArcFitOptions options;
    options.max_radius = 200;
    const BsplineCurve curve = Wander(seed).curve(100, 120);
    const auto path = fit_arcs(curve, curve.first(), curve.last(), options);
    ASSERT_TRUE(path);
    const ArcPathMeasure found = measure(curve, *path, 0.02);
    EXPECT_LE(found.away, options.max_deviation * kSampling);
    EXPECT_LE(found.greatest_radius, 200 * (1 + 1e-9));
    double longest = 0;
    for (const PathPiece& piece : *path) {
      if (std::holds_alternative<Line>(piece)) longest = std::max(longest, length_of(piece));
    }
    EXPECT_LE(found.kink, longest / 200 + 1e-9);  // half from either side
  }
}

TEST(FitArcs, HoldsRampsByHelicesAndPutsInnerPointsOnTheGrid) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ArcFitOptions options;
    options.grid = seed % 2 == 0 ? 0 : 0.001;
    options.helical = true;
    const double slope = seed % 4 == 3 ? 0 : 0.03;
    const BsplineCurve curve = Wander(seed, slope).curve(100, 120);
    const auto path = fit_arcs(curve, curve.first(), curve.last(), options);
    ASSERT_TRUE(path);
    const ArcPathMeasure found = measure(curve, *path, 0.02);
    EXPECT_LE(found.away, options.max_deviation * kSampling);
    EXPECT_GT(found.arcs, 0);
    for (std::size_t i = 0; i + 1 < path->size() && options.grid > 0; ++i) {
      const Point3 place = end_point((*path)[i]) / options.grid;
      if (slope == 0) {
        EXPECT_EQ(place.z(), 0);
      }
      EXPECT_LE((place - place.array().round().matrix()).cwiseAbs().maxCoeff(), 1e-6);
    }
  }
}

TEST(FitArcs, NeedsFarFewerPiecesThanChords) {
  std::size_t pieces = 0;
  std::size_t chords = 0;
  for (int seed = 0; seed < 20; ++seed) {
    const BsplineCurve curve = Wander(seed).curve(100, 120);
    const auto path = fit_arcs(curve, curve.first(), curve.last(), ArcFitOptions{});
    ASSERT_TRUE(path);
    pieces += path->size();
    // A chord of length c deviates by k c^2 / 8: the integral of sqrt(k / (8 T)) chords.
    const int samples = 2000;
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
      sum += std::sqrt(curve.curvature_at(100.0 * i / samples) / (8 * 0.005)) * 100 / samples;
    }
    chords += static_cast<std::size_t>(sum);
  }
  EXPECT_LE(2 * pieces, chords);
}

// Processor time, so that a busy machine does not matter. Eight times the spans take eight times as
// long when the cost is linear and 64 times when it is quadratic.
TEST(FitArcs, CostAboutLinearInTheSpans) {
  const auto seconds = [](int spans) {
    const BsplineCurve curve = Wander(5).curve(0.2 * spans, spans);
    ArcFitOptions options;
    options.grid = 0.001;
    return least_processor_seconds(
        1, [&] { EXPECT_TRUE(fit_arcs(curve, curve.first(), curve.last(), options)); });
  };
  const double small = seconds(2'500);
  EXPECT_LT(seconds(20'000), 24 * small);
}

}  // namespace
}  // namespace batten::geometry
