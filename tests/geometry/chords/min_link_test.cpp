#include "geometry/chords/min_link.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "geometry/chords/min_link_gates.h"
#include "geometry/chords/min_link_plane.h"
#include "tests/support/curve_of.h"
#include "tests/support/parabolas.h"

namespace batten::geometry {
namespace {

// Gates so fine that the strip is narrower than the tube by 2e-4 of the tolerance.
constexpr int kFineGates = 96;
constexpr int kFinestGates = 256;

double length_of(const std::vector<LinkVertex>& vertices) {
  double length = 0;
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    length += (vertices[i].place - vertices[i - 1].place).norm();
  }
  return length;
}

std::size_t links_on(const BsplineCurve& curve, double tolerance, int gates = 32) {
  return min_link_vertices(curve, curve.first(), curve.last(),
                           {.tolerance = tolerance, .gates_per_link = gates, .balanced = false})
             .size() -
         1;
}

// With fewer gates the count is one too many where it is nearly so by itself: 89 links need all but
// 2e-4 of the tolerance .00005.
TEST(MinLinkCount, IsThatOfTheTable) {
  for (const ParabolaRow& row : kParabolaRows) {
    SCOPED_TRACE(row.name);
    const BsplineCurve curve = row.parabola.curve();
    EXPECT_EQ(links_on(curve, row.tolerance, kFineGates), row.links);
    EXPECT_EQ(links_on(in_space(curve), row.tolerance, kFineGates), row.links);
    const std::size_t found = links_on(curve, row.tolerance);
    EXPECT_GE(found, row.links);
    EXPECT_LE(found, row.links == 89 ? row.links + 1 : row.links);
    const auto balanced =
        min_link_vertices(curve, row.parabola.from, row.parabola.to, {.tolerance = row.tolerance});
    EXPECT_EQ(balanced.size() - 1, found);
  }
}

// Where the count changes: 3 links on the flat parabola need T >= .05377, 4 go down to .02865; 5 on
// the steep one need T >= .05651, 6 go down to .03856.
TEST(MinLinkCount, ChangesAtTheKnownTolerances) {
  for (const auto& [tolerance, links] : {std::pair{.05377, 3U}, {.02865, 4U}}) {
    EXPECT_EQ(links_on(kFlatParabola.curve(), tolerance + 2e-5, kFinestGates), links);
    EXPECT_EQ(links_on(kFlatParabola.curve(), tolerance - 2e-5, kFinestGates), links + 1);
  }
  for (const auto& [tolerance, links] : {std::pair{.05651, 5U}, {.03856, 6U}}) {
    EXPECT_EQ(links_on(kSteepParabola.curve(), tolerance + 2e-5, kFinestGates), links);
    EXPECT_EQ(links_on(kSteepParabola.curve(), tolerance - 2e-5, kFinestGates), links + 1);
  }
}

// Vertices on the outer offset, links tangent to the inner one. On the flat parabola the end lies
// on the inner side of the last tangent: one vertex more, in front of the end.
TEST(MinLinkInPlane, HasTheVerticesOfTheClosedForm) {
  struct Example {
    Parabola parabola;
    double tolerance;
    std::vector<Point2> vertices;
    double length;
  };
  const Example examples[] = {
      {kFlatParabola,
       .05,
       {{2, 1.838}, {4.8659, 3.9156}, {8.0606, 5.3290}, {10.9983, 5.8392}, {11, 5.807}},
       10.047039},
      {kSteepParabola,
       .045,
       {{1, 2},
        {1.8012, 5.4085},
        {3.0433, 15.9795},
        {4.6438, 38.6979},
        {6.6037, 80.4724},
        {8.9232, 149.7665},
        {10, 191}},
       189.320747}};
  for (const Example& example : examples) {
    SCOPED_TRACE(testing::Message() << "tolerance " << example.tolerance);
    const BsplineCurve curve = example.parabola.curve();
    const CurvePieces pieces(curve, curve.first(), curve.last());
    const GateChain gates(pieces, curve.first(), curve.last(), 1e-6 * example.tolerance);
    const auto found =
        min_link_in_plane(gates, Vector3::UnitZ(), gates[0].center, example.tolerance);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->size(), example.vertices.size());
    for (std::size_t i = 0; i < found->size(); ++i) {
      EXPECT_NEAR((*found)[i].place.x(), example.vertices[i].x(), 1e-4) << i;
      EXPECT_NEAR((*found)[i].place.y(), example.vertices[i].y(), 1.5e-3) << i;
    }
    EXPECT_NEAR(length_of(*found), example.length, 1e-6);
  }
}

