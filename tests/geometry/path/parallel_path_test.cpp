#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <variant>

#include "geometry/distance/path_distance.h"
#include "geometry/path/path.h"

namespace batten::geometry {
namespace {

using std::numbers::pi;

Path square_corner() { return {Line{{0, 0, 0}, {10, 0, 0}}, Line{{10, 0, 0}, {10, 10, 0}}}; }

Arc quarter(double radius) {
  return {{radius, 0, 0}, {0, radius, 0}, {0, 0, 0}, Vector3::UnitZ(), pi / 2};
}

void expect_line(const PathPiece& piece, const Point3& start, const Point3& end) {
  ASSERT_TRUE(std::holds_alternative<Line>(piece));
  EXPECT_LT((start_point(piece) - start).norm(), 1e-12);
  EXPECT_LT((end_point(piece) - end).norm(), 1e-12);
}

TEST(ParallelPath, OfALineIsTheLineBesideIt) {
  const Path line = {Line{{0, 0, 1}, {10, 0, 3}}};
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const auto made = parallel_path(line, side, 0.5);
    ASSERT_TRUE(made);
    ASSERT_EQ(made->size(), 1u);
    const double y = side == Side::kLeft ? 0.5 : -0.5;
    expect_line(made->front(), {0, y, 1}, {10, y, 3});
  }
}

TEST(ParallelPath, GoesRoundACornerOnAnArcAboutIt) {
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const auto made = parallel_path(square_corner(), side, 0.5);
    ASSERT_TRUE(made);
    ASSERT_EQ(made->size(), 3u);
    const double y = side == Side::kLeft ? 0.5 : -0.5;
    expect_line((*made)[0], {0, y, 0}, {10, y, 0});
    expect_line((*made)[2], {10 - y, 0, 0}, {10 - y, 10, 0});
    const auto* arc = std::get_if<Arc>(&(*made)[1]);
    ASSERT_NE(arc, nullptr);
    EXPECT_NEAR(arc->sweep, pi / 2, 1e-12);
    for (const double t : {0.0, 0.3, 0.7, 1.0}) {
      EXPECT_NEAR((point_at(*arc, t) - Point3(10, 0, 0)).norm(), 0.5, 1e-12);
    }
  }
}

TEST(ParallelPath, OfAnArcHasTheSameCentre) {
  struct Row {
    double radius;
    Side side;
    double moved;  // mm from the centre; negative: beyond it
  };
  for (const Row& row : {Row{3, Side::kLeft, 2.5}, Row{3, Side::kRight, 3.5},
                         Row{0.2, Side::kLeft, -0.3}, Row{0.5, Side::kLeft, 0}}) {
    const auto made = parallel_path(Path{quarter(row.radius)}, row.side, 0.5);
    ASSERT_TRUE(made);
    const Point3 expected = row.moved * Point3(std::sqrt(0.5), std::sqrt(0.5), 0);
    EXPECT_LT((point_at(made->front(), 0.5) - expected).norm(), 1e-12) << row.moved;
  }
}

// Every place of the moved path belongs to one of the path: it is as far from it as it was moved.
TEST(ParallelPath, IsAsFarFromThePathAsItWasMoved) {
  Path path = square_corner();
  path.push_back(Line{{10, 10, 0}, {4, 3, 0}});
  path.push_back(Line{{4, 3, 0}, {0, 9, 1}});
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const auto made = parallel_path(path, side, 0.25);
    ASSERT_TRUE(made);
    EXPECT_EQ(compare_paths(path, *made, 0.2501).verdict, Verdict::kProved);
    EXPECT_EQ(compare_paths(path, *made, 0.2499).verdict, Verdict::kBroken);
  }
}

TEST(ParallelPath, StaysWhereItWasWhereThePathGoesStraightDown) {
  const Path path = {Line{{0, 0, 5}, {0, 0, 0}}, Line{{0, 0, 0}, {10, 0, 0}},
                     Line{{10, 0, 0}, {10, 0, 5}}};
  const auto made = parallel_path(path, Side::kLeft, 1);
  ASSERT_TRUE(made);
  ASSERT_EQ(made->size(), 3u);
  expect_line((*made)[0], {0, 1, 5}, {0, 1, 0});
  expect_line((*made)[2], {10, 1, 0}, {10, 1, 5});
}

TEST(ParallelPath, OfWhatHasNoSideIsNone) {
  EXPECT_FALSE(parallel_path(square_corner(), Side::kBoth, 1));
  const Arc upright = {{1, 0, 0}, {0, 0, 1}, {0, 0, 0}, -Vector3::UnitY(), pi / 2};
  EXPECT_FALSE(parallel_path(Path{upright}, Side::kLeft, 0.1));
  EXPECT_FALSE(parallel_path(Path{CubicBezier{}}, Side::kLeft, 0.1));
}

TEST(LeftOf, IsLevelAndOfUnitLength) {
  EXPECT_EQ(left_of(Vector3(1, 0, 0)), Vector3(0, 1, 0));
  EXPECT_LT((left_of(Vector3(0, 0.6, 0.8)) - Vector3(-1, 0, 0)).norm(), 1e-15);
  EXPECT_TRUE(left_of(Vector3(0, 0, -1)).isZero());
}

}  // namespace
}  // namespace batten::geometry
