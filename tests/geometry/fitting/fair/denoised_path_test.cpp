#include "geometry/fitting/fair/denoised_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

// A row of the surface with noise of +-0.02 mm, which is 0.0115 mm rms upright.
std::vector<Point3> noisy_row(double cam_tolerance, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-0.02, 0.02);
  std::vector<Point3> row = FinishSurface::row(10, cam_tolerance);
  for (std::size_t i = 1; i + 1 < row.size(); ++i) {
    row[i] = printed(row[i] + Vector3(0, 0, off(random)), 3);
  }
  return row;
}

double rms_from_surface(const std::vector<Point3>& points) {
  double squares = 0;
  for (const Point3& p : points) squares += std::pow(FinishSurface::distance(p), 2);
  return std::sqrt(squares / static_cast<double>(points.size()));
}

// The denser the vertices, the more of them tell of one place.
TEST(MeantPath, IsNearerToTheSurfaceThanItsNoisyVertices) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto dense = noisy_row(0.002, seed);
    const auto coarse = noisy_row(0.01, seed);
    EXPECT_LE(rms_from_surface(denoised_positions(dense, find_features(dense, {}))),
              0.7 * rms_from_surface(dense));
    EXPECT_LE(rms_from_surface(denoised_positions(coarse, find_features(coarse, {}))),
              0.9 * rms_from_surface(coarse));
  }
}

// Of noise that may be rounding, only what leaves an eighth of 81 vertices outside the band.
TEST(MeantPath, IsTheVerticesWhereRoundingLeavesRoom) {
  const auto moved = [](double limit) {
    double count = 0;
    for (unsigned seed = 1; seed <= 6; ++seed) {
      const auto row = noisy_row(0.002, seed);
      const auto meant = denoised_among_noise(row, find_features(row, {}), limit, 0.01);
      double each = 0;
      for (std::size_t i = 0; i < meant.size(); ++i) each += meant[i] == row[i] ? 0 : 1;
      count += each / static_cast<double>(row.size()) / 6;
    }
    return count;
  };
  EXPECT_NEAR(moved(0.014), 0.61, 0.05);
  EXPECT_LT(moved(0.018), 0.01);
}

TEST(MeantPath, OfALineIsTheLine) {
  std::mt19937 random(5);
  std::normal_distribution<double> off(0, 0.01);
  std::vector<Point3> points;
  for (int i = 0; i <= 300; ++i) {
    points.emplace_back(0.3 * i, i % 300 == 0 ? 0 : off(random), 0);
  }
  double squares = 0;
  for (const Point3& p : denoised_positions(points, find_features(points, {}))) {
    squares += p.y() * p.y();
  }
  // Six of 300 degrees of freedom, or some more, follow the noise: 0.01 sqrt(0.02) and upwards.
  EXPECT_LE(std::sqrt(squares / 301), 0.003);
}

// A kept corner, and one that noise does not explain, part what is estimated: both stay.
TEST(MeantPath, KeepsWhatWasMeantAsACorner) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> off(-0.005, 0.005);
  std::vector<Point3> points;
  for (int i = 0; i <= 40; ++i) points.emplace_back(0.5 * i, i % 40 == 0 ? 0 : off(random), 0);
  for (int i = 1; i <= 40; ++i) points.emplace_back(20 + (i < 40 ? off(random) : 0), 0.5 * i, 0);
  const auto meant = denoised_positions(points, find_features(points, {}));
  EXPECT_EQ(meant[40], points[40]);
  EXPECT_EQ(meant.front(), points.front());
  EXPECT_EQ(meant.back(), points.back());
  EXPECT_NE(meant[20], points[20]);
}

// The first vertex stays, since it is kept, and so does the last one, read the other way round.
TEST(MeantPath, OfALineBesideShorterEdgesIsTheLineOfLeastSquares) {
  double before = 0;
  double after = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const std::vector<Point3> points = noisy_rounding(0.008, seed);
    const auto meant = denoised_positions(points, find_features(points, {0.03, 3.2}));
    EXPECT_EQ(meant.front(), points.front());
    const std::vector<Point3> back(points.rbegin(), points.rend());
    const auto meant_back = denoised_positions(back, find_features(back, {0.03, 3.2}));
    EXPECT_EQ(meant_back.back(), points.front());
    double products = 0;
    double squares = 0;
    const auto along = [&](std::size_t i) { return points[i].x() - points[0].x(); };
    for (std::size_t i = 1; i <= 6; ++i) {
      products += along(i) * points[i].z();
      squares += along(i) * along(i);
    }
    for (std::size_t i = 1; i <= 6; ++i) {
      EXPECT_NEAR(meant[i].z(), along(i) * products / squares, 1e-5);
      before += points[i].z() * points[i].z();
      after += meant[i].z() * meant[i].z();
    }
  }
  EXPECT_LT(after, 0.3 * before);  // one of six degrees of freedom: a sixth is expected
}

// Up the slope beside a rounding, over a ridge, and down the slope beside the next one.
TEST(MeantPath, OfTwoLinesThatMeetAtACornerIsThoseTwo) {
  std::vector<Point3> points = noisy_rounding(0.008, 3);
  const std::size_t ridge = points.size() - 1;
  for (std::size_t i = ridge; i-- > 0;) {
    points.emplace_back(2 * points[ridge].x() - points[i].x(), 0, points[i].z());
  }
  const auto meant = denoised_positions(points, find_features(points, {0.03, 3.2}));
  EXPECT_EQ(meant[ridge], points[ridge]);
  double moved = 0;
  for (std::size_t i = ridge - 5; i <= ridge + 5; ++i) {
    moved = std::max(moved, (meant[i] - points[i]).norm());
  }
  EXPECT_GT(moved, 0.002);
  EXPECT_LT(moved, 0.02);
}

TEST(MeantPath, OfFewVerticesIsTheVertices) {
  const std::vector<Point3> points = arc_path(5, 1, 6);
  EXPECT_EQ(denoised_positions(points, find_features(points, {})), points);
}

}  // namespace
}  // namespace batten::geometry
