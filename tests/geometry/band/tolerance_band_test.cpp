#include "geometry/band/tolerance_band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "geometry/path/path.h"
#include "tests/support/overlapping_paths.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

using std::numbers::pi;

std::vector<Point2> arc_points(const Point2& center, double radius, double from, double to,
                               int edges) {
  std::vector<Point2> points;
  for (int i = 0; i <= edges; ++i) {
    const double a = from + (to - from) * i / edges;
    points.emplace_back(center.x() + radius * std::cos(a), center.y() + radius * std::sin(a));
  }
  return points;
}

std::vector<Point2> figure_of_eight(const Point2& shift) {
  std::vector<Point2> points;
  for (int i = 0; i <= 200; ++i) {
    const double a = 2 * pi * i / 200 + 0.1;
    points.emplace_back(10 * std::sin(a) + shift.x(), 5 * std::sin(2 * a) + shift.y());
  }
  return points;
}

std::vector<NewCrossing> crossings_of(const Path& before, const Path& after, double tolerance) {
  const auto source = [](const Path& path) {
    return PathSource{path.size(), [&path](std::size_t i) { return path[i]; }};
  };
  return new_crossings(source(before), source(after), tolerance);
}

Path path_at(const std::vector<Point2>& points, double height, int axis = 2) {
  std::vector<Point3> places;
  for (const Point2& p : points) {
    Point3 place;
    place[axis] = height;
    place[axis == 0 ? 1 : 0] = p.x();
    place[axis == 2 ? 1 : 2] = p.y();
    places.push_back(place);
  }
  return path_through(places);
}

BandStructure structure_of(const std::vector<Point2>& points, double tolerance) {
  const auto found = band_structure(points, tolerance);
  EXPECT_TRUE(found.has_value());
  return found.value_or(BandStructure{});
}

double area_of(const std::vector<Point2>& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& a = polygon[i];
    const Point2& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

// --- overlaps ----------------------------------------------------------------------------------

TEST(BandStructure, PathsBesideThemselvesDoNotOverlap) {
  std::vector<Point2> dense;
  for (int i = 0; i <= 500; ++i) dense.emplace_back(0.003 * i, 0);
  EXPECT_TRUE(structure_of(dense, 0.01).overlaps.empty());
  EXPECT_TRUE(structure_of({{0, 0}, {10, 0}, {0, 1}}, 0.01).overlaps.empty()) << "a sharp corner";
  EXPECT_TRUE(structure_of({{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}}, 0.01).overlaps.empty())
      << "a ring: its ends are neighbours";
  EXPECT_TRUE(structure_of({}, 0.01).overlaps.empty());
  EXPECT_TRUE(structure_of({{1, 1}}, 0.01).overlaps.empty());
}

TEST(BandStructure, FindsTwoPassesThatAreNearerThanTwoTolerances) {
  const BandStructure found = structure_of(lollipop(0.015), 0.01);
  ASSERT_EQ(found.overlaps.size(), 1u);
  const BandOverlap& overlap = found.overlaps.front();
  EXPECT_EQ(overlap.first_from, 0u);
  EXPECT_EQ(overlap.first_to, 20u) << "the first leg of the loop starts inside the overlap";
  EXPECT_EQ(overlap.second_from, 23u);
  EXPECT_EQ(overlap.second_to, 43u);
  EXPECT_NEAR(overlap.distance, 0.015, 1e-12);
  EXPECT_FALSE(overlap.meets_itself);
  EXPECT_TRUE(structure_of(lollipop(0.015), 0.007).overlaps.empty());
}

TEST(BandStructure, SaysWhereThePathMeetsItself) {
  const BandStructure eight = structure_of(figure_of_eight({0, 0}), 0.01);
  ASSERT_EQ(eight.overlaps.size(), 1u);
  EXPECT_TRUE(eight.overlaps.front().meets_itself);
  EXPECT_EQ(eight.overlaps.front().distance, 0);

  std::vector<Point2> again = lollipop(0);
  again.pop_back();  // no ring
  const BandStructure twice = structure_of(again, 0.01);
  ASSERT_EQ(twice.overlaps.size(), 1u) << "the same pass again, backwards";
  EXPECT_TRUE(twice.overlaps.front().meets_itself);
}

TEST(BandStructure, EdgesAreThoseOfTheGivenPoints) {
  std::vector<Point2> points = lollipop(0.015);
  points.insert(points.begin() + 5, 7, points[5]);  // seven edges without length
  const BandStructure found = structure_of(points, 0.01);
  ASSERT_EQ(found.overlaps.size(), 1u);
  EXPECT_EQ(found.overlaps.front().second_from, 30u);
}

TEST(BandStructure, SaysNothingOfAHeap) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> within(0, 0.01);
  std::vector<Point2> heap;
  for (int i = 0; i < 1000; ++i) heap.emplace_back(within(random), within(random));
  EXPECT_FALSE(band_structure(heap, 0.01).has_value());
}

