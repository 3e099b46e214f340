#include "geometry/fitting/tube/tube_smoothing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tests/support/corners.h"
#include "tests/support/knot_insertion.h"
#include "tests/support/naseath_cases.h"

namespace batten::geometry {
namespace {

TubeOptions tube(double radius) {
  TubeOptions options;
  options.radius = radius;
  return options;
}

// A wavy curve with knots of uneven width, 1 mm/s fast on average.
BsplineCurve random_curve(unsigned seed, bool plane = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int spans = 6 + static_cast<int>(seed % 12);
  std::vector<double> knots = {0};
  for (int i = 0; i < spans; ++i) knots.push_back(knots.back() + 1 + 0.7 * uniform(random));
  const BsplineBasis basis = BsplineBasis::clamped(3, knots);
  std::vector<Point3> points;
  for (std::size_t i = 0; i < basis.size(); ++i) {
    points.emplace_back(basis.greville(i) + 0.2 * uniform(random), uniform(random),
                        plane ? 0 : uniform(random));
  }
  return {basis, points};
}

double radius_for(unsigned seed) { return std::pow(10, -3 + 3.0 * (seed % 7) / 6); }

double sampled_displacement(const BsplineCurve& a, const BsplineCurve& b) {
  constexpr int kPlaces = 2000;
  double most = 0;
  for (int i = 0; i <= kPlaces; ++i) {
    const double u = a.first() + (a.last() - a.first()) * i / kPlaces;
    most = std::max(most, (a.point_at(u) - b.point_at(u)).norm());
  }
  return most;
}

// What docs/algorithms/methods.md says of the effort: four solutions of at most 200 steps each,
// with six samples for a span, however many spans there are.
TEST(FewInTube, StayInTheTubeForABoundedEffort) {
  for (const unsigned seed : {1, 4, 6, 9}) {
    for (const int halvings : {0, 4}) {
      const BsplineCurve curve = with_spans_halved(random_curve(seed), halvings);
      const double radius = radius_for(seed);
      const FewInTube few = few_in_tube(curve, tube(radius));
      ASSERT_EQ(few.candidates.size(), 5U);
      EXPECT_EQ(few.candidates.front().method, kFewMethods.front());
      for (const TubeCandidate& candidate : few.candidates) {
        EXPECT_LE(sampled_displacement(curve, candidate.curve), radius * (1 + 1e-9));
      }
      const std::size_t spans = curve.breakpoints().size() - 1;
      EXPECT_GT(few.visits, 4 * 6 * spans);
      EXPECT_LE(few.visits, 4 * 200 * (6 * spans + 1));
    }
  }
}

// A method that is asked for alone costs two solutions at most, and its curve is the same.
TEST(FewInTube, OfOneMethodIsTheSameAsAmongAll) {
  for (const unsigned seed : {1, 4, 6}) {
    const BsplineCurve curve = random_curve(seed);
    const FewInTube all = few_in_tube(curve, tube(radius_for(seed)));
    const std::size_t spans = curve.breakpoints().size() - 1;
    for (std::size_t i = 0; i < kFewMethods.size(); ++i) {
      const FewInTube one =
          few_in_tube(curve, tube(radius_for(seed)), std::span(&kFewMethods[i], 1));
      ASSERT_EQ(one.candidates.size(), 1U);
      EXPECT_EQ(one.candidates.front().method, all.candidates[i].method);
      EXPECT_EQ(one.candidates.front().curve.control_points(),
                all.candidates[i].curve.control_points());
      EXPECT_LE(one.visits, 2 * 200 * (6 * spans + 1));
    }
    const std::span rest = std::span(kFewMethods).subspan(1);
    const FewInTube others =
        few_in_tube(curve, tube(radius_for(seed)), rest, all.candidates.front().curve);
    const FewInTube first =
        few_in_tube(curve, tube(radius_for(seed)), std::span(kFewMethods).first(1));
    EXPECT_EQ(first.visits + others.visits, all.visits) << "nothing is solved twice";
    for (std::size_t i = 0; i < rest.size(); ++i) {
      EXPECT_EQ(others.candidates[i].curve.control_points(),
                all.candidates[i + 1].curve.control_points());
    }
  }
  constexpr TubeMethod kOther = TubeMethod::kEven;
  EXPECT_THROW((void)few_in_tube(random_curve(1), tube(.1), std::span(&kOther, 1)),
               std::invalid_argument);
}

TEST(SmoothInTube, TheOldCurveComesFirstAndAllStayInTheTubeAtEveryParameter) {
  for (const unsigned seed : {1, 4, 6}) {  // radii of 0.003, 0.1 and 1 mm
    const BsplineCurve curve = random_curve(seed);
    const double radius = radius_for(seed);
    const auto candidates = smooth_in_tube(curve, tube(radius));
    EXPECT_EQ(candidates.front().method, TubeMethod::kOriginal);
    EXPECT_EQ(candidates.front().displacement, 0);
    EXPECT_EQ(farthest(candidates.front().curve.control_points(), curve.control_points()), 0);
    for (const TubeCandidate& candidate : candidates) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " " << name_of(candidate.method)
                                      << " halvings " << candidate.halvings);
      EXPECT_LE(candidate.displacement, radius);
      EXPECT_LE(sampled_displacement(candidate.curve, curve),
                candidate.displacement * (1 + 1e-9) + 1e-12);
    }
  }
}

