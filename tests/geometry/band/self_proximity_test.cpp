// Long flat paths in parts: the strands that cover them, which of these are near to other parts,
// and where parts cross.
#include "geometry/band/self_proximity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "geometry/path/path.h"
#include "tests/support/overlapping_paths.h"

namespace batten::geometry {
namespace {

constexpr double kTolerance = 0.01;

double from_segment(const Point2& place, const Point2& a, const Point2& b) {
  const Point2 along = b - a;
  const double t = std::clamp((place - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (place - a - t * along).norm();
}

// By many places on both: good to a part of the step.
double apart(const SegmentCluster& a, const SegmentCluster& b) {
  double least = HUGE_VAL;
  for (int i = 0; i <= 400; ++i) {
    const Point2 place = a.from + i / 400.0 * (a.to - a.from);
    least = std::min(least, from_segment(place, b.from, b.to));
  }
  return least;
}

// A path that wanders and turns, sometimes sharply and sometimes straight back.
std::vector<Point2> wandering(unsigned seed, int edges) {
  std::mt19937 random(seed);
  const auto part = [&] { return static_cast<double>(random() % 10001) / 10000; };
  std::vector<Point2> points{{0, 0}};
  double heading = 0;
  double bend = 0.05;
  for (int i = 0; i < edges; ++i) {
    if (random() % 40 == 0) bend = 0.2 * (part() - 0.5);
    if (random() % 60 == 0) heading += 3.1 * part();
    heading += bend;
    const double step = 0.02 + 0.3 * part();
    points.push_back(points.back() + step * Point2(std::cos(heading), std::sin(heading)));
  }
  return points;
}

std::vector<SegmentCluster> cover_of(const std::vector<Point2>& points, double width) {
  ClusterCover cover(2, width);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    cover.add({points[i].x(), points[i].y(), 1}, {points[i + 1].x(), points[i + 1].y(), 1},
              static_cast<std::uint32_t>(i));
  }
  EXPECT_EQ(cover.edges(), points.size() - 1);
  return cover.clusters().value_or(std::vector<SegmentCluster>{});
}

TEST(ClusterCover, HoldsEveryEdgeWithinItsWidth) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Point2> points = wandering(seed, 2000);
    const std::vector<SegmentCluster> clusters = cover_of(points, kTolerance);
    std::uint32_t next = 0;
    for (const SegmentCluster& cluster : clusters) {
      EXPECT_EQ(cluster.first, next) << "each edge is in one";
      EXPECT_EQ(cluster.height, 1);
      for (std::size_t i = cluster.first; i <= cluster.last + 1; ++i) {
        EXPECT_LE(from_segment(points[i], cluster.from, cluster.to), kTolerance * (1 + 1e-9));
      }
      next = cluster.last + 1;
    }
    EXPECT_EQ(next, points.size() - 1);
    EXPECT_LT(clusters.size(), points.size() / 2) << "or it would be no coarser than the path";
  }
}

TEST(ClusterCover, LeavesOutWhatIsNotFlat) {
  ClusterCover cover(2, kTolerance);
  cover.add({0, 0, 0}, {1, 0, 0}, 1);
  cover.add({1, 0, 0}, {2, 0, 1}, 2);
  cover.add({2, 0, 1}, {3, 0, 1}, 3);
  const auto clusters = cover.clusters();
  ASSERT_TRUE(clusters);
  ASSERT_EQ(clusters->size(), 2U);
  EXPECT_EQ((*clusters)[0].last, 1U);
  EXPECT_EQ((*clusters)[1].first, 3U);
}

TEST(StrandsNearOtherParts, AreThoseThatComparingAllFinds) {
  const double reach = reach_between_parts(kTolerance, kTolerance);
  std::size_t near_ones = 0;
  for (unsigned seed = 0; seed < 2; ++seed) {
    const std::vector<SegmentCluster> clusters = cover_of(wandering(seed, 1200), kTolerance);
    const std::vector<std::uint32_t> cuts = {300, 700, 1000};
    std::vector<std::uint32_t> found;
    for (const SegmentCluster& cluster : clusters_near_other_parts(clusters, cuts, reach)) {
      found.push_back(cluster.first);
    }
    for (const SegmentCluster& cluster : clusters) {
      double least = HUGE_VAL;
      for (const SegmentCluster& other : clusters) {
        if (part_of(other.first, cuts) == part_of(cluster.first, cuts)) continue;
        least = std::min(least, std::min(apart(cluster, other), apart(other, cluster)));
      }
      const bool in_two = part_of(cluster.first, cuts) != part_of(cluster.last, cuts);
      if (!in_two && std::abs(least - reach) < 1e-3) continue;  // too near to call by places
      EXPECT_EQ(std::ranges::binary_search(found, cluster.first), in_two || least < reach)
          << "seed " << seed << ", strand from " << cluster.first << ", " << least << " mm";
    }
    near_ones += found.size();
  }
  EXPECT_GE(near_ones, 20U) << "or nothing was asked";
}

// --- crossings -----------------------------------------------------------------------------------

std::vector<PartEdge> edges_of(const std::vector<Point2>& points, std::uint32_t cut) {
  std::vector<PartEdge> edges;
  for (std::uint32_t i = 0; i + 1 < points.size(); ++i) {
    const Point3 from(points[i].x(), points[i].y(), 2);
    const Point3 to(points[i + 1].x(), points[i + 1].y(), 2);
    const PathPiece piece = Line{from, to};
    const std::uint32_t cuts[] = {cut};
    for (const PartEdge& edge : flat_edges({&piece, 1}, 2, kTolerance, i, part_of(i, cuts))) {
      edges.push_back(edge);
    }
  }
  return edges;
}

TEST(NewCrossingsOfParts, AreThoseOfTheWholePathWhereTwoPartsMeet) {
  const std::vector<Point2> old = lollipop(0.015);
  const std::vector<Point2> over = crossing_lollipop();
  const auto found = new_crossings_of_parts(edges_of(old, 22), edges_of(over, 22), kTolerance);
  ASSERT_EQ(found.size(), 2U) << "it comes over and goes back";
  for (const PartCrossing& crossing : found) {
    EXPECT_TRUE(std::ranges::any_of(crossing.labels, [](std::uint32_t i) { return i < 22; }));
    EXPECT_TRUE(std::ranges::any_of(crossing.labels, [](std::uint32_t i) { return i >= 22; }));
  }
  EXPECT_TRUE(new_crossings_of_parts(edges_of(old, 22), edges_of(old, 22), kTolerance).empty());
  // What one part does to itself is looked at where it is proved.
  EXPECT_TRUE(new_crossings_of_parts(edges_of(old, 99), edges_of(over, 99), kTolerance).empty());
}

TEST(NewCrossingsOfParts, MayBeWhereTheOldPartsMet) {
  const std::vector<Point2> old = lollipop(0);
  std::vector<Point2> wavy = old;
  for (std::size_t i = 1; i <= 19; ++i) wavy[i].y() = i % 2 == 0 ? 0.004 : -0.004;
  EXPECT_TRUE(new_crossings_of_parts(edges_of(old, 22), edges_of(wavy, 22), kTolerance).empty());
}

TEST(NewCrossingsOfParts, AreNotMadeByPlanesAboveEachOther) {
  const std::vector<Point2> old = lollipop(0.015);
  const std::vector<Point2> over = crossing_lollipop();
  std::vector<PartEdge> before = edges_of(old, 22);
  std::vector<PartEdge> after = edges_of(over, 22);
  for (std::vector<PartEdge>* edges : {&before, &after}) {
    for (PartEdge& edge : *edges) edge.height = edge.part;
  }
  EXPECT_TRUE(new_crossings_of_parts(before, after, kTolerance).empty());
}

}  // namespace
}  // namespace batten::geometry