TEST(BandStructure, RefusesATolerancethatIsNone) {
  const std::vector<Point2> points{{0, 0}, {1, 0}};
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW((void)band_structure(points, wrong), std::invalid_argument);
    EXPECT_THROW((void)band_outline(points, wrong), std::invalid_argument);
  }
}

// --- cusps -------------------------------------------------------------------------------------

TEST(BandStructure, HasCuspsInsideBendsThatAreTighterThanTheBand) {
  const auto tight = structure_of(arc_points({0, 0}, 0.005, 0, pi, 12), 0.01);
  EXPECT_EQ(tight.cusps.size(), 10u) << "all edges but the first and the last";
  for (const BandCusp& cusp : tight.cusps) EXPECT_TRUE(cusp.left);
  const auto other_way = structure_of(arc_points({0, 0}, 0.005, pi, 0, 12), 0.01);
  EXPECT_EQ(other_way.cusps.size(), 10u);
  for (const BandCusp& cusp : other_way.cusps) EXPECT_FALSE(cusp.left);
  EXPECT_TRUE(structure_of(arc_points({0, 0}, 0.02, 0, pi, 12), 0.01).cusps.empty());
}

TEST(BandStructure, ACornerOrAZigzagIsNoCusp) {
  EXPECT_TRUE(structure_of({{0, 0}, {9.99, 0}, {10, 0}, {10, 0.01}, {10, 5}}, 0.005).cusps.empty());
  std::vector<Point2> zigzag;
  for (int i = 0; i < 20; ++i) zigzag.emplace_back(0.001 * i, i % 2 == 0 ? 0 : 0.002);
  EXPECT_TRUE(structure_of(zigzag, 0.01).cusps.empty());
}

// --- crossings -----------------------------------------------------------------------------------

TEST(NewCrossing, PassesThatChangeSidesAreFound) {
  const std::vector<Point2> old = lollipop(0.015);
  std::vector<Point2> apart = old;
  std::vector<Point2> over = old;
  for (std::size_t i = 8; i <= 12; ++i) {
    apart[i].y() = -0.009;
    over[i].y() = 0.009;
    over[44 - i].y() = 0.006;
  }
  EXPECT_TRUE(crossings_of(path_at(old, 1), path_at(apart, 1), 0.01).empty());
  const auto found = crossings_of(path_at(old, 1), path_at(over, 1), 0.01);
  ASSERT_EQ(found.size(), 2u) << "over to the other side, and back";
  EXPECT_EQ(found[0].first_piece, 7u);
  EXPECT_EQ(found[0].second_piece, 36u);
  EXPECT_NEAR(found[0].place.x(), 3.5 + 0.5 * 15 / 18, 1e-9) << "where 0.018 x = 0.015 - 0.018 x";
  EXPECT_DOUBLE_EQ(found[0].place.z(), 1);
  EXPECT_EQ(found[1].first_piece, 12u);
  EXPECT_EQ(found[1].second_piece, 31u);
}

struct CrossingCase {
  const char* name;
  std::vector<Point2> before;
  std::vector<Point2> after;
  bool found;
};

class NewCrossings : public testing::TestWithParam<CrossingCase> {};

