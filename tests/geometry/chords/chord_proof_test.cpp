#include "geometry/chords/chord_proof.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "geometry/path/path.h"
#include "tests/support/random_curves.h"

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

// Of many places between, from the chord's line.
double greatest_height(const BsplineCurve& curve, double from, double to) {
  const Point3 start = curve.point_at(from);
  const Vector3 along = (curve.point_at(to) - start).normalized();
  double greatest = 0;
  constexpr int kPlaces = 20000;
  for (int i = 0; i <= kPlaces; ++i) {
    const Vector3 off = curve.point_at(from + (to - from) * i / kPlaces) - start;
    greatest = std::max(greatest, (off - off.dot(along) * along).norm());
  }
  return greatest;
}

struct RandomChord {
  BsplineCurve curve;
  double from;
  double to;
};

// From a hundredth of a random curve to a third of it.
RandomChord random_chord(unsigned seed, bool in_space) {
  BsplineCurve curve = tests::random_curve(seed, in_space);
  std::mt19937 random(seed + 1000);
  std::uniform_real_distribution<double> part(0, 1);
  const double all = curve.last() - curve.first();
  const double length = all * (0.01 + 0.32 * part(random));
  const double from = curve.first() + part(random) * (all - length);
  return {std::move(curve), from, from + length};
}

TEST(ChordHeight, IsTheGreatestDistanceAndHardlyMore) {
  int wild = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomChord chord = random_chord(seed, seed % 2 == 1);
    const CurvePieces pieces(chord.curve, chord.curve.first(), chord.curve.last());
    const ChordHeight found = ChordsFrom(pieces, chord.from).to(chord.to);
    const double distance = greatest_height(chord.curve, chord.from, chord.to);
    const Vector3 ends = chord.curve.point_at(chord.to) - chord.curve.point_at(chord.from);
    EXPECT_NEAR(found.chord, ends.norm(), 1e-12 * ends.norm());
    EXPECT_GE(found.height, distance - 1e-12);
    // A ten-thousandth, and what the places between the measured ones are farther off.
    if (found.height > (1 + 1.1e-4) * distance + 1e-9) ++wild;
    EXPECT_LE(found.height, (1 + 1e-3) * distance + 1e-9);
  }
  EXPECT_LE(wild, 4);
}

// A curve that goes forward along its chord is within its height of it, in order: another proof
// says so too, and no proof says so of less.
TEST(ChordHeight, ProvesChordsThatAreInOrder) {
  int in_order = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomChord chord = random_chord(seed, seed % 2 == 1);
    const CurvePieces pieces(chord.curve, chord.curve.first(), chord.curve.last());
    const ChordHeight found = ChordsFrom(pieces, chord.from).to(chord.to);
    if (!found.in_order) continue;
    ++in_order;
    const auto proved = [&](double deviation) {
      return chord_proved(pieces, chord.from, chord.to,
                          ChordProof(pieces.point_at(chord.from), pieces.point_at(chord.to),
                                     deviation, kSharpProofCuts));
    };
    EXPECT_TRUE(proved(1.001 * found.height + 1e-9));
    EXPECT_FALSE(proved(0.999 * found.height - 1e-9));
  }
  EXPECT_GE(in_order, 50);
}

TEST(ChordHeight, IsNotInOrderWhereTheCurveGoesBack) {
  // There, back by a part of the way, and on.
  const BsplineCurve curve(BsplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 1}),
                           {{0, 0, 0}, {3, 0.01, 0}, {-2, 0.01, 0}, {1, 0, 0}});
  const CurvePieces pieces(curve, 0, 1);
  const ChordHeight found = ChordsFrom(pieces, 0).to(1);
  EXPECT_FALSE(found.in_order);
  EXPECT_NEAR(found.height, 0.0075, 1e-6);  // of the cubic, 3/4 of its two control points
}

TEST(ChordHeight, SaysQuicklyWhatIsHopelessAndOnlyThat) {
  int left = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomChord chord = random_chord(seed, seed % 2 == 1);
    const CurvePieces pieces(chord.curve, chord.curve.first(), chord.curve.last());
    const ChordsFrom chords(pieces, chord.from);
    const double height = chords.to(chord.to).height;
    EXPECT_FALSE(chords.leaves(chord.to, height + 1e-9));
    left += chords.leaves(chord.to, 0.5 * height) ? 1 : 0;
  }
  EXPECT_GE(left, 150);
}

}  // namespace
}  // namespace batten::geometry
