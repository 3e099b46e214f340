#include "geometry/fitting/bspline_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

namespace batten::geometry {
namespace {

using Function = std::function<Point3(double)>;

// Samples of f at from + 1, from + 2 ... , pins at both ends, breakpoints every `span`.
FitProblem problem_of(const Function& f, int length, int span, double limit, double scatter) {
  FitProblem problem;
  for (int i = 1; i < length; ++i) {
    FitSample sample;
    sample.parameter = i;
    sample.target = f(i);
    sample.along = (f(i + 0.01) - f(i - 0.01)).normalized();
    sample.limit = limit;
    sample.scatter = scatter;
    problem.samples.push_back(sample);
  }
  problem.pins = {{0, f(0)}, {static_cast<double>(length), f(length)}};
  for (int i = 0; i < length; i += span) problem.breakpoints.push_back(i);
  problem.breakpoints.push_back(length);
  return problem;
}

double distance_across(const FitSample& sample, const BsplineCurve& curve) {
  const Vector3 off = curve.point_at(sample.parameter) - sample.target;
  return (off - off.dot(sample.along) * sample.along).norm();
}

// The integral of |C'''|^2: constant on every span.
double energy_of(const BsplineCurve& curve) {
  const auto breaks = curve.breakpoints();
  double sum = 0;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double middle = 0.5 * (breaks[i] + breaks[i + 1]);
    sum += curve.derivative_at(middle, 3).squaredNorm() * (breaks[i + 1] - breaks[i]);
  }
  return sum;
}

// Across the path by normal noise.
void shake(FitProblem& problem, double deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  for (FitSample& sample : problem.samples) {
    const Vector3 across(-sample.along.y(), sample.along.x(), 0);
    sample.target += normal(random) * across;
  }
}

Point3 line(double u) { return {u, 0.5 * u, -u}; }
Point3 parabola(double u) { return {u, 0.02 * u * u, 0.1 * u}; }
Point3 wave(double u) { return {u, 3 * std::sin(u / 8), 0}; }

// Lines and parabolas have no third derivative: they are met whatever the weights are.
TEST(FitBspline, ReproducesLinesAndParabolas) {
  for (const Function& f : {Function(line), Function(parabola)}) {
    const BsplineFit fit = fit_bspline(problem_of(f, 40, 8, 0.1, 0.01));
    for (double u = 0; u <= 40; u += 0.37) {
      EXPECT_LE((fit.curve.point_at(u) - f(u)).norm(), 1e-5) << u;  // of 40 mm
    }
    EXPECT_LE(fit.worst_ratio, 1e-4);
  }
}

// Ends at 0, samples at +h and -h a third of the way from either end: on one span, the cubic
// a u (3 - u) (3/2 - u) takes the values a and -a there, and its energy 3 (6 a)^2 is least
// where both distances are the greatest that are used.
TEST(FitBspline, FindsTheLeastEnergyBetweenTheLimits) {
  constexpr double kHeight = 0.5;
  constexpr double kLimit = 0.1;
  FitProblem problem;
  problem.samples = {{1, Point3(1, kHeight, 0), Vector3::UnitX(), kLimit, 0},
                     {2, Point3(2, -kHeight, 0), Vector3::UnitX(), kLimit, 0}};
  problem.pins = {{0, Point3::Zero()}, {3, Point3(3, 0, 0)}};
  problem.breakpoints = {0, 3};

  const BsplineFit fit = fit_bspline(problem, 0);
  EXPECT_NEAR(fit.worst_ratio, 1, 0.1);
  const double a = kHeight - fit.worst_ratio * kLimit;
  EXPECT_NEAR(energy_of(fit.curve), 3 * 36 * a * a, 0.005 * 3 * 36 * a * a);
}

// Spans are split until nothing is outside by more than a twentieth; what is left of that is
// drawn back where the knots allow.
constexpr double kInside = 1.05;

TEST(FitBspline, KeepsItsLimitsAndSaysHowWell) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    FitProblem problem = problem_of(wave, 120, 16, 0.05, 0);
    shake(problem, 0.02, seed);
    const BsplineFit fit = fit_bspline(problem);
    ASSERT_EQ(fit.ratios.size(), problem.samples.size());
    double worst = 0;
    for (std::size_t i = 0; i < fit.ratios.size(); ++i) {
      const double ratio = distance_across(problem.samples[i], fit.curve) / 0.05;
      EXPECT_LE(ratio, fit.ratios[i] + 1e-9);
      // Sliding counts from twice the limit on, where the path has turned away.
      const Vector3 off =
          fit.curve.point_at(problem.samples[i].parameter) - problem.samples[i].target;
      if (std::abs(off.dot(problem.samples[i].along)) < 0.1) {
        EXPECT_NEAR(fit.ratios[i], ratio, 1e-9);
      }
      worst = std::max(worst, ratio);
    }
    EXPECT_LE(worst, kInside);
    EXPECT_EQ(fit.worst_ratio, *std::max_element(fit.ratios.begin(), fit.ratios.end()));
    EXPECT_GE(fit.worst_ratio, worst - 1e-9);
  }
}

