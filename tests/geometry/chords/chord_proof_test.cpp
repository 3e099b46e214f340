#include "geometry/chords/chord_proof.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "geometry/path/cubic_polynomial.h"
#include "geometry/path/path.h"

namespace batten::geometry {
namespace {

// A piece that goes forward along X and bows, or crosses its chord, in one or two directions.
CubicBezier random_piece(std::mt19937& random, bool in_space) {
  std::uniform_real_distribution<double> along(0.6, 1.4);
  std::uniform_real_distribution<double> across(-0.3, 0.3);
  CubicBezier piece;
  Point3 at(0, 0, 0);
  for (Point3& control : piece.control) {
    control = at + Vector3(0, across(random), in_space ? across(random) : 0);
    at.x() += along(random);
  }
  return piece;
}

double greatest_distance(const CubicBezier& piece) {
  const Point3 start = piece.control[0];
  const Vector3 chord = piece.control[3] - start;
  double greatest = 0;
  constexpr int kPlaces = 4000;
  for (int i = 0; i <= kPlaces; ++i) {
    const Vector3 off = point_at(piece, static_cast<double>(i) / kPlaces) - start;
    const double t = std::clamp(off.dot(chord) / chord.squaredNorm(), 0.0, 1.0);
    greatest = std::max(greatest, (off - t * chord).norm());
  }
  return greatest;
}

bool holds(const CubicBezier& piece, double deviation) {
  return ChordProof(piece.control[0], piece.control[3], deviation).holds(piece);
}

// One part in a thousand on either side of the true distance decides.
TEST(ChordProof, IsSharp) {
  std::mt19937 random(7);
  for (int i = 0; i < 400; ++i) {
    const CubicBezier piece = random_piece(random, i % 2 == 1);
    const double distance = greatest_distance(piece);
    EXPECT_TRUE(holds(piece, 1.001 * distance)) << i;
    EXPECT_FALSE(holds(piece, 0.999 * distance)) << i;
  }
}

// Near the chord everywhere, but a millimetre back on the way.
TEST(ChordProof, RefusesWhatGoesBack) {
  const CubicBezier piece{{{0, 0, 0}, {3, 0.01, 0}, {-2, 0.01, 0}, {1, 0, 0}}};
  EXPECT_FALSE(holds(piece, 0.1));
  EXPECT_TRUE(holds(piece, 1.1));
}

TEST(ChordProof, HasTwoPartsThatAreThePiece) {
  std::mt19937 random(8);
  for (const double cut : {0.1, 0.5, 0.77}) {
    const CubicBezier piece = random_piece(random, true);
    const auto [before, behind] = parts_at(piece, cut);
    for (const double t : {0.0, 0.3, 0.8, 1.0}) {
      EXPECT_LT((point_at(before, t) - point_at(piece, t * cut)).norm(), 1e-14);
      EXPECT_LT((point_at(behind, t) - point_at(piece, cut + t * (1 - cut))).norm(), 1e-14);
    }
  }
}

}  // namespace
}  // namespace batten::geometry
