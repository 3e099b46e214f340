// Packed moves are the moves, bit for bit, in a part of their memory.
#include "postproc/machine/models/packed_moves.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <variant>
#include <vector>

namespace batten::postproc {
namespace {

using geometry::Point3;

class RandomMoves {
 public:
  explicit RandomMoves(unsigned seed) : random_(seed) {}

  std::vector<TimedPiece> some(std::size_t count) {
    std::vector<TimedPiece> moves;
    Point3 at = place();
    double feed = 100;
    for (std::size_t i = 0; i < count; ++i) {
      if (one_of(8)) at = place();
      if (one_of(4)) feed = number();
      TimedPiece move;
      move.piece = piece_from(at);
      move.feed = one_of(10) ? 0 : feed;
      move.rapid = one_of(5);
      move.bytes = static_cast<int>(random_() % 100000);
      move.says_speed = one_of(5);
      move.goes_on = one_of(5);
      move.arcs = one_of(3) ? 0.0F : static_cast<float>(number());
      at = geometry::end_point(move.piece);
      moves.push_back(move);
    }
    return moves;
  }

 private:
  bool one_of(unsigned count) { return random_() % count == 0; }
  // Zeros of both signs among them.
  double number() { return one_of(6) ? (one_of(2) ? -0.0 : 0.0) : real_(random_); }
  Point3 place() { return {number(), number(), number()}; }

  geometry::PathPiece piece_from(const Point3& at) {
    switch (random_() % 4) {
      case 0:
        return geometry::Arc{at, place(), place(), place(), number()};
      case 1:
        return geometry::CubicBezier{{at, place(), place(), place()}};
      default:
        return geometry::Line{at, place()};
    }
  }

  std::mt19937 random_;
  std::uniform_real_distribution<double> real_{-1000, 1000};
};

std::vector<double> numbers_of(const TimedPiece& move) {
  std::vector<double> numbers = {
      static_cast<double>(move.piece.index()), move.feed,
      static_cast<double>(move.rapid),         static_cast<double>(move.bytes),
      static_cast<double>(move.says_speed),    static_cast<double>(move.goes_on),
      static_cast<double>(move.arcs)};
  const auto add = [&](const Point3& p) { numbers.insert(numbers.end(), p.begin(), p.end()); };
  if (const auto* line = std::get_if<geometry::Line>(&move.piece)) {
    add(line->start), add(line->end);
  } else if (const auto* arc = std::get_if<geometry::Arc>(&move.piece)) {
    add(arc->start), add(arc->end), add(arc->center), add(arc->axis);
    numbers.push_back(arc->sweep);
  } else {
    for (const Point3& p : std::get<geometry::CubicBezier>(move.piece).control) add(p);
  }
  return numbers;
}

bool is_same(const TimedPiece& a, const TimedPiece& b) {
  const auto x = numbers_of(a);
  const auto y = numbers_of(b);
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) == 0;
}

TEST(PackedMoves, AreTheMovesBitForBit) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const std::vector<TimedPiece> moves = RandomMoves(seed).some(50);
    const std::vector<TimedPiece> again = PackedMoves(moves).unpacked();
    ASSERT_EQ(again.size(), moves.size());
    for (std::size_t i = 0; i < moves.size(); ++i) {
      EXPECT_TRUE(is_same(again[i], moves[i])) << "seed " << seed << ", move " << i;
    }
  }
}

TEST(PackedMoves, OfNoneAreNone) {
  EXPECT_TRUE(PackedMoves().empty());
  EXPECT_TRUE(PackedMoves().unpacked().empty());
  EXPECT_TRUE(PackedMoves(std::vector<TimedPiece>()).empty());
  EXPECT_FALSE(PackedMoves(RandomMoves(1).some(1)).empty());
}

}  // namespace
}  // namespace batten::postproc
