#include "geometry/numeric/extrema.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace batten::geometry {
namespace {

using Variables = std::vector<double>;

TEST(PatternSearch, FindsTheLeastValue) {
  const auto bowl = [](const Variables& v) {
    return (v[0] - 1) * (v[0] - 1) + 10 * (v[1] + 2) * (v[1] + 2) + v[0] * v[1];
  };
  // 2 (x - 1) + y = 0 and 20 (y + 2) + x = 0: y = 2 - 2 x, x = 80 / 39.
  const auto foot = pattern_search(bowl, {10, 10}, {{1, 1}, 4000, 1e-7});
  EXPECT_NEAR(foot.at[0], 80.0 / 39, 1e-4);
  EXPECT_NEAR(foot.at[1], 2 - 160.0 / 39, 1e-4);
  EXPECT_EQ(foot.value, bowl(foot.at));
  // |x - y| makes a valley along the diagonal that the directions of the variables cannot follow.
  const auto valley = [](const Variables& v) {
    return 10 * std::abs(v[0] - v[1]) + std::abs(v[0] + v[1] - 6);
  };
  const auto floor = pattern_search(valley, {0, 0}, {{1, 1}, 20000, 1e-6});
  for (const double at : floor.at) EXPECT_NEAR(at, 3, 0.05);
  // A forbidden part.
  const auto disc = [](const Variables& v) {
    return std::hypot(v[0], v[1]) > 1 ? HUGE_VAL : -(v[0] + v[1]);
  };
  const auto edge = pattern_search(disc, {0, -0.9}, {{0.5, 0.5}, 4000, 1e-7});
  EXPECT_NEAR(edge.value, -std::sqrt(2.0), 2e-3);
  // Four variables. At (-a, ., ., 0.3 - a) the second term is 0.1 |0.3 - 2a|: greatest is a, so
  // a = 0 is best.
  const auto crest = [](const Variables& v) {
    double greatest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      greatest = std::max(greatest, std::abs(v[i] - 0.1 * static_cast<double>(i)));
    }
    return greatest + 0.1 * std::abs(v[0] + v[3]);
  };
  EXPECT_LT(pattern_search(crest, {1, -1, 1, -1}, {{1, 1, 1, 1}, 20000, 1e-6}).value, 0.03 + 0.02);
}

TEST(PatternSearch, IsNeverWorseThanItsStartAndEndsInTime) {
  int calls = 0;
  const auto f = [&calls](const Variables& v) {
    ++calls;
    return v[0] * v[0];
  };
  const auto at_rest = pattern_search(f, {0}, {{1}, 50, 0});
  EXPECT_EQ(at_rest.at[0], 0);
  EXPECT_EQ(at_rest.evaluations, 50);
  EXPECT_EQ(calls, 50);
}

TEST(PatternSearch, RefusesAnotherNumberOfSteps) {
  const auto f = [](const Variables&) { return 0.0; };
  EXPECT_THROW(static_cast<void>(pattern_search(f, {1, 2}, {{1}, 10, 0.1})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(pattern_search(f, {}, {{}, 10, 0.1})), std::invalid_argument);
}

std::vector<double> roots(double c0, double c1, double c2, double c3, double offset = 0) {
  std::vector<double> places;
  append_cubic_roots(c0, c1, c2, c3, offset, places);
  return places;
}

void expect_roots(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-11);
}

TEST(CubicRoots, AreThoseBetweenNoughtAndOneWithTheEnds) {
  expect_roots(roots(-0.5, 1, 0, 0), {0.5});
  expect_roots(roots(-1.5, 1, 0, 0), {});
  expect_roots(roots(0.08, -0.6, 1, 0), {0.2, 0.4});            // (t - .2)(t - .4)
  expect_roots(roots(-0.064, 0.56, -1.4, 1), {0.2, 0.4, 0.8});  // (t - .2)(t - .4)(t - .8)
  expect_roots(roots(1, 0, 1, 0), {});                          // 1 + t^2
  expect_roots(roots(-0.5, 1, 0, 0, 7), {7.5});
  expect_roots(roots(0, 1, 0, 0), {0});
  expect_roots(roots(-1, 1, 0, 0), {1});
  expect_roots(roots(0, -1, 1, 0), {0, 1});  // t (t - 1)
  expect_roots(roots(0, 0, 0, 0), {});
  expect_roots(roots(3, 0, 0, 0), {});
}

// Of k (t - a)(t - b)(t - c) with a, b, c anywhere from -1 to 2, apart from each other.
TEST(CubicRoots, AreAllFound) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> wide(-1, 2);
  for (int seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(testing::Message() << "cubic " << seed);
    std::vector<double> r = {wide(random), wide(random), wide(random)};
    std::sort(r.begin(), r.end());
    if (r[1] - r[0] < 1e-3 || r[2] - r[1] < 1e-3) continue;
    const double k = wide(random);
    auto found = roots(-k * r[0] * r[1] * r[2], k * (r[0] * r[1] + r[1] * r[2] + r[2] * r[0]),
                       -k * (r[0] + r[1] + r[2]), k);
    std::sort(found.begin(), found.end());
    std::erase_if(r, [](double t) { return t < 0 || t > 1; });
    ASSERT_EQ(found.size(), r.size());
    for (std::size_t i = 0; i < r.size(); ++i) EXPECT_NEAR(found[i], r[i], 1e-9);
  }
}

}  // namespace
}  // namespace batten::geometry
