// What holds of every feed plan, on random paths.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/path/joined_curve.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "tests/support/planned_paths.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::Line;
using geometry::Path;
using geometry::Point3;
using geometry::Vector3;

constexpr double kNoSuchLimit = KinematicPathLimits::kNone;
constexpr int kPaths = 20;

// Lines and the tangent arcs between them.
Path slots(int count, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> unit(0.1, 1);
  geometry::Path path;
  geometry::Point3 at = geometry::Point3::Zero();
  double angle = 0;
  for (int i = 0; i < count; ++i) {
    const geometry::Vector3 forward(std::cos(angle), std::sin(angle), 0);
    const geometry::Point3 end = at + 10 * unit(random) * forward;
    path.emplace_back(geometry::Line{at, end});
    const double side = random() % 2 == 0 ? 1 : -1;
    const double sweep = side * 3 * unit(random);
    const double radius = 8 * unit(random);
    const geometry::Vector3 left(-forward.y(), forward.x(), 0);
    const geometry::Point3 center = end + side * radius * left;
    angle += sweep;
    at = center - side * radius * geometry::Vector3(-std::sin(angle), std::cos(angle), 0);
    path.emplace_back(geometry::Arc{end, at, center, {0, 0, 1}, sweep});
  }
  return path;
}

struct Case {
  Path path;
  KinematicPathLimits limits;
};

Case random_case(int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  Case made;
  made.path = seed % 5 == 4 ? slots(4, seed) : geometry::beziers_of(random_curve(random));
  made.limits = random_limits(random);
  return made;
}

TEST(FeedPlanProperties, NoLimitIsBrokenByMoreThanHalfAPercent) {
  double worst = 0;
  double nodes = 0;
  for (int seed = 0; seed < kPaths; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case test = random_case(seed);
    const FeedPlan plan = plan_feed(test.path, test.limits);
    const double period = plan.time / 20000;
    const Use use = greatest_use(test.path, plan, test.limits, period);
    EXPECT_LE(use.share, 1.005) << use.where << " of " << plan.time;
    EXPECT_GE(use.share, 0.99);  // some limit is met
    worst = std::max(worst, use.share);
    nodes += static_cast<double>(plan.nodes.size());
  }
  fmt::print("{} paths, {:.0f} nodes each, greatest share of a limit {:.4f}\n", kPaths,
             nodes / kPaths, worst);
}

// Positions, velocities and accelerations of the samples are integrals of each other.
TEST(FeedPlanProperties, SamplesAreOneMotionFromStartToEnd) {
  for (int seed = 0; seed < kPaths; seed += 5) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case test = random_case(seed);
    const FeedPlan plan = plan_feed(test.path, test.limits);
    const double h = plan.time / 20000;
    const auto samples = sample_motion(test.path, plan, h);
    ASSERT_NEAR(static_cast<double>(samples.size()), 20000, 1);
    EXPECT_LT((samples.front().position - start_point(test.path.front())).norm(), 1e-12);
    EXPECT_LT((samples.back().position - end_point(test.path.back())).norm(),
              plan.nodes.back().distance * 1e-9);
    const double fastest = test.limits.feed;
    const double steepest = test.limits.jerk.maxCoeff();
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const MotionSample& a = samples[i - 1];
      const MotionSample& b = samples[i];
      const Vector3 moved = b.position - a.position - 0.5 * h * (a.velocity + b.velocity);
      ASSERT_LT(moved.norm(), steepest * h * h * h + 1e-4 * fastest * h);
      const Vector3 gained = b.velocity - a.velocity - 0.5 * h * (a.acceleration + b.acceleration);
      ASSERT_LT(gained.norm(), 2 * steepest * h * h);
    }
  }
}

// Curves that bend so sharply that the tool next to stops: nodes that were added there once made
// the plan's time no number.
TEST(FeedPlanProperties, HasATimeWhereThePathTurnsBack) {
  for (const unsigned seed : {9u, 387u}) {
    std::mt19937 random(seed);
    const Path path = geometry::beziers_of(random_curve(random, true));
    const KinematicPathLimits limits = random_limits(random);
    EXPECT_TRUE(std::isfinite(planned_time(path, limits))) << seed;
  }
}

// But for local optima: the jerk limit is not convex, and two searches may end on two sides of it.
TEST(FeedPlanProperties, RaisingALimitNeverCostsTime) {
  double worst = 0;
  for (int seed = 0; seed < kPaths; seed += 2) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case test = random_case(seed);
    const double time = planned_time(test.path, test.limits);
    const auto raised = [&](auto change) {
      KinematicPathLimits limits = test.limits;
      change(limits);
      const double loss = planned_time(test.path, limits) / time - 1;
      EXPECT_LE(loss, 2e-3);
      worst = std::max(worst, loss);
    };
    raised([](auto& l) { l.feed *= 1.2; });
    raised([](auto& l) { l.speed *= 1.2; });
    raised([](auto& l) { l.acceleration *= 1.2; });
    raised([](auto& l) { l.jerk *= 1.2; });
    raised([](auto& l) { l.tangential_jerk *= 1.2; });
    raised([](auto& l) { l.normal_acceleration = kNoSuchLimit; });
  }
  fmt::print("greatest loss {:.2e}\n", worst);
}