// On a circle of radius r a link between vertices at r + T, tangent to r - T, spans
// 2 acos((r - T) / (r + T)); the first and the last begin on the circle and span
// acos((r - T) / r) + acos((r - T) / (r + T)).
TEST(MinLinkCount, IsThatOfTheClosedFormOnACircle) {
  const double r = 10;
  const double sweep = 5;
  const auto circle = [&](double u) { return Point3(r * std::cos(u), r * std::sin(u), 0); };
  const BsplineCurve curve = curve_of(circle, 0, sweep, 400);
  for (const double tolerance : {0.5, 0.1, 0.04, 0.01}) {
    const double half = std::acos((r - tolerance) / (r + tolerance));
    const double ends = 2 * (std::acos((r - tolerance) / r) + half);
    const double links = 2 + (sweep - ends) / (2 * half);
    const auto found =
        min_link_vertices(curve, 0, sweep, {.tolerance = tolerance, .gates_per_link = kFineGates});
    EXPECT_EQ(static_cast<double>(found.size() - 1), std::ceil(links))
        << tolerance << ", " << links;
  }
}

// In space no minimum is claimed, but where the bend is even and hardly leaves a plane along a
// link, links are as long as in the plane, sqrt(16 T R); the first and the last may be shorter.
TEST(MinLinkCount, OfAHelixIsThatOfItsBend) {
  const double r = 10;
  const double rise = 3;
  const auto helix = [&](double u) { return Point3(r * std::cos(u), r * std::sin(u), rise * u); };
  const BsplineCurve curve = curve_of(helix, 0, 20, 1200);
  const double length = 20 * std::hypot(r, rise);
  const double radius = (r * r + rise * rise) / r;
  for (const double tolerance : {0.05, 0.02, 0.01}) {
    const double even = length / std::sqrt(16 * tolerance * radius);
    const auto found = min_link_vertices(curve, 0, 20, {.tolerance = tolerance});
    EXPECT_LE(static_cast<double>(found.size() - 1), std::ceil(even) + 1) << tolerance;
    EXPECT_GE(static_cast<double>(found.size() - 1), even) << tolerance;
  }
}

TEST(MinLinkVertices, AreNotFartherApartThanBalancedOnes) {
  // Balanced: the least tolerance with 6 links on the steep parabola is .03856.
  const auto vertices = min_link_vertices(kSteepParabola.curve(), 1, 10, {.tolerance = .045});
  ASSERT_EQ(vertices.size(), 7U);
  for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
    const double off =
        (vertices[i].place - kSteepParabola.curve().point_at(vertices[i].parameter)).norm();
    EXPECT_NEAR(off, .03856, .0006);
  }
}

TEST(MinLinkVertices, CoverALineWithOneLink) {
  const BsplineCurve line(BsplineBasis::clamped(3, {0, 1}),
                          {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}});
  const auto vertices = min_link_vertices(line, 0, 1, {.tolerance = 1e-3});
  ASSERT_EQ(vertices.size(), 2U);
  EXPECT_EQ(vertices.front().place, Point3(0, 0, 0));
  EXPECT_EQ(vertices.back().place, Point3(3, 3, 3));
}

TEST(MinLinkVertices, StandOnCorners) {
  const BsplineCurve corner(
      BsplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2}),
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {3, 2, 0}, {3, 3, 0}});
  const auto vertices = min_link_vertices(corner, 0, 2, {.tolerance = 1});
  ASSERT_EQ(vertices.size(), 3U);
  EXPECT_EQ(vertices[1].place, Point3(3, 0, 0));
}

TEST(MinLinkVertices, RefuseOptionsOutsideTheirRange) {
  const BsplineCurve curve = kFlatParabola.curve();
  EXPECT_THROW((void)min_link_vertices(curve, 2, 11, {.tolerance = 0}), std::invalid_argument);
  EXPECT_THROW((void)min_link_vertices(curve, 2, 11, {.gates_per_link = 7}), std::invalid_argument);
}

