#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "geometry/numeric/extrema.h"

namespace batten::geometry {
namespace {

using Variables = std::vector<double>;

TEST(PatternSearch, FindsTheFootOfABowl) {
  const auto bowl = [](const Variables& v) {
    return (v[0] - 1) * (v[0] - 1) + 10 * (v[1] + 2) * (v[1] + 2) + v[0] * v[1];
  };
  // 2 (x - 1) + y = 0 and 20 (y + 2) + x = 0: y = 2 - 2 x, x = 80 / 39.
  const auto found = pattern_search(bowl, {10, 10}, {{1, 1}, 4000, 1e-7});
  EXPECT_NEAR(found.at[0], 80.0 / 39, 1e-4);
  EXPECT_NEAR(found.at[1], 2 - 160.0 / 39, 1e-4);
  EXPECT_EQ(found.value, bowl(found.at));
}

// |x - y| makes a valley along the diagonal that the directions of the variables cannot follow.
TEST(PatternSearch, FollowsAKinkedValley) {
  const auto valley = [](const Variables& v) {
    return 10 * std::abs(v[0] - v[1]) + std::abs(v[0] + v[1] - 6);
  };
  const auto found = pattern_search(valley, {0, 0}, {{1, 1}, 20000, 1e-6});
  EXPECT_NEAR(found.at[0], 3, 0.05);
  EXPECT_NEAR(found.at[1], 3, 0.05);
}

TEST(PatternSearch, StaysOutOfForbiddenPlaces) {
  const auto disc = [](const Variables& v) {
    const double r = std::hypot(v[0], v[1]);
    return r > 1 ? std::numeric_limits<double>::infinity() : -(v[0] + v[1]);
  };
  const auto found = pattern_search(disc, {0, -0.9}, {{0.5, 0.5}, 4000, 1e-7});
  EXPECT_NEAR(found.value, -std::sqrt(2.0), 2e-3);
}

TEST(PatternSearch, WorksInFourVariables) {
  const auto crest = [](const Variables& v) {
    double greatest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      greatest = std::max(greatest, std::abs(v[i] - 0.1 * static_cast<double>(i)));
    }
    return greatest + 0.1 * std::abs(v[0] + v[3]);
  };
  // At (-a, ., ., 0.3 - a) the second term is 0.1 |0.3 - 2a|: greatest is a, so a = 0 is best.
  const auto found = pattern_search(crest, {1, -1, 1, -1}, {{1, 1, 1, 1}, 20000, 1e-6});
  EXPECT_LT(found.value, 0.03 + 0.02);
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

}  // namespace
}  // namespace batten::geometry