double energy_of(const BsplineCurve& curve, int derivative) {
  constexpr int kPlaces = 1000;
  const double h = (curve.last() - curve.first()) / kPlaces;
  double sum = 0;
  for (int i = 0; i < kPlaces; ++i) {
    sum += h * curve.derivative_at(curve.first() + (i + .5) * h, derivative).squaredNorm();
  }
  return sum;
}

// Candidates are pulled back inside by some permille, and energies are by samples.
TEST(SmoothInTube, EachEnergyIsTheLeastOfTheCandidatesOnItsKnots) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    TubeOptions options = tube(radius_for(seed));
    options.halvings = 0;
    const auto candidates = smooth_in_tube(random_curve(seed), options);
    for (const auto& [method, order] :
         {std::pair(TubeMethod::kBending, 2), std::pair(TubeMethod::kThirdDerivative, 3)}) {
      const auto least = std::ranges::find(candidates, method, &TubeCandidate::method);
      for (const TubeCandidate& candidate : candidates) {
        EXPECT_LE(energy_of(least->curve, order), energy_of(candidate.curve, order) * 1.02);
      }
    }
  }
}

TEST(SmoothInTube, HeldEndsKeepPlaceDirectionAndCurvature) {
  const BsplineCurve curve = random_curve(5);
  for (int held = 1; held <= 3; ++held) {
    TubeOptions options = tube(.1);
    options.held_points = held;
    for (const TubeCandidate& candidate : smooth_in_tube(curve, options)) {
      SCOPED_TRACE(testing::Message() << name_of(candidate.method) << " held " << held);
      const BsplineCurve& moved = candidate.curve;
      for (const double u : {curve.first(), curve.last()}) {
        EXPECT_LE((moved.point_at(u) - curve.point_at(u)).norm(), 1e-12);
        if (held >= 2) {
          EXPECT_LE((moved.direction_at(u) - curve.direction_at(u)).norm(), 1e-9);
        }
        if (held == 3) {
          EXPECT_NEAR(moved.curvature_at(u), curve.curvature_at(u), 1e-9);
        }
      }
    }
  }
}

TEST(SmoothInTube, FreeEndsSlideAcrossTheTubeOnly) {
  const BsplineCurve curve = random_curve(6);
  for (const TubeCandidate& candidate : smooth_in_tube(curve, tube(.1))) {
    if (candidate.method == TubeMethod::kNaseath ||
        candidate.method == TubeMethod::kNaseathLiteral) {
      continue;
    }
    for (const double u : {curve.first(), curve.last()}) {
      const Vector3 move = candidate.curve.point_at(u) - curve.point_at(u);
      EXPECT_LE(std::abs(move.dot(curve.direction_at(u))), 1e-9);
    }
  }
}

TEST(SmoothInTube, NoiseBelowTheRadiusBecomesStraight) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-.05, .05);
    // Run at even speed along the line: the energies count uneven speed, too.
    std::vector<double> knots;
    for (int i = 0; i < 28; ++i) knots.push_back(2 * i);
    const BsplineBasis basis = BsplineBasis::clamped(3, knots);
    std::vector<Point3> points;
    for (std::size_t i = 0; i < basis.size(); ++i) {
      points.emplace_back(basis.greville(i), noise(random), noise(random));
    }
    for (const TubeCandidate& candidate : smooth_in_tube({basis, points}, tube(.1))) {
      if (candidate.method == TubeMethod::kBending) {
        EXPECT_LE(greatest_curvature(candidate.curve), 1e-8);
      }
      // A parabola has no third derivative; one across the tube and 54 mm long is this bent.
      if (candidate.method == TubeMethod::kThirdDerivative) {
        EXPECT_LE(greatest_curvature(candidate.curve), 16 * .15 / (54 * 54));
      }
    }
  }
}