TEST(FitBspline, UsesTheRoomThatItHas) {
  double before = 1e300;
  for (const double limit : {0.001, 0.01, 0.1}) {
    FitProblem problem = problem_of(wave, 120, 4, limit, 0);
    shake(problem, 0.0003, 3);
    const double energy = energy_of(fit_bspline(problem).curve);
    EXPECT_LT(energy, before) << limit;
    before = energy;
  }
}

// With noise of the expected size the distances scatter as expected, and the curve is nearer
// to the truth than its samples.
TEST(FitBspline, LeavesTheScatterThatIsExpected) {
  constexpr double kScatter = 0.02;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    FitProblem problem = problem_of(wave, 200, 10, 0.2, kScatter);
    shake(problem, kScatter, seed);
    const BsplineFit fit = fit_bspline(problem);
    double squares = 0;
    double off_truth = 0;
    for (const FitSample& sample : problem.samples) {
      squares += std::pow(distance_across(sample, fit.curve), 2);
      const Point3 p = fit.curve.point_at(sample.parameter);
      off_truth += std::pow(p.y() - wave(p.x()).y(), 2);
    }
    const auto count = static_cast<double>(problem.samples.size());
    EXPECT_NEAR(std::sqrt(squares / count), kScatter, 0.3 * kScatter);
    EXPECT_LE(std::sqrt(off_truth / count), 0.9 * kScatter);
  }
}

TEST(FitBspline, SlidesAlongFreely) {
  FitProblem problem = problem_of(wave, 120, 10, 0.01, 0.001);
  const double energy = energy_of(fit_bspline(problem).curve);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  for (FitSample& sample : problem.samples) sample.target += uniform(random) * sample.along;
  const BsplineFit moved = fit_bspline(problem);
  EXPECT_LE(moved.worst_ratio, 1 + 1e-9);
  EXPECT_NEAR(energy_of(moved.curve), energy, 0.05 * energy);
}

TEST(FitBspline, RefinesWhereTheKnotsCannotFollow) {
  const FitProblem problem = problem_of(wave, 200, 200, 0.001, 0);

  EXPECT_GT(fit_bspline(problem, 0).worst_ratio, 10);
  const BsplineFit fit = fit_bspline(problem);
  EXPECT_LE(fit.worst_ratio, kInside);
  EXPECT_LT(fit.curve.control_points().size(), problem.samples.size() / 2);
}

