// Overlaps of boxes against all pairs asked one by one.
#include "geometry/path/box_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace batten::geometry {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs by_grid(const BoxGrid& grid) {
  Pairs pairs;
  grid.each_pair([&](std::uint32_t a, std::uint32_t b) { pairs.emplace_back(a, b); });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

Pairs one_by_one(const std::vector<FlatBox>& boxes) {
  Pairs pairs;
  for (std::uint32_t a = 0; a < boxes.size(); ++a) {
    for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
      const bool apart =
          boxes[a].high.x() < boxes[b].low.x() || boxes[b].high.x() < boxes[a].low.x() ||
          boxes[a].high.y() < boxes[b].low.y() || boxes[b].high.y() < boxes[a].low.y();
      if (!apart) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

// Boxes of up to `size` in a field of `width` times `height`.
std::vector<FlatBox> boxes_in(double width, double height, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<FlatBox> boxes;
  for (int i = 0; i < 300; ++i) {
    const Point2 low(width * part(random) - width / 2, height * part(random));
    boxes.push_back({low, low + Point2(size * part(random), size * part(random))});
  }
  return boxes;
}

TEST(BoxGrid, FindsEachOverlapOnce) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    const double height = seed % 4 == 0 ? 0 : 10.0;
    const auto boxes = boxes_in(20, height, 0.2 + 0.05 * seed, seed);
    const auto grid = BoxGrid::made_of(boxes);
    ASSERT_TRUE(grid);
    EXPECT_EQ(by_grid(*grid), one_by_one(boxes));
  }
}

// Edges that share a corner, and whole numbers that fall on the lines of the grid.
TEST(BoxGrid, EdgesBelongToTheBoxes) {
  std::vector<FlatBox> boxes;
  for (int i = 0; i < 64; ++i) {
    const Point2 low(i % 8, i / 8);
    boxes.push_back({low, low + Point2(1, 1)});
  }
  const auto grid = BoxGrid::made_of(boxes);
  ASSERT_TRUE(grid);
  const Pairs pairs = by_grid(*grid);
  EXPECT_EQ(pairs, one_by_one(boxes));
  EXPECT_EQ(pairs.size(), 2 * 7 * 8 + 2 * 7 * 7U);  // beside, above, and across the corners
}

TEST(BoxGrid, OneBoxAndBoxesInOnePlaceAreNoTrouble) {
  const std::vector<FlatBox> one = {{{3, 4}, {3, 4}}};
  ASSERT_TRUE(BoxGrid::made_of(one));
  EXPECT_TRUE(by_grid(*BoxGrid::made_of(one)).empty());
  const std::vector<FlatBox> same(5, FlatBox{{3, 4}, {3, 4}});
  ASSERT_TRUE(BoxGrid::made_of(same));
  EXPECT_EQ(by_grid(*BoxGrid::made_of(same)).size(), 5 * 4 / 2U);
}

TEST(BoxGrid, AHeapIsNoPlaceForAGrid) {
  std::vector<FlatBox> heap(3000, FlatBox{{0, 0}, {1, 1}});
  EXPECT_FALSE(BoxGrid::made_of(heap));
  // A few places that are far away do not hide it.
  heap.push_back({{1e5, 1e5}, {1e5 + 1, 1e5 + 1}});
  EXPECT_FALSE(BoxGrid::made_of(heap));
}

}  // namespace
}  // namespace batten::geometry
