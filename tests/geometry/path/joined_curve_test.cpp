#include "geometry/path/joined_curve.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace batten::geometry {
namespace {

BsplineCurve arch(double from, double to, const Point3& start) {
  const double middle = 0.5 * (from + to);
  return {BsplineBasis::clamped(3, {from, middle, to}),
          {start, start + Vector3(1, 1, 0), start + Vector3(2, 1.5, 0.5), start + Vector3(3, 1, 1),
           start + Vector3(4, 0, 0)}};
}

void expect_same(const BsplineCurve& whole, const BsplineCurve& part) {
  for (int i = 0; i <= 20; ++i) {
    const double u = part.first() + (part.last() - part.first()) * i / 20;
    EXPECT_LT((whole.point_at(u) - part.point_at(u)).norm(), 1e-14) << u;
  }
}

TEST(JoinedCurve, IsItsPartsOneAfterTheOther) {
  const BsplineCurve first = arch(0, 2, Point3::Zero());
  const BsplineCurve second = arch(2, 5, first.control_points().back());
  const BsplineCurve whole = joined(std::vector<BsplineCurve>{first, second});
  expect_same(whole, first);
  expect_same(whole, second);
  EXPECT_EQ(whole.breakpoints(), (std::vector<double>{0, 1, 2, 3.5, 5}));
  EXPECT_EQ(whole.control_points().size(), 9u);
  // The arches leave upwards and arrive downwards: a corner, and the curve keeps it.
  const Vector3 arriving = whole.direction_at(2 - 1e-9);
  const Vector3 leaving = whole.direction_at(2);
  EXPECT_LT((arriving - first.direction_at(2)).norm(), 1e-6);
  EXPECT_LT((leaving - second.direction_at(2)).norm(), 1e-12);
  EXPECT_GT((arriving - leaving).norm(), 0.5);
  const BsplineCurve one = joined(std::vector<BsplineCurve>{second});
  EXPECT_EQ(one.basis().knots(), second.basis().knots());
  EXPECT_EQ(one.control_points(), second.control_points());
}

TEST(JoinedCurve, RefusesWhatDoesNotJoin) {
  const BsplineCurve first = arch(0, 2, Point3::Zero());
  const BsplineCurve late = arch(2.5, 5, first.control_points().back());
  EXPECT_THROW((void)joined(std::vector<BsplineCurve>{}), std::invalid_argument);
  EXPECT_THROW((void)joined(std::vector<BsplineCurve>{first, late}), std::invalid_argument);
}

// Lines run evenly in the parameter, Bezier pieces as they are.
TEST(JoinedCurve, RunsThroughLinesAndBezierPieces) {
  const CubicBezier bend{{Point3(4, 0, 0), Point3(5, 0, 0), Point3(6, 1, 0), Point3(6, 2, 0)}};
  const Path pieces = {Line{Point3::Zero(), Point3(4, 0, 0)}, bend};
  const std::vector<double> stations = {0, 4, 7};
  const BsplineCurve curve = curve_of_pieces(pieces, stations);
  EXPECT_LT((curve.point_at(1) - Point3(1, 0, 0)).norm(), 1e-14);
  EXPECT_LT((curve.point_at(3.9) - Point3(3.9, 0, 0)).norm(), 1e-14);
  for (int i = 0; i <= 10; ++i) {
    EXPECT_LT((curve.point_at(4 + 0.3 * i) - point_at(PathPiece(bend), i / 10.0)).norm(), 1e-14);
  }
}

TEST(JoinedCurve, RefusesArcsAndStationsThatDoNotIncrease) {
  const Path line = {Line{Point3::Zero(), Point3(4, 0, 0)}};
  const Path arc = {Arc{Point3(1, 0, 0), Point3(0, 1, 0), Point3::Zero(), Vector3::UnitZ(), 1.57}};
  const std::vector<double> good = {0, 4};
  const std::vector<double> still = {1, 1};
  const std::vector<double> many = {0, 1, 2};
  EXPECT_NO_THROW((void)curve_of_pieces(line, good));
  EXPECT_THROW((void)curve_of_pieces(arc, good), std::invalid_argument);
  EXPECT_THROW((void)curve_of_pieces(line, still), std::invalid_argument);
  EXPECT_THROW((void)curve_of_pieces(line, many), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
