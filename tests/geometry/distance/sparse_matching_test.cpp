// Promises of geometry/distance/sparse_matching: few pairs, which the rule of match_nearest
// completes to a proof.
#include "geometry/distance/sparse_matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/distance/chord_polyline.h"
#include "geometry/distance/free_space.h"

namespace batten::geometry {
namespace {

Path chain_through(const std::vector<Point3>& places) {
  Path path;
  for (std::size_t i = 1; i < places.size(); ++i) path.push_back(Line{places[i - 1], places[i]});
  return path;
}

PlaceOnChord on_chords(const ChordPolyline& polyline, const PathPlace& place) {
  if (place.piece >= polyline.pieces.back() + 1) return {polyline.edge_count() - 1, 1};
  return place_on_piece(polyline, place.piece, place.billionths / 1e9);
}

// mm: the greatest distance of what is passed together from pair to pair by the rule.
double passed_at(const Path& a, const Path& b, const std::vector<SparsePair>& pairs) {
  const ChordPolyline on_a = cut_into_chords(a, 1e-6);
  const ChordPolyline on_b = cut_into_chords(b, 1e-6);
  double greatest = 0;
  MatchedPair from{{0, 0}, {0, 0}};
  for (std::size_t k = 0; k <= pairs.size(); ++k) {
    const MatchedPair to =
        k < pairs.size() ? MatchedPair{on_chords(on_a, pairs[k].a), on_chords(on_b, pairs[k].b)}
                         : MatchedPair{{on_a.edge_count() - 1, 1}, {on_b.edge_count() - 1, 1}};
    greatest =
        std::max(greatest, measure(match_nearest(on_a, on_b, from, to), on_a, on_b, 0).at_most);
    from = to;
  }
  return greatest;
}

TEST(SparseMatching, HasOnePairForEachJointOfTheNewPath) {
  // Twenty short lines with noise of 0.004 mm, and two long ones.
  std::vector<Point3> noisy;
  for (int i = 0; i <= 20; ++i) noisy.emplace_back(i, i % 2 == 0 ? 0.004 : -0.004, 0);
  const Path before = chain_through(noisy);
  const Path after = chain_through({noisy.front(), {10, 0, 0}, noisy.back()});
  const PathMatching matching = match_paths(before, after, 0.01);
  ASSERT_EQ(matching.comparison.verdict, Verdict::kProved);
  const auto pairs = thin_matching(before, after, matching, 0.01);
  ASSERT_TRUE(pairs);
  ASSERT_EQ(pairs->size(), 1u);
  EXPECT_EQ(pairs->front().b, (PathPlace{1, 0}));
  EXPECT_LE(passed_at(before, after, *pairs), 0.01);
}

// A needle of 3 mm in the old path is 0.9 mm off the new one at its waist, which waits there: the
// nearest way alone would go astray.
TEST(SparseMatching, KeepsThePairsThatTheRuleDoesNotFind) {
  std::vector<Point3> folded;
  for (int i = 0; i <= 60; ++i) folded.emplace_back(0.1 * i, 0.05, 0);
  for (int i = 59; i >= 45; --i) folded.emplace_back(0.1 * i, 0, 0);
  for (int i = 46; i <= 100; ++i) folded.emplace_back(0.1 * i, -0.05, 0);
  const Path before = chain_through(folded);
  const Path after = chain_through({{0, 0, 0}, {5.2, 0, 0}, {10, 0, 0}});
  const double tolerance = 0.8;
  const PathMatching matching = match_paths(before, after, tolerance);
  ASSERT_EQ(matching.comparison.verdict, Verdict::kProved);
  EXPECT_GT(passed_at(before, after, {}), tolerance);
  const auto pairs = thin_matching(before, after, matching, tolerance);
  ASSERT_TRUE(pairs);
  EXPECT_LE(passed_at(before, after, *pairs), tolerance);
}

// The same place as the end of one edge and as the begin of the next one.
TEST(SparseMatching, PassesNothingBetweenTwoPairsAtOnePlace) {
  const ChordPolyline line = cut_into_chords(chain_through({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), 1);
  const MatchedPair begin{{1, 0}, {1, 0}};
  const MatchedPair end{{0, 1}, {0, 1}};
  for (const MatchedPair& from : {begin, end}) {
    for (const MatchedPair& to : {begin, end}) {
      EXPECT_EQ(match_nearest(line, line, from, to).size(), 1u);
    }
  }
}

TEST(SparseMatching, OfArcsCountsTheirChords) {
  const Path arc = {Arc{{10, 0, 0}, {0, 10, 0}, {0, 0, 0}, {0, 0, 1}, 1.5707963267948966}};
  std::vector<Point3> corners;
  for (int i = 0; i <= 30; ++i) {
    const double angle = 1.5707963267948966 * i / 30;
    corners.emplace_back(10 * std::cos(angle), 10 * std::sin(angle), 0);
  }
  const Path lines = chain_through(corners);
  // Sagitta of 3 degrees at 10 mm: 0.0034 mm.
  const PathMatching matching = match_paths(arc, lines, 0.005);
  ASSERT_EQ(matching.comparison.verdict, Verdict::kProved);
  const auto pairs = thin_matching(arc, lines, matching, 0.005);
  ASSERT_TRUE(pairs);
  EXPECT_EQ(pairs->size(), 29u);
  EXPECT_TRUE(std::ranges::is_sorted(*pairs, {}, &SparsePair::a));
  EXPECT_LE(passed_at(arc, lines, *pairs), 0.005);
}

}  // namespace
}  // namespace batten::geometry
