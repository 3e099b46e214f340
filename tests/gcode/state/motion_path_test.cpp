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

TEST(MotionPath, IsThePieceThatItWasMadeOf) {
  const MotionPath line(Line{Point3(1, 2, 3), Point3(4, 5, 6)});
  EXPECT_TRUE(line.is_line());
  EXPECT_EQ(line.arc(), nullptr);
  EXPECT_EQ(std::get<Line>(PathPiece(line)).start, Point3(1, 2, 3));
  EXPECT_EQ(std::get<Line>(PathPiece(line)).end, Point3(4, 5, 6));

  const MotionPath arc(kQuarter);
  EXPECT_FALSE(arc.is_line());
  ASSERT_NE(arc.arc(), nullptr);
  EXPECT_EQ(arc.arc()->sweep, kQuarter.sweep);
  EXPECT_EQ(std::get<Arc>(PathPiece(arc)).axis, kQuarter.axis);

  const MotionPath cubic{PathPiece(kCubic)};
  EXPECT_FALSE(cubic.is_line());
  EXPECT_EQ(cubic.arc(), nullptr);
  EXPECT_EQ(std::get<CubicBezier>(PathPiece(cubic)).control[2], kCubic.control[2]);
}

TEST(MotionPath, KnowsItsEndsWhateverItIs) {
  for (const PathPiece& piece : {PathPiece(Line{Point3(1, 2, 3), Point3(4, 5, 6)}),
                                 PathPiece(kQuarter), PathPiece(kCubic)}) {
    const MotionPath path(piece);
    EXPECT_EQ(path.start(), geometry::start_point(piece));
    EXPECT_EQ(path.end(), geometry::end_point(piece));
  }
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