KinematicPathLimits divided(KinematicPathLimits limits, double speed, double acceleration,
                            double jerk) {
  limits.feed /= speed;
  limits.speed /= speed;
  limits.acceleration /= acceleration;
  limits.normal_acceleration /= acceleration;
  limits.tangential_acceleration /= acceleration;
  limits.jerk /= jerk;
  limits.tangential_jerk /= jerk;
  return limits;
}

// The points of a path.
template <typename Change>
void change_points(Path& path, const Change& change) {
  for (auto& piece : path) {
    if (auto* bezier = std::get_if<geometry::CubicBezier>(&piece)) {
      for (Point3& p : bezier->control) change(p);
    } else if (auto* arc = std::get_if<Arc>(&piece)) {
      for (Point3* p : {&arc->start, &arc->end, &arc->center}) change(*p);
    } else {
      for (Point3* p : {&std::get<Line>(piece).start, &std::get<Line>(piece).end}) change(*p);
    }
  }
}

// The greatest of them, printed.
class Differences {
 public:
  ~Differences() { fmt::print("greatest difference {:.2e}\n", worst_); }
  void add(double ratio, double tolerance, int seed) {
    EXPECT_NEAR(ratio, 1, tolerance) << "seed " << seed;
    worst_ = std::max(worst_, std::abs(ratio - 1));
  }

 private:
  double worst_ = 0;
};

// The same machine and path in other units of length.
TEST(FeedPlanProperties, TheUnitOfLengthDoesNotMatter) {
  Differences differences;
  for (int seed = 0; seed < kPaths; seed += 3) {
    const Case test = random_case(seed);
    for (const double k : {1e-3, 25.4}) {
      Path path = test.path;
      change_points(path, [&](Point3& p) { p *= k; });
      const double scaled = planned_time(path, divided(test.limits, 1 / k, 1 / k, 1 / k));
      differences.add(scaled / planned_time(test.path, test.limits), 1e-4, seed);
    }
  }
}

// The same motion at half the pace has half the speeds, a quarter of the accelerations, an eighth
// of the jerks.
TEST(FeedPlanProperties, AtHalfThePaceItTakesTwiceTheTime) {
  Differences differences;
  for (int seed = 0; seed < kPaths; seed += 3) {
    const Case test = random_case(seed);
    KinematicPathLimits slow = divided(test.limits, 2, 4, 8);
    slow.period *= 2;
    const double ratio = planned_time(test.path, slow) / planned_time(test.path, test.limits);
    differences.add(ratio / 2, 1e-4, seed);
  }
}

// All limits halved: with the cube root of 2 as pace the jerks are halved and the rest is lower
// than needed, with 2 the speeds are halved and the rest is: in between, and where only one kind of
// limit counts, its law exactly. A curve, so that there are no steps at joints.
TEST(FeedPlanProperties, HalvedLimitsTakeTheirLawsTime) {
  for (int seed = 0; seed < kPaths; seed += 5) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case test = random_case(seed);
    const auto ratio = [&](const KinematicPathLimits& limits) {
      return planned_time(test.path, divided(limits, 2, 2, 2)) / planned_time(test.path, limits);
    };
    const double all = ratio(test.limits);
    EXPECT_GE(all, std::cbrt(2) * (1 - 1e-3));
    EXPECT_LE(all, 2 * (1 + 1e-3));
    EXPECT_NEAR(ratio(divided(test.limits, 1e-3, 1e-3, 1)) / std::cbrt(2), 1, 1e-3);
    KinematicPathLimits without_jerk = test.limits;
    without_jerk.jerk.setConstant(kNoSuchLimit);
    without_jerk.tangential_jerk = kNoSuchLimit;
    EXPECT_NEAR(ratio(divided(without_jerk, 1e-3, 1, 1)) / std::sqrt(2), 1, 1e-3);
  }
  // The feed alone: a circle that is entered and left at speed.
  const Path circle = {Arc{{20, 0, 0}, {20, 0, 0}, {0, 0, 0}, {0, 0, 1}, 2 * std::numbers::pi}};
  KinematicPathLimits feed;
  feed.feed = 100;
  feed.acceleration.setConstant(1e4);
  const PlanEnds ends = {kNoSuchLimit, kNoSuchLimit};
  EXPECT_NEAR(planned_time(circle, feed, ends), 0.4 * std::numbers::pi, 1e-4);
  EXPECT_NEAR(planned_time(circle, divided(feed, 2, 2, 2), ends), 0.8 * std::numbers::pi, 2e-4);
}