TEST_P(NewCrossings, AreFoundInEveryPlane) {
  const auto& [name, before, after, found] = GetParam();
  for (const int axis : {0, 1, 2}) {
    const Path old = path_at(before, 4, axis);
    EXPECT_EQ(!crossings_of(old, path_at(after, 4, axis), 0.01).empty(), found);
    EXPECT_TRUE(crossings_of(old, old, 0.01).empty());
  }
}

std::vector<CrossingCase> crossing_cases() {
  const std::vector<Point2> passes = lollipop(0.015);
  const std::vector<Point2> same_pass = lollipop(0);
  std::vector<Point2> wavy = same_pass;
  for (std::size_t i = 1; i <= 19; ++i) wavy[i].y() = i % 2 == 0 ? 0.004 : -0.004;
  // Two lines that cross at a hundredth of a radian: 0.005 mm aside moves the crossing by 0.5 mm.
  const std::vector<Point2> flat{{0, 0}, {10, 0}, {10, 5}, {0, 5}, {0, 0.05}, {10, -0.05}};
  std::vector<Point2> moved = flat;
  moved[0].y() = moved[1].y() = 0.005;
  const std::vector<Point2> line{{0, 0}, {10, 0}};
  const std::vector<Point2> loop{{0, 0},     {5.004, 0},  {5.004, 0.004},
                                 {5, 0.004}, {5, -0.004}, {10, 0}};
  const std::vector<Point2> back{{0, 0}, {10, 0}, {4, 0}, {4, 6}};
  const std::vector<Point2> fold{{0, 0}, {4.005, 0}, {3.995, 0}, {4, 6}};
  const std::vector<Point2> corner{{0, 0}, {4, 0}, {4, 6}};
  return {{"PassesThatChangeSides", passes, crossing_lollipop(), true},
          {"ACrossingThatMoved", figure_of_eight({0, 0}), figure_of_eight({0.004, -0.006}), false},
          {"AFlatCrossingThatMovedFar", flat, moved, false},
          {"PassesThatLieOnEachOther", same_pass, wavy, false},
          {"ALittleLoop", line, loop, true},
          {"ALittleLoopThatWasThere", loop, loop, false},
          {"ATurnRightBackThatWasThere", back, back, false},
          {"ATurnRightBack", corner, fold, true}};
}

INSTANTIATE_TEST_SUITE_P(Paths, NewCrossings, testing::ValuesIn(crossing_cases()),
                         [](const auto& test) { return test.param.name; });

TEST(NewCrossing, ACircleMayEndWhereItBegan) {
  std::vector<Point2> polygon = arc_points({0, 0}, 10, 0, 2 * pi, 100);
  polygon.back() = polygon.front();
  polygon.insert(polygon.begin(), Point2(15, 0));
  polygon.emplace_back(15, 3);
  const Path old = path_at(polygon, 0);
  const Point3 start(10, 0, 0);
  const Path circle{Line{{15, 0, 0}, start}, Arc{start, {-10, 0, 0}, {0, 0, 0}, {0, 0, 1}, pi},
                    Arc{{-10, 0, 0}, start, {0, 0, 0}, {0, 0, 1}, pi}, Line{start, {15, 3, 0}}};
  EXPECT_TRUE(crossings_of(old, circle, 0.01).empty());
}

// Long paths are cut into chords part by part.
TEST(NewCrossing, IsFoundWhereverALongPathMeetsItself) {
  constexpr std::size_t kOut = 1700;
  std::vector<Point2> old;  // there and back, 0.015 mm beside
  for (std::size_t i = 0; i <= kOut; ++i) old.emplace_back(0.1 * static_cast<double>(i), 0);
  for (std::size_t i = 0; i <= kOut; ++i) {
    old.emplace_back(0.1 * static_cast<double>(kOut - i), 0.015);
  }
  std::vector<Point2> apart = old;
  for (Point2& each : apart) each.y() += 0.004;
  EXPECT_TRUE(crossings_of(path_at(old, 1), path_at(apart, 1), 0.01).empty());
  for (const std::size_t at : {std::size_t{5}, std::size_t{1023}, std::size_t{1024}, kOut - 3}) {
    std::vector<Point2> over = old;
    over[at].y() = 0.009;
    over[2 * kOut + 1 - at].y() = 0.006;
    const auto found = crossings_of(path_at(old, 1), path_at(over, 1), 0.01);
    ASSERT_EQ(found.size(), 2U) << at;
    EXPECT_EQ(found[0].first_piece, at - 1);
    EXPECT_EQ(found[1].first_piece, at);
    EXPECT_EQ(found[0].second_piece, 2 * kOut + 1 - at);
  }
}