// The fewest links between places on a grid: so many gates, so many offsets on each, all tried.
// A link is refused when it is further than the tolerance from the curve on a gate.
class GridOfPlaces {
 public:
  GridOfPlaces(const BsplineCurve& curve, double tolerance) : tolerance_(tolerance) {
    for (int i = 0; i <= kGates * kFiner; ++i) {
      const double u = curve.first() + (curve.last() - curve.first()) * i / (kGates * kFiner);
      const Vector3 along = curve.direction_at(u);
      centers_.push_back(curve.point_at(u));
      normals_.push_back(Vector3(-along.y(), along.x(), 0));
    }
  }

  int fewest_links() const {
    const auto places = static_cast<std::size_t>((kGates + 1) * kOffsets);
    std::vector<int> links(places, -1);
    const std::size_t start = kOffsets / 2;
    const std::size_t end = places - 1 - kOffsets / 2;
    std::vector<std::size_t> layer = {start};
    links[start] = 0;
    while (!layer.empty() && links[end] < 0) {
      std::vector<std::size_t> next;
      for (const std::size_t from : layer) {
        for (std::size_t to = from / kOffsets * kOffsets; to < places; ++to) {
          if (links[to] >= 0 || !sees(from, to)) continue;
          links[to] = links[from] + 1;
          next.push_back(to);
        }
      }
      layer = std::move(next);
    }
    return links[end];
  }

 private:
  static constexpr int kGates = 60;
  static constexpr int kFiner = 2;
  static constexpr std::size_t kOffsets = 17;

  Point3 place(std::size_t index) const {
    const std::size_t i = index / kOffsets * kFiner;
    const double part = 2.0 * static_cast<double>(index % kOffsets) / (kOffsets - 1) - 1;
    return centers_[i] + part * tolerance_ * normals_[i];
  }

  bool sees(std::size_t from, std::size_t to) const {
    const Point3 a = place(from);
    const Vector3 way = place(to) - a;
    for (std::size_t i = from / kOffsets * kFiner + 1; i < to / kOffsets * kFiner; ++i) {
      const double crossing = way.x() * normals_[i].y() - way.y() * normals_[i].x();
      if (crossing <= 0) return false;
      const Vector3 off = a - centers_[i];
      const double offset = (way.x() * off.y() - way.y() * off.x()) / crossing;
      if (std::abs(offset) > tolerance_ * (1 + 1e-9)) return false;
    }
    return true;
  }

  double tolerance_;
  std::vector<Point3> centers_;
  std::vector<Vector3> normals_;
};

// What the count by few gates is for: with more of them there are hardly fewer.
TEST(MinLinkCount, IsToldByFewGates) {
  for (const double rise : {0.0, 0.2}) {
    for (int seed = 1; seed <= 12; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", rise " << rise);
      const auto wave = [&](double u) {
        return Point3(u, 1.5 * std::sin(0.45 * u + seed) + 0.4 * std::sin((0.7 + 0.06 * seed) * u),
                      rise * u * std::sin(0.3 * u));
      };
      const BsplineCurve curve = curve_of(wave, 0, 60, 300);
      const auto told = static_cast<double>(links_on(curve, 0.002 * seed, 8));
      const auto links = static_cast<double>(links_on(curve, 0.002 * seed));
      EXPECT_GE(links, 0.93 * told);
      EXPECT_LE(links, told + 1);
    }
  }
}

// No path between places of a grid needs fewer links, also where the bend changes its side. (The
// grid's path may use 0.4 % more tolerance, since it is held against gates only.)
TEST(MinLinkCount, IsNotBeatenByTryingAllPlacesOfAGrid) {
  for (int seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto wave = [&](double u) {
      return Point3(u, 1.5 * std::sin(0.45 * u + seed) + 0.4 * std::sin((0.7 + 0.06 * seed) * u),
                    0);
    };
    const BsplineCurve curve = curve_of(wave, 0, 20, 60);
    const double tolerance = 0.03 + 0.01 * seed;
    const int on_grid = GridOfPlaces(curve, 0.98 * tolerance).fewest_links();
    ASSERT_GT(on_grid, 0);
    const auto found = min_link_vertices(curve, 0, 20, {.tolerance = tolerance});
    EXPECT_LE(static_cast<int>(found.size()) - 1, on_grid);
    // Every path has one beside it whose vertices stand on a grid that is somewhat wider.
    const int wider = GridOfPlaces(curve, 1.3 * tolerance).fewest_links();
    EXPECT_GE(static_cast<int>(found.size()) - 1, wider);
  }
}

}  // namespace
}  // namespace batten::geometry