TEST(FeedPlanProperties, TheReversedPathTakesTheSameTime) {
  Differences differences;
  for (int seed = 0; seed < kPaths; ++seed) {
    const Case test = random_case(seed);
    Path reversed;
    for (auto piece : test.path) {
      if (auto* bezier = std::get_if<geometry::CubicBezier>(&piece)) {
        std::ranges::reverse(bezier->control);
      } else if (auto* arc = std::get_if<Arc>(&piece)) {
        std::swap(arc->start, arc->end);
        arc->sweep = -arc->sweep;
      } else {
        std::swap(std::get<Line>(piece).start, std::get<Line>(piece).end);
      }
      reversed.insert(reversed.begin(), piece);
    }
    const double time = planned_time(test.path, test.limits, {0, 20});
    differences.add(planned_time(reversed, test.limits, {20, 0}) / time, 1e-4, seed);
  }
}

TEST(FeedPlanProperties, MoreNodesChangeLittle) {
  Differences differences;
  for (int seed = 0; seed < kPaths; seed += 3) {
    const Case test = random_case(seed);
    const double fine = planned_time(test.path, test.limits, {}, 60);
    differences.add(planned_time(test.path, test.limits) / fine, 1e-3, seed);
  }
}

// --- without a limit on jerk --------------------------------------------------------------------

// The two passes of reachability analysis (H. Pham, Q.-C. Pham 2018) over many small steps:
// backward the greatest q = v^2 from which the rest can still be run, forward the greatest
// that can be reached. At each step |x_ss q + x_s p / 2| <= A in all axes bounds p = dq/ds.
class Reachability {
 public:
  Reachability(const Path& path, const KinematicPathLimits& limits, int steps_per_piece)
      : limits_(limits) {
    for (const auto& piece : path) {
      for (int i = 0; i < steps_per_piece; ++i) {
        const double t = static_cast<double>(i) / steps_per_piece;
        places_.push_back(derivatives_by_length(piece, t));
        steps_.push_back(length_between(piece, t, t + 1.0 / steps_per_piece));
      }
    }
    places_.push_back(derivatives_by_length(path.back(), 1));
  }

  // Seconds from rest to rest.
  double time() const {
    const std::size_t n = places_.size();
    std::vector<double> q(n, 0);
    for (std::size_t i = n - 1; i-- > 1;) {
      double below = 0;
      double above = most(i);
      for (int k = 0; k < 50; ++k) {  // the greatest q whose steepest fall meets the next
        const double middle = 0.5 * (below + above);
        const auto [least, greatest] = slopes(i, middle);
        const bool held = least <= greatest && middle + steps_[i] * least <= q[i + 1];
        (held ? below : above) = middle;
      }
      q[i] = below;
    }
    double time = 0;
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const double rise = steps_[i] * slopes(i, q[i]).second;
      q[i + 1] = std::min(q[i + 1], std::max(1e-12, q[i] + rise));
      time += 2 * steps_[i] / (std::sqrt(q[i]) + std::sqrt(q[i + 1]));
    }
    return time;
  }

 private:
  double most(std::size_t i) const {
    const double v = limits_along(places_[i].first, limits_).speed;
    return std::min(v * v, limits_.normal_acceleration / (1e-12 + places_[i].second.norm()));
  }
  std::pair<double, double> slopes(std::size_t i, double q) const {
    double least = -2 * limits_.tangential_acceleration;
    double greatest = -least;
    for (int axis = 0; axis < 3; ++axis) {
      const double first = places_[i].first[axis];
      const double second = places_[i].second[axis] * q;
      const double a = limits_.acceleration[axis];
      if (std::abs(first) < 1e-9) continue;
      const double x = 2 * (a - second) / first;
      const double y = 2 * (-a - second) / first;
      least = std::max(least, std::min(x, y));
      greatest = std::min(greatest, std::max(x, y));
    }
    return {least, greatest};
  }

  KinematicPathLimits limits_;
  std::vector<LengthDerivatives> places_;
  std::vector<double> steps_;  // mm between them
};

TEST(FeedPlanProperties, WithoutJerkLimitTheTimeIsThatOfReachabilityAnalysis) {
  Differences differences;
  for (int seed = 0; seed < 10; ++seed) {
    Case test = random_case(5 * seed);  // curves, whose curvature runs on
    test.limits.jerk.setConstant(kNoSuchLimit);
    test.limits.tangential_jerk = kNoSuchLimit;
    const double expected = Reachability(test.path, test.limits, 3000).time();
    differences.add(planned_time(test.path, test.limits) / expected, 2e-3, seed);
  }
}

// What is told before of the work: refinement at least keeps the nodes, and less than triples them.
TEST(FeedPlanProperties, HasTheNodesThatItIsSaidToBeginWithAndSomeMore) {
  for (int seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case test = random_case(seed);
    for (const double density : {2.0, kPlanDensity}) {
      const std::vector<double> nodes = plan_nodes(test.path, test.limits, density);
      ASSERT_EQ(nodes.size(), test.path.size());
      double sum = 0;
      for (const double each : nodes) sum += each;
      const FeedPlan plan = plan_feed(test.path, test.limits, {}, density);
      EXPECT_LE(sum, static_cast<double>(plan.nodes.size()));
      EXPECT_LE(static_cast<double>(plan.nodes.size()), 3 * sum);
    }
  }
}

}  // namespace
}  // namespace batten::postproc