TEST(SmoothInTube, TurnsWithTheCurveIntoSpace) {
  for (unsigned seed = 1; seed <= 1; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Motion motion = random_motion(random);
    const BsplineCurve flat = random_curve(seed, true);
    std::vector<Point3> turned = flat.control_points();
    for (Point3& p : turned) p = motion(p);
    const auto a = smooth_in_tube(flat, tube(.1));
    const auto b = smooth_in_tube({flat.basis(), turned}, tube(.1));
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a[i].method != TubeMethod::kBending && a[i].method != TubeMethod::kThirdDerivative) {
        continue;
      }
      std::vector<Point3> expected = a[i].curve.control_points();
      for (Point3& p : expected) p = motion(p);
      EXPECT_LE(farthest(b[i].curve.control_points(), expected), 1e-4);
    }
  }
}

TEST(SmoothInTube, RefusesWhatItCannotUnderstand) {
  const BsplineCurve curve = random_curve(1);
  EXPECT_THROW((void)smooth_in_tube(curve, tube(0)), std::invalid_argument);
  TubeOptions options = tube(.1);
  options.held_points = 4;
  EXPECT_THROW((void)smooth_in_tube(curve, options), std::invalid_argument);
  const double middle = curve.breakpoints()[3];
  EXPECT_THROW((void)smooth_in_tube(with_knot(curve, middle), tube(.1)), std::invalid_argument);
}

// --- the choice --------------------------------------------------------------------------------

TEST(BestInTube, IsNeverSlowerByTheCallersClock) {
  // Clocks that know nothing of curves.
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = random_curve(seed);
    int calls = 0;
    const auto clock = [&](const BsplineCurve& c) {
      ++calls;
      double sum = 0;
      for (const Point3& p : c.control_points()) sum += std::sin(100 * p.x() + seed);
      return 10 + sum / static_cast<double>(c.control_points().size());
    };
    const TubeChoice choice = best_in_tube(curve, tube(.1), clock);
    EXPECT_EQ(choice.timed, calls);
    EXPECT_EQ(choice.time_before, clock(curve));
    EXPECT_LE(choice.time, choice.time_before);
    EXPECT_DOUBLE_EQ(choice.time, clock(choice.best.curve));
    EXPECT_LE(sampled_displacement(choice.best.curve, curve), .1 * (1 + 1e-9));
  }
}

TEST(BestInTube, KeepsTheCurveWhereNothingIsWon) {
  const TubeChoice choice =
      best_in_tube(random_curve(2), tube(.1), [](const BsplineCurve&) { return 1.0; });
  EXPECT_EQ(choice.best.method, TubeMethod::kOriginal);
}

TEST(BestInTube, BendsHarderOnlyWhereThatIsWorthIt) {
  const BsplineCurve curve = random_curve(4);
  const double bend = greatest_curvature(curve);
  for (const double gain : {0.5 * kTubeTuning.worth_bending, 4 * kTubeTuning.worth_bending}) {
    // All that bends harder is quicker, by so much and no more.
    const auto clock = [&](const BsplineCurve& c) {
      return greatest_curvature(c) > bend * (1 + 1e-6) ? 1 - gain : 1.0;
    };
    const auto candidates = smooth_in_tube(curve, tube(.1));
    ASSERT_TRUE(std::any_of(candidates.begin(), candidates.end(),
                            [&](const auto& c) { return clock(c.curve) < 1; }));
    const TubeChoice choice = best_in_tube(curve, tube(.1), clock);
    EXPECT_EQ(choice.time<1, gain> kTubeTuning.worth_bending);
  }
}

TEST(WithSpansHalved, IsTheSameCurve) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const BsplineCurve curve = random_curve(seed);
    for (int times = 0; times <= 3; ++times) {
      const BsplineCurve halved = with_spans_halved(curve, times);
      EXPECT_EQ(halved.breakpoints().size() - 1, (curve.breakpoints().size() - 1) << times);
      EXPECT_LE(sampled_displacement(halved, curve), 1e-13);
    }
  }
}

}  // namespace
}  // namespace batten::geometry
