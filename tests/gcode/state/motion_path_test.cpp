#include <gtest/gtest.h>

#include <utility>
#include <variant>

#include "gcode/state/motion.h"

namespace batten::gcode {
namespace {

using geometry::Arc;
using geometry::CubicBezier;
using geometry::Line;
using geometry::PathPiece;
using geometry::Point3;

const Arc kQuarter{Point3(1, 0, 0), Point3(0, 1, 2), Point3(0, 0, 0), Point3(0, 0, 1), 1.5};
const CubicBezier kCubic{{Point3(0, 0, 0), Point3(1, 0, 0), Point3(1, 1, 0), Point3(2, 1, 3)}};

TEST(MotionPath, IsThePieceThatItWasMadeOfAndKnowsItsEnds) {
  const Line straight{Point3(1, 2, 3), Point3(4, 5, 6)};
  for (const PathPiece& piece : {PathPiece(straight), PathPiece(kQuarter), PathPiece(kCubic)}) {
    const MotionPath path(piece);
    EXPECT_EQ(path.start(), geometry::start_point(piece));
    EXPECT_EQ(path.end(), geometry::end_point(piece));
    EXPECT_EQ(path.is_line(), std::holds_alternative<Line>(piece));
    EXPECT_EQ(path.arc() != nullptr, std::holds_alternative<Arc>(piece));
    EXPECT_EQ(PathPiece(path).index(), piece.index());
    for (const double t : {0.0, 0.3, 1.0}) {
      EXPECT_EQ(geometry::point_at(PathPiece(path), t), geometry::point_at(piece, t));
    }
  }
  EXPECT_EQ(MotionPath(kQuarter).arc()->sweep, kQuarter.sweep);
}

TEST(MotionPath, IsCopiedWithItsBend) {
  MotionPath arc(kQuarter);
  MotionPath copy(arc);
  ASSERT_NE(copy.arc(), nullptr);
  EXPECT_NE(copy.arc(), arc.arc()) << "two motions share one bend";
  copy = MotionPath(Line{Point3(0, 0, 0), Point3(1, 0, 0)});
  EXPECT_TRUE(copy.is_line());
  EXPECT_NE(arc.arc(), nullptr);
  copy = arc;
  EXPECT_EQ(copy.arc()->center, kQuarter.center);
  EXPECT_EQ(copy.end(), kQuarter.end);
  MotionPath moved(std::move(copy));
  EXPECT_EQ(moved.arc()->sweep, kQuarter.sweep);
}

// What is held per block of a program of a million lines.
TEST(MotionPath, TakesLittleRoomPerBlock) {
  EXPECT_LE(sizeof(Motion), 72U);
  EXPECT_LE(sizeof(BlockMeaning), 16U);
  EXPECT_LE(sizeof(Block), 36U);
  EXPECT_LE(sizeof(Word), 24U);
}

}  // namespace
}  // namespace batten::gcode
