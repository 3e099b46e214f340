// What must hold for the distance of any two paths, on seeded random ones.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "geometry/distance/path_distance.h"

namespace batten::geometry {
namespace {

using Places = std::vector<Point3>;

Path chain(const Places& places) {
  Path path;
  for (std::size_t i = 1; i < places.size(); ++i) path.push_back(Line{places[i - 1], places[i]});
  return path;
}

double uniform(std::mt19937& random, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random);
}

Vector3 random_vector(std::mt19937& random, double size) {
  return {uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size)};
}

// A sum of three waves in each coordinate; |second derivative| <= bend for t in [0, 1].
struct SmoothCurve {
  Vector3 amplitude[3];
  double frequency[3];
  double phase[3];

  explicit SmoothCurve(std::mt19937& random) {
    for (int k = 0; k < 3; ++k) {
      amplitude[k] = random_vector(random, 10.0 / (1 + k));
      frequency[k] = uniform(random, 1, 12);
      phase[k] = uniform(random, 0, 6);
    }
  }
  [[nodiscard]] Point3 at(double t) const {
    Point3 sum = Point3::Zero();
    for (int k = 0; k < 3; ++k) sum += std::sin(frequency[k] * t + phase[k]) * amplitude[k];
    return sum;
  }
  [[nodiscard]] double bend() const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += frequency[k] * frequency[k] * amplitude[k].norm();
    return sum;
  }
  [[nodiscard]] Places sampled(int parts) const {
    Places places;
    for (int k = 0; k <= parts; ++k) places.push_back(at(static_cast<double>(k) / parts));
    return places;
  }
};

// A path that walks at random, folds back now and then, and stands now and then.
Places random_walk(std::mt19937& random, int steps) {
  Places places{random_vector(random, 5)};
  Vector3 heading = random_vector(random, 1);
  for (int k = 0; k < steps; ++k) {
    const double what = uniform(random, 0, 1);
    if (what < 0.1) heading = -heading;
    if (what > 0.95) places.push_back(places.back());
    heading += random_vector(random, 0.5);
    places.push_back(places.back() + heading);
  }
  return places;
}

Places shifted(Places places, const Vector3& by) {
  for (Point3& place : places) place += by;
  return places;
}

Places jittered(std::mt19937& random, Places places, double size) {
  for (Point3& place : places) place += random_vector(random, size);
  return places;
}

// The discrete Fréchet distance (Eiter, Mannila 1994) of the vertices: an independent
// formula, larger than the continuous one by half the longest step at the most.
double discrete_distance(const Places& a, const Places& b) {
  std::vector<double> row(b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    double diagonal = 0;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const double before = row[j];
      double way = std::min(before, j > 0 ? std::min(row[j - 1], diagonal) : before);
      if (i == 0) way = j > 0 ? row[j - 1] : 0;
      row[j] = std::max(way, (a[i] - b[j]).norm());
      diagonal = before;
    }
  }
  return row.back();
}

Places refined(const Places& places, double step) {
  Places result{places.front()};
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Vector3 along = places[i] - places[i - 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(along.norm() / step)));
    for (int k = 1; k <= parts; ++k) {
      result.push_back(places[i - 1] + (static_cast<double>(k) / parts) * along);
    }
  }
  return result;
}

TEST(PathDistanceProperty, AgreesWithTheDiscreteDistanceOfFineSamples) {
  int broken = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Places a = random_walk(random, 12);
    const Places b = seed % 3 == 0 ? random_walk(random, 12) : jittered(random, a, 0.7);
    constexpr double kStep = 0.02;
    const double discrete = discrete_distance(refined(a, kStep), refined(b, kStep));
    const double lowest = discrete - kStep / 2 - 1e-9;
    // A little above the truth, so that the bound has to be close; then below it.
    const double tolerance = 1.03 * discrete;
    const PathComparison found = compare_paths(chain(a), chain(b), tolerance);
    ASSERT_EQ(found.verdict, Verdict::kProved);
    EXPECT_GE(found.bounds.at_most, lowest);
    EXPECT_LE(found.bounds.at_least, discrete + 1e-9);
    EXPECT_LE(found.bounds.at_most, discrete + 0.02 * tolerance);
    if (lowest > 0.97 * discrete) {
      EXPECT_EQ(compare_paths(chain(a), chain(b), 0.97 * discrete).verdict, Verdict::kBroken);
      ++broken;
    }
  }
  EXPECT_GT(broken, 40);
}