// The line over a gap between two pieces counts, too.
TEST(NewCrossing, MayBeInAGap) {
  for (const std::size_t first : {std::size_t{4}, std::size_t{1024}}) {
    std::vector<Point2> points;
    for (std::size_t i = 0; i <= 1100; ++i) points.emplace_back(0.1 * static_cast<double>(i), 0);
    points.emplace_back(110, 5);
    const double across = 0.1 * static_cast<double>(first) + 0.55;
    points.emplace_back(across, 5);
    const Path old = path_at(points, 0);
    points.emplace_back(across, -5);
    Path gap = path_at(points, 0);
    EXPECT_EQ(crossings_of(old, gap, 0.01).size(), 1U);
    const auto from = gap.begin() + static_cast<std::ptrdiff_t>(first);
    gap.erase(from, from + 10);
    EXPECT_EQ(crossings_of(old, gap, 0.01).size(), 1U) << first;
  }
}

TEST(NewCrossing, PathsInSpaceAreNotLookedAt) {
  const std::vector<Point2> old = lollipop(0.015);
  const std::vector<Point2> over = crossing_lollipop();
  std::vector<Point3> rising;
  for (const Point2& p : over) {
    rising.emplace_back(p.x(), p.y(), 0.001 * static_cast<double>(rising.size()));
  }
  EXPECT_TRUE(crossings_of(path_at(old, 0), path_through(rising), 0.01).empty());
  EXPECT_TRUE(crossings_of({}, path_at(over, 0), 0.01).empty());
}

// --- outline -----------------------------------------------------------------------------------

TEST(BandOutline, LiesAroundTheBandByLessThanAHundredthOfTheTolerance) {
  const auto outline = band_outline(std::vector<Point2>{{0, 0}, {3, 4}}, 0.1);
  ASSERT_EQ(outline.size(), 1u);
  const double exact = 2 * 0.1 * 5 + pi * 0.01;
  EXPECT_GE(area_of(outline[0]), exact);
  EXPECT_LE(area_of(outline[0]), exact * 1.01);
}

TEST(BandOutline, ARingHasAHole) {
  const auto outline = band_outline(arc_points({0, 0}, 1, 0, 2 * pi, 60), 0.1);
  ASSERT_EQ(outline.size(), 2u);
  EXPECT_NEAR(area_of(outline[0]), pi * 1.1 * 1.1, 0.03);
  EXPECT_NEAR(area_of(outline[1]), -pi * 0.9 * 0.9, 0.03);
}

TEST(BandOutline, OfNothingIsNothing) {
  EXPECT_TRUE(band_outline({}, 0.1).empty());
  EXPECT_TRUE(band_outline(std::vector<Point2>{{1, 1}, {1, 1}}, 0.1).empty());
}

// Rounding lifts one vertex of the ring by the last printed digit: its two edges are in no plane,
// and the rest ends in the place where it begins.
TEST(NewCrossing, IsNotWhereARingClosesThatLeftThePlane) {
  std::vector<Point2> ring = arc_points({0, 0}, 5, 0, 2 * pi, 60);
  ring.back() = ring.front();
  const Path before = path_at(ring, 3);
  Path after = before;
  std::get<Line>(after[30]).end.z() += 1e-4;
  std::get<Line>(after[31]).start.z() += 1e-4;
  EXPECT_TRUE(crossings_of(before, after, 0.05).empty());
}

}  // namespace
}  // namespace batten::geometry
