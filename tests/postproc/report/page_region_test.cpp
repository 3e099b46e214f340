// The region of the tolerance on the report's page, against areas that are known.
#include "postproc/report/page_region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/path/joined_curve.h"
#include "postproc/report/page_path.h"
#include "tests/support/interpreted.h"

namespace batten::postproc {
namespace {

using geometry::Path;
using geometry::Point3;

constexpr double kAllowed = 0.1;

PageRegion region_of(const Path& path, std::size_t most_edges = kMostRegionEdges) {
  PageRegion region;
  add_region(path, path, kAllowed, most_edges, region);
  return region;
}

// Round ends are polygons about the true ones, so that the region is that of a tolerance between
// the given one and one that is 0.9 % greater.
constexpr double kGreater = 1.009 * kAllowed;

template <typename Area>
void expect_area(double found, const Area& of) {
  EXPECT_GE(std::max(of(kAllowed), of(kGreater)), found);
  EXPECT_LE(std::min(of(kAllowed), of(kGreater)), found);
}

// In the plane across `axis`, seen as from its end: of holes below 0.
double area_of(const std::vector<Point3>& polygon, int axis) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    twice += polygon[i].cross(polygon[(i + 1) % polygon.size()])[axis];
  }
  return twice / 2;
}

// Once around the square of side 1.
Path around_square(double z = 0) {
  return geometry::path_through(
      std::vector<Point3>{{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}, {0, 0, z}});
}

TEST(PageRegion, AroundASquareHasTheIslandAsItsHole) {
  const PageRegion region = region_of(around_square(3));
  ASSERT_EQ(region.polygons.size(), 2U);
  expect_area(area_of(region.polygons[0], 2),
              [](double r) { return 1 + 4 * r + std::numbers::pi * r * r; });
  expect_area(-area_of(region.polygons[1], 2), [](double r) { return std::pow(1 - 2 * r, 2); });
  for (const auto& polygon : region.polygons) {
    for (const Point3& corner : polygon) EXPECT_EQ(corner.z(), 3);
  }
}

// The walls of a slot are g = 1.5 r apart: between them there is no hole. What is about its open
// end, right of both rounds there, is 2 int sqrt(r^2 - y^2) dy from 0 to g / 2.
TEST(PageRegion, OfPassesNearerThanTwoTolerancesHasNoWayBetweenThem) {
  const double gap = 1.5 * kAllowed;
  const PageRegion region = region_of(
      geometry::path_through(std::vector<Point3>{{0, 0, 0}, {1, 0, 0}, {1, gap, 0}, {0, gap, 0}}));
  ASSERT_EQ(region.polygons.size(), 1U);
  expect_area(area_of(region.polygons[0], 2), [gap](double r) {
    const double half = gap / 2 / r;
    const double open_end = r * r * (half * std::sqrt(1 - half * half) + std::asin(half));
    return gap * (1 + r) + 2 * r + open_end + std::numbers::pi * r * r;
  });
}

TEST(PageRegion, LiesInThePlaneOfItsPath) {
  Path turned;
  for (const geometry::PathPiece& piece : around_square()) {
    const Point3 a = geometry::start_point(piece);
    const Point3 b = geometry::end_point(piece);
    turned.push_back(geometry::Line{{a.x(), 7, a.y()}, {b.x(), 7, b.y()}});
  }
  const PageRegion region = region_of(turned);
  ASSERT_EQ(region.polygons.size(), 2U);
  // Seen along Y, X and Z turn the other way round.
  expect_area(std::abs(area_of(region.polygons[1], 1)),
              [](double r) { return std::pow(1 - 2 * r, 2); });
  for (const Point3& corner : region.polygons[1]) EXPECT_EQ(corner.y(), 7);
}

TEST(PageRegion, TakesEdgesTogetherThatAreStraightOn) {
  std::vector<Point3> fine;
  for (int i = 0; i <= 200; ++i) fine.emplace_back(0.01 * i, 0, 0);
  const PageRegion of_many = region_of(geometry::path_through(fine));
  const PageRegion of_one =
      region_of(geometry::path_through(std::vector<Point3>{fine.front(), fine.back()}));
  EXPECT_LE(of_many.edges, 4U);  // not too many in one step
  ASSERT_EQ(of_many.polygons.size(), 1U);
  EXPECT_LE(of_many.polygons[0].size(), of_one.polygons[0].size() + 2);
}

TEST(PageRegion, IsNotDrawnInSpaceNorBeyondItsEdges) {
  PageRegion region;
  add_region(around_square(), around_square(), kAllowed, 7, region);
  add_region(around_square(), around_square(), kAllowed, 7, region);
  const Path ramp = {geometry::Line{{0, 0, 0}, {1, 1, 1}}};
  add_region(ramp, ramp, kAllowed, 7, region);
  EXPECT_EQ(region.drawn, 1U);
  EXPECT_EQ(region.left_out, 1U);
  EXPECT_EQ(region.in_space, 1U);
  EXPECT_EQ(region.edges, 4U);
  EXPECT_EQ(region.polygons.size(), 2U);
}

// Of two compared sections each with the tolerance that it has to keep.
TEST(PageRegion, HasTheToleranceThatWasPromised) {
  const tests::Interpreted before("G21 G90\nG0 X0 Y0 Z0\nG1 X5 F600\nX10 Y0.01\nX20 Y0\n");
  const tests::Interpreted after("G21 G90\nG0 X0 Y0 Z0\nG1 X20 F600\n");
  const ReadProgram old_program{&before.program, &before.read};
  const ReadProgram new_program{&after.program, &after.read};
  const Verification found = verify(old_program, new_program, Promise(0.02));
  ASSERT_TRUE(found.proved());
  const PagePath path = page_path(old_program, new_program, found, {}, {.tolerance_mm = 0.02});
  ASSERT_EQ(path.region.drawn, 1U);
  double low = 0;
  for (const Point3& corner : path.region.polygons.at(0)) low = std::min(low, corner.y());
  EXPECT_NEAR(low, -0.02, 0.01 * 0.02);
}

}  // namespace
}  // namespace batten::postproc
