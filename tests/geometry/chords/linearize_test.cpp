#include "geometry/chords/linearize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <ostream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "geometry/fitting/fair/fair.h"
#include "tests/support/parabolas.h"
#include "tests/support/surface_programs.h"

namespace batten::geometry {
namespace {

struct ChordCount {
  std::string name;
  Parabola parabola;
  double deviation;
  std::size_t chords;
};

std::ostream& operator<<(std::ostream& out, const ChordCount& test) { return out << test.name; }

class GreedyChords : public testing::TestWithParam<ChordCount> {};

TEST_P(GreedyChords, AreAsManyAsTheClosedFormGives) {
  const auto& [name, parabola, deviation, chords] = GetParam();
  ChordOptions options;
  options.max_deviation = deviation;
  const auto x = chord_vertices(parabola.curve(), parabola.from, parabola.to, options);
  ASSERT_EQ(x.size(), chords + 1);
  EXPECT_EQ(x.front(), parabola.from);
  EXPECT_EQ(x.back(), parabola.to);
  double greatest = 0;
  double least = deviation;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double e = parabola.deviation(x[i - 1], x[i]);
    EXPECT_LE(e, deviation * (1 + 1e-9));
    greatest = std::max(greatest, e);
    least = std::min(least, e);
  }
  if (chords <= 50) {
    EXPECT_GE(least, 0.9 * greatest) << "chords are not balanced";
  }
}

INSTANTIATE_TEST_SUITE_P(Parabolas, GreedyChords,
                         testing::Values(ChordCount{"FlatCoarse", kFlatParabola, 0.05, 4},
                                         ChordCount{"FlatFine", kFlatParabola, 0.005, 13},
                                         ChordCount{"FlatFiner", kFlatParabola, 0.0005, 40},
                                         ChordCount{"FlatFinest", kFlatParabola, 0.00005, 126},
                                         ChordCount{"SteepCoarse", kSteepParabola, 0.045, 8},
                                         ChordCount{"SteepFine", kSteepParabola, 0.0045, 24},
                                         ChordCount{"SteepFiner", kSteepParabola, 0.00045, 75},
                                         ChordCount{"SteepFinest", kSteepParabola, 0.000045, 238}),
                         [](const auto& test) { return test.param.name; });

// The least deviation with as many chords, all equal, is .04921 for the four of the flat
// parabola and .039244 for the eight of the steep one.
TEST(ChordVertices, AreSpreadUntilTheLastChordIsNoRemainder) {
  for (const auto& [parabola, deviation, balanced] :
       {std::tuple{kFlatParabola, 0.05, 0.04921}, {kSteepParabola, 0.045, 0.039244}}) {
    ChordOptions options;
    options.max_deviation = deviation;
    const auto x = chord_vertices(parabola.curve(), parabola.from, parabola.to, options);
    double greatest = 0;
    for (std::size_t i = 1; i < x.size(); ++i) {
      greatest = std::max(greatest, parabola.deviation(x[i - 1], x[i]));
    }
    EXPECT_NEAR(greatest, balanced, 0.01 * balanced);
  }
}

// A stadium: two lines of 50 mm, joined by half circles of radius 5 as four cubics each
// (handles 4/3 tan(angle/4) r; a cubic of 45 degrees is a circle to within 4e-6 of r).
BsplineCurve stadium() {
  std::vector<Point3> points = {{0, 0, 0}};
  const auto line_to = [&points](const Point3& end) {
    const Point3 start = points.back();
    points.push_back(start + (end - start) / 3);
    points.push_back(start + 2 * (end - start) / 3);
    points.push_back(end);
  };
  const auto half_circle_about = [&points](const Point3& center) {
    const double handle = 4.0 / 3 * std::tan(std::numbers::pi / 16);
    for (int i = 0; i < 4; ++i) {
      const Vector3 r = points.back() - center;
      const Vector3 forward(-r.y(), r.x(), 0);
      const double c = std::cos(std::numbers::pi / 4);
      const Vector3 turned = c * r + c * forward;
      const Vector3 turned_forward(-turned.y(), turned.x(), 0);
      points.push_back(center + r + handle * forward);
      points.push_back(center + turned - handle * turned_forward);
      points.push_back(center + turned);
    }
  };
  line_to({50, 0, 0});
  half_circle_about({50, 5, 0});
  line_to({0, 10, 0});
  half_circle_about({0, 5, 0});
  std::vector<double> knots(4, 0.0);
  const std::size_t spans = (points.size() - 1) / 3;
  for (std::size_t i = 1; i < spans; ++i) knots.insert(knots.end(), 3, static_cast<double>(i));
  knots.insert(knots.end(), 4, static_cast<double>(spans));
  return BsplineCurve(BsplineBasis(3, knots), points);
}

TEST(ChordVertices, CoverStraightSpansWhole) {
  const auto u = chord_vertices(stadium(), 0, 10, ChordOptions{});
  for (double line_end : {0.0, 1.0, 5.0, 6.0, 10.0}) {
    EXPECT_NE(std::find(u.begin(), u.end(), line_end), u.end()) << line_end;
  }
  // One chord per line; on a half circle an angle of 2 acos(1 - 0.01 / 5) per chord: 25.
  EXPECT_EQ(u.size() - 1, 2u + 2 * 25);
}

TEST(ChordVertices, KeepToTheGreatestLength) {
  ChordOptions options;
  options.max_length = 8;
  const BsplineCurve curve = stadium();
  const auto u = chord_vertices(curve, 0, 1, options);
  ASSERT_EQ(u.size() - 1, 7u);  // 50 / 8 rounded up
  for (std::size_t i = 1; i < u.size(); ++i) {
    EXPECT_NEAR((curve.point_at(u[i]) - curve.point_at(u[i - 1])).norm(), 50.0 / 7, 0.01);
  }
}

TEST(ChordVertices, DivideALineExactlyWhereTheLengthGoesIntoIt) {
  ChordOptions options;
  options.max_length = 10;
  EXPECT_EQ(chord_vertices(stadium(), 0, 1, options).size() - 1, 5u);
}

TEST(ChordVertices, CoverShortLinesOnlyAboveTheLeastLength) {
  ChordOptions options;
  options.min_length = 60;  // longer than the stadium's lines
  const auto u = chord_vertices(stadium(), 0, 10, options);
  EXPECT_EQ(std::find(u.begin(), u.end(), 1.0), u.end());
}

TEST(ChordVertices, StandOnCorners) {
  const BsplineCurve corner(
      BsplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2}),
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1e-2, 0}, {3, 2e-2, 0}, {3, 3e-2, 0}});
  ChordOptions options;
  options.max_deviation = 1;
  EXPECT_EQ(chord_vertices(corner, 0, 2, options), (std::vector<double>{0, 1, 2}));
}

// On curves through noise the chords of narrower limits may be fewer: what one chord is proved for
// is not always proved for a part of it.
TEST(ChordVertices, ComeInOrderAlongUnevenCurves) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    for (const auto& row : surface_rows(0.005, 0.02, seed)) {
      FairOptions fair;
      fair.tolerance = 0.01;
      fair.feed = 6000;
      const auto path = fair_path(row, fair);
      ASSERT_TRUE(path);
      for (const double deviation : {0.0002, 0.0004, 0.0008, 0.0016}) {
        ChordOptions options;
        options.max_deviation = deviation;
        const auto u =
            chord_vertices(path->curve, path->curve.first(), path->curve.last(), options);
        EXPECT_TRUE(std::ranges::adjacent_find(u, std::greater_equal<>()) == u.end())
            << "seed " << seed << ", deviation " << deviation;
        EXPECT_EQ(u.back(), path->curve.last());
      }
    }
  }
}

TEST(ChordVertices, RefuseADeviationOfZero) {
  EXPECT_THROW((void)chord_vertices(stadium(), 0, 10, ChordOptions{0, 0, 0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