TEST(PathDistanceProperty, FindsACurveNearItsOwnResampling) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const SmoothCurve curve(random);
    const int parts = 300 + static_cast<int>(seed) * 7;
    const int others = 200 + static_cast<int>(seed) * 3;
    // Both chains are within bend * h^2 / 8 of the curve at equal t.
    const double near = curve.bend() / 8 * (1.0 / parts / parts + 1.0 / others / others);
    const PathComparison found =
        compare_paths(chain(curve.sampled(parts)), chain(curve.sampled(others)), near);
    EXPECT_EQ(found.verdict, Verdict::kProved);
  }
}

TEST(PathDistanceProperty, DecidesShiftsJustInsideAndJustOutside) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Places a = random_walk(random, 200);
    const Vector3 direction = random_vector(random, 1).normalized();
    constexpr double kTolerance = 0.01;
    const Path path = chain(a);
    const PathComparison inside =
        compare_paths(path, chain(shifted(a, 0.99 * kTolerance * direction)), kTolerance);
    EXPECT_EQ(inside.verdict, Verdict::kProved);
    EXPECT_GE(inside.bounds.at_most, 0.99 * kTolerance * (1 - 1e-9));
    EXPECT_EQ(
        compare_paths(path, chain(shifted(a, 1.01 * kTolerance * direction)), kTolerance).verdict,
        Verdict::kBroken);
  }
}

TEST(PathDistanceProperty, KeepsTheTriangleInequality) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Places a = random_walk(random, 25);
    const Places b = jittered(random, a, 0.02);
    const Places c = jittered(random, b, 0.03);
    const PathComparison ab = compare_paths(chain(a), chain(b), 0.2);
    const PathComparison bc = compare_paths(chain(b), chain(c), 0.2);
    const PathComparison ac = compare_paths(chain(a), chain(c), 0.2);
    EXPECT_LE(ac.bounds.at_least, ab.bounds.at_most + bc.bounds.at_most);
  }
}

Places scaled(Places places, double by) {
  for (Point3& place : places) place *= by;
  return places;
}

Places reversed(Places places) {
  std::reverse(places.begin(), places.end());
  return places;
}

TEST(PathDistanceProperty, IsTheSameWithPathsSwappedReversedAndScaled) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Places a = random_walk(random, 30);
    const Places b = jittered(random, a, 0.05);
    const double tolerance = seed % 2 == 0 ? 0.08 : 0.1;
    const PathComparison found = compare_paths(chain(a), chain(b), tolerance);
    const auto expect_same = [&](const Places& c, const Places& d, double scale, double near) {
      const PathComparison other = compare_paths(chain(c), chain(d), scale * tolerance);
      EXPECT_EQ(other.verdict, found.verdict);
      EXPECT_LE(found.bounds.at_least, other.bounds.at_most / scale * (1 + 1e-9));
      EXPECT_LE(other.bounds.at_least / scale, found.bounds.at_most * (1 + 1e-9));
      if (found.verdict == Verdict::kProved) {
        EXPECT_NEAR(other.bounds.at_most / scale, found.bounds.at_most, near * tolerance);
      }
    };
    expect_same(b, a, 1, 0.02);
    expect_same(reversed(a), reversed(b), 1, 0.02);
    for (const double k : {1e-3, 0.25, 3.0, 500.0})
      expect_same(scaled(a, k), scaled(b, k), k, 1e-6);
  }
}

TEST(PathDistanceProperty, ProvesArcsAgainstTheirOwnParts) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Vector3 axis = random_vector(random, 1).normalized();
    const Vector3 out = axis.unitOrthogonal();
    const Point3 center = random_vector(random, 100);
    const double radius = std::pow(10.0, uniform(random, -1, 3));
    const double sweep = uniform(random, 0.1, 6) * (seed % 2 == 0 ? 1 : -1);
    const auto at = [&](double angle) -> Point3 {
      return center + radius * (std::cos(angle) * out + std::sin(angle) * axis.cross(out));
    };
    const PathPiece arc = Arc{at(0), at(sweep) + 0.3 * axis, center, axis, sweep};
    const double cut = uniform(random, 0.1, 0.9);
    constexpr double kTolerance = 0.002;
    const Path parts{sub_piece(arc, 0, cut), sub_piece(arc, cut, 1)};
    const PathComparison same = compare_paths(Path{arc}, parts, kTolerance);
    EXPECT_EQ(same.verdict, Verdict::kProved);
    EXPECT_LE(same.bounds.at_most, 0.03 * kTolerance);
    Path off = parts;
    for (PathPiece& piece : off) {
      Arc& part = std::get<Arc>(piece);
      const Vector3 by = 1.05 * kTolerance * out;
      part = Arc{part.start + by, part.end + by, part.center + by, part.axis, part.sweep};
    }
    EXPECT_EQ(compare_paths(Path{arc}, off, kTolerance).verdict, Verdict::kBroken);
  }
}

}  // namespace
}  // namespace batten::geometry
