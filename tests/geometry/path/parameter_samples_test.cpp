#include "geometry/path/parameter_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/support/curve_of.h"
#include "tests/support/knot_insertion.h"
#include "tests/support/naseath_cases.h"

namespace batten::geometry {
namespace {

// (t, t^2) on [0, 1], with a knot at 1/10: a short span and a long one.
BsplineCurve parabola() {
  const BsplineCurve whole(BsplineBasis::clamped(3, {0, 1}),
                           {{0, 0, 0}, {1.0 / 3, 0, 0}, {2.0 / 3, 1.0 / 3, 0}, {1, 1, 0}});
  return with_knot(whole, 0.1);
}

double parabola_curvature(double t) { return 2 / std::pow(1 + 4 * t * t, 1.5); }

TEST(ParameterSamples, AreEqualStepsInEverySpanWithEachKnotOnce) {
  const auto samples = parameter_samples(parabola(), 2);
  const double expected[] = {0, 0.05, 0.1, 0.55, 1};
  ASSERT_EQ(samples.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(samples[i].parameter, expected[i], 1e-15);
}

TEST(ParameterSamples, WeighAShortSpanAsALongOne) {
  const auto samples = parameter_samples(parabola(), 2);
  double sum = 0;
  for (const double t : {0.0, 0.05, 0.1, 0.55, 1.0}) sum += parabola_curvature(t);
  EXPECT_NEAR(mean_curvature(samples), sum / 5, 1e-12);
  EXPECT_NEAR(max_curvature(samples), 2, 1e-12);
}

TEST(ParameterSamples, MeasureLengthAndBendingOfAParabola) {
  const auto samples = parameter_samples(parabola(), kNaseathSteps);
  EXPECT_NEAR(sampled_length(samples), std::sqrt(5.0) / 2 + std::asinh(2.0) / 4, 1e-6);
  // Integral of 4 / (1 + 4 t^2)^2.5 dt = 4 (t / (3 w^3) + 2 t / (3 w)) with w = sqrt(1 + 4 t^2).
  const double w = std::sqrt(5.0);
  EXPECT_NEAR(bending(samples), 4 * (1 / (3 * w * w * w) + 2 / (3 * w)), 1e-5);
}

TEST(ParameterSamples, RefuseNoSteps) {
  EXPECT_THROW((void)parameter_samples(parabola(), 0), std::invalid_argument);
}

// A sine bends once between two zeros; bends of a thousandth of its height are too little to count.
TEST(BendsOf, CountsSectionsThatTurnOneWay) {
  constexpr int kHalves = 7;
  const auto sine = [](double height) {
    return curve_of([=](double x) { return Point3(x, height * std::sin(x), height * x * x); }, 0,
                    kHalves * kPi, 40 * kHalves);
  };
  const auto flat = [](double height) {
    return curve_of([=](double x) { return Point3(x, height * std::sin(x), 0); }, 0, kHalves * kPi,
                    40 * kHalves);
  };
  EXPECT_EQ(bends_of(parameter_samples(flat(1), 20), 0.1), 7u);
  // Each turns by twice the greatest slope.
  EXPECT_EQ(bends_of(parameter_samples(flat(0.01), 20), 0.015), 7u);
  EXPECT_EQ(bends_of(parameter_samples(flat(0.01), 20), 0.025), 0u);
  // In a plane that rises, too: it turns about one axis all along where the rise is the greater.
  EXPECT_EQ(bends_of(parameter_samples(sine(0.01), 20), 0.1), 1u);
}

}  // namespace
}  // namespace batten::geometry
