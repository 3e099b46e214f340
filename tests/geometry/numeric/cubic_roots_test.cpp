#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "geometry/numeric/extrema.h"

namespace batten::geometry {
namespace {

std::vector<double> roots(double c0, double c1, double c2, double c3, double offset = 0) {
  std::vector<double> places;
  append_cubic_roots(c0, c1, c2, c3, offset, places);
  return places;
}

void expect_roots(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-11);
}

TEST(CubicRoots, AreThoseBetweenNoughtAndOne) {
  expect_roots(roots(-0.5, 1, 0, 0), {0.5});
  expect_roots(roots(-1.5, 1, 0, 0), {});
  expect_roots(roots(0.08, -0.6, 1, 0), {0.2, 0.4});            // (t - .2)(t - .4)
  expect_roots(roots(-0.064, 0.56, -1.4, 1), {0.2, 0.4, 0.8});  // (t - .2)(t - .4)(t - .8)
  expect_roots(roots(1, 0, 1, 0), {});                          // 1 + t^2
  expect_roots(roots(-0.5, 1, 0, 0, 7), {7.5});
}

TEST(CubicRoots, CountTheEnds) {
  expect_roots(roots(0, 1, 0, 0), {0});
  expect_roots(roots(-1, 1, 0, 0), {1});
  expect_roots(roots(0, -1, 1, 0), {0, 1});  // t (t - 1)
}

TEST(CubicRoots, HaveNoneOfNothing) {
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
