#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "geometry/chords/linearize.h"
#include "tests/support/processor_time.h"

namespace batten::geometry {
namespace {

// A smooth wandering curve in space: control points a few millimetres apart whose direction
// turns by up to half a radian each, over breakpoints of uneven width.
BsplineCurve random_curve(int seed, int spans) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> breakpoints = {0};
  for (int i = 0; i < spans; ++i) breakpoints.push_back(breakpoints.back() + 1.5 + uniform(random));
  std::vector<Point3> points = {Point3(uniform(random), uniform(random), uniform(random))};
  double heading = 3 * uniform(random);
  for (int i = 0; i < spans + 2; ++i) {
    heading += 0.5 * uniform(random);
    const double step = 2 + uniform(random);
    points.push_back(points.back() + Vector3(step * std::cos(heading), step * std::sin(heading),
                                             0.5 * uniform(random)));
  }
  return {BsplineBasis::clamped(3, breakpoints), points};
}

// Greatest distance of the curve over [from, to] from the chord, and how far places of the
// curve run back along it.
struct ChordMeasure {
  double away = 0;
  double back = 0;
};

ChordMeasure measure(const BsplineCurve& curve, double from, double to) {
  constexpr int kSamples = 200;
  const Point3 start = curve.point_at(from);
  const Vector3 chord = curve.point_at(to) - start;
  ChordMeasure found;
  double reached = 0;
  for (int i = 0; i <= kSamples; ++i) {
    const Point3 p = curve.point_at(from + (to - from) * i / kSamples);
    const double t = std::clamp((p - start).dot(chord) / chord.squaredNorm(), 0.0, 1.0);
    found.away = std::max(found.away, (p - start - t * chord).norm());
    found.back = std::max(found.back, (reached - t) * chord.norm());
    reached = std::max(reached, t);
  }
  return found;
}

TEST(ChordVertices, KeepTheDeviationInOrderOnRandomCurves) {
  constexpr int kCurves = 100;
  for (int seed = 0; seed < kCurves; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = random_curve(seed, 12);
    ChordOptions options;
    options.max_deviation = std::pow(10.0, -1 - seed % 4);
    const double from = seed % 3 == 0 ? 0.7 : curve.first();
    const auto u = chord_vertices(curve, from, curve.last(), options);
    EXPECT_EQ(u.front(), from);
    EXPECT_EQ(u.back(), curve.last());
    for (std::size_t i = 1; i < u.size(); ++i) {
      ASSERT_LT(u[i - 1], u[i]);
      const ChordMeasure found = measure(curve, u[i - 1], u[i]);
      EXPECT_LE(found.away, options.max_deviation * (1 + 1e-9));
      EXPECT_LE(found.back, 2 * options.max_deviation);
    }
  }
}

// Two chords in a row could hardly ever be one. (They can across an inflection, where a long
// chord may hold although a shorter one does not.)
TEST(ChordVertices, AreNotMoreThanNeeded) {
  constexpr int kCurves = 60;
  int pairs = 0;
  int joinable = 0;
  for (int seed = 0; seed < kCurves; ++seed) {
    const BsplineCurve curve = random_curve(seed, 12);
    const auto u = chord_vertices(curve, curve.first(), curve.last(), ChordOptions{});
    for (std::size_t i = 2; i < u.size(); ++i) {
      ++pairs;
      joinable += measure(curve, u[i - 2], u[i]).away <= ChordOptions{}.max_deviation;
    }
  }
  EXPECT_LE(joinable, pairs / 100);
}

// 100,000 spans take some 0.2 s optimised; the bound leaves room for sanitizers and a busy
// machine, and still finds a quadratic scan (which takes minutes).
double seconds_for(const BsplineCurve& curve, double deviation) {
  return least_processor_seconds(3, [&] {
    const ChordOptions options{.max_deviation = deviation};
    EXPECT_GT(chord_vertices(curve, curve.first(), curve.last(), options).size(), 1U);
  });
}

// Four times the spans cost four times the work when it is linear and sixteen times when it is
// quadratic; a ratio of eight lies between, whatever the machine and the build.
TEST(ChordVertices, CostAboutLinearInTheSpans) {
  const BsplineCurve few = random_curve(1, 2'500);
  const BsplineCurve many = random_curve(1, 10'000);
  for (double deviation : {0.001, 1.0, 30.0}) {
    const double of_few = seconds_for(few, deviation);
    const double of_many = seconds_for(many, deviation);
    EXPECT_LT(of_many, 8 * of_few) << deviation << " mm: " << of_few << " s, " << of_many << " s";
  }
}

}  // namespace
}  // namespace batten::geometry