TEST(FitBspline, KeepsStraightZonesExactly) {
  FitProblem problem = problem_of([](double u) { return Point3(u, 0, 0); }, 60, 5, 0.5, 0);
  // A bump before and after a zone that is a little to the left of the samples.
  for (FitSample& sample : problem.samples) {
    sample.target.y() = std::sin(sample.parameter / 3);
    sample.along = Vector3::UnitX();
  }
  const StraightZone zone{20, 40, Point3(20, 0.3, 0), Point3(40, 0.3, 0)};
  problem.zones = {zone};
  std::erase_if(problem.breakpoints, [](double u) { return u > 20 && u < 40; });
  const BsplineFit fit = fit_bspline(problem);
  for (double u = 20; u <= 40; u += 0.7) {
    EXPECT_LE((fit.curve.point_at(u) - Point3(u, 0.3, 0)).norm(), 1e-12) << u;
  }
  for (const double u : {20 - 1e-9, 40 + 1e-9}) {  // C2 joins: the line's derivatives
    EXPECT_LE((fit.curve.derivative_at(u, 1) - Vector3::UnitX()).norm(), 1e-6) << u;
    EXPECT_LE(fit.curve.derivative_at(u, 2).norm(), 1e-6) << u;
  }
  for (std::size_t i = 0; i < problem.samples.size(); ++i) {
    const double u = problem.samples[i].parameter;
    if (u > 20 && u < 40) {
      EXPECT_EQ(fit.ratios[i], 0) << u;
    }
  }
  EXPECT_GT(fit.curve.point_at(5).y(), 0.4);
}

// Two zones with so few spans between them that no control point is free.
TEST(FitBspline, SeesWhatIsOffWhereNothingIsFree) {
  const auto bump = [](double u) {
    return Point3(u, u > 20 && u < 40 ? std::pow(std::sin((u - 20) * M_PI / 20), 4) : 0, 0);
  };
  FitProblem problem = problem_of(bump, 60, 5, 0.05, 0);
  problem.zones = {{0, 20, bump(0), bump(20)}, {40, 60, bump(40), bump(60)}};
  problem.breakpoints = {0, 20, 30, 40, 60};
  EXPECT_GT(fit_bspline(problem, 0).worst_ratio, 1);
  const BsplineFit fit = fit_bspline(problem);
  EXPECT_LE(fit.worst_ratio, 1 + 1e-9);
  EXPECT_NEAR(fit.curve.point_at(30).y(), 1, 0.06);
  for (double u = 0; u <= 20; u += 0.7) {
    EXPECT_LE((fit.curve.point_at(u) - bump(u)).norm(), 1e-12) << u;
  }
}

TEST(FitBspline, PassesThroughPinsWithCorners) {
  const auto roof = [](double u) { return Point3(u, u <= 20 ? u : 40 - u, 0); };
  FitProblem problem = problem_of(roof, 40, 5, 0.01, 0);
  std::erase_if(problem.samples, [](const FitSample& s) { return s.parameter == 20; });
  problem.pins.insert(problem.pins.begin() + 1, Pin{20, roof(20)});
  const BsplineFit fit = fit_bspline(problem);
  for (const Pin& pin : problem.pins) {
    EXPECT_LE((fit.curve.point_at(pin.parameter) - pin.place).norm(), 1e-12);
  }
  for (double u = 0.5; u < 40; u += 1) {
    EXPECT_LE((fit.curve.point_at(u) - roof(u)).norm(), 1e-6) << u;
  }
  EXPECT_GT(fit.curve.derivative_at(20 - 1e-6, 1).y(), 0.99);
  EXPECT_LT(fit.curve.derivative_at(20, 1).y(), -0.99);
}

TEST(FitBspline, RefusesWhatIsNoProblem) {
  FitProblem problem = problem_of(line, 10, 5, 0.1, 0);
  problem.pins.pop_back();
  EXPECT_THROW((void)fit_bspline(problem), std::invalid_argument);
  problem = problem_of(line, 10, 5, 0.1, 0);
  problem.pins.insert(problem.pins.begin() + 1, Pin{3.3, line(3.3)});
  EXPECT_THROW((void)fit_bspline(problem), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
