// Proved bounds on the distance of two paths, taken in order and both ways (the Fréchet distance).
// Method: docs/algorithms/path_distance.md.
//
// What is promised. `compare_paths` searches for a monotone matching of the two paths: a chain of
// pairs that goes forward on both, between which both paths are straight, or an arc or Bezier piece
// cut so finely that its distance from its chord is a known, small part of the tolerance. The
// distance of two linear motions is greatest at an end, so the chain is a certificate: the Fréchet
// distance is at most the greatest pair distance plus the chord errors. Pairs of printed decimals
// are compared with the tolerance by CGAL's exact arithmetic: a copy shifted by exactly the
// tolerance is never broken and nearly always proved, one shifted by a last digit more is broken.
//
// What is left open (kNotProved): a distance that is the tolerance to within rounding but met where
// there are no decimals, as where a fold is waited for; and paths that lie in a heap within the
// tolerance of themselves, where the search would cost too much. Piece ends must chain; a gap
// counts as a straight piece.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// The true distance lies in [at_least, at_most] (mm). A tolerance is kept when at_most is
// inside it, broken when at_least is outside.
struct DistanceBounds {
  double at_least = 0;
  double at_most = 0;
};

enum class Verdict {
  kProved,     // at_most <= tolerance
  kBroken,     // at_least > tolerance
  kNotProved,  // neither could be shown in a bounded number of refinements
};

struct PathComparison {
  Verdict verdict = Verdict::kNotProved;
  DistanceBounds bounds;
  std::size_t worst_piece_a = 0;  // where the greatest distance was met (or the violation seen)
  std::size_t worst_piece_b = 0;
  Point3 worst_a = Point3::Zero();
  Point3 worst_b = Point3::Zero();
  std::size_t certificate_size = 0;  // pairs that prove the bound
};

// Of the tolerance: the error of the chords into which arcs and curves are cut at first.
inline constexpr double kFirstChordShare = 5e-3;

// `tolerance`: mm, > 0; throws std::invalid_argument otherwise. Two empty paths are proved at
// distance 0; an empty path is one that waits where the other one starts. `at_most` is tight to
// within about 2 % of the tolerance where the paths are proved, and never above the tolerance then;
// it is finite always. Cost: about linear in the number of pieces where the paths stay within a few
// pieces of each other.
//
// `beside_b`: mm, for each piece of `b`, how far that which is really run may be from it (empty:
// nothing is). Then kProved holds for what is run, too, and for `a`: where the piece is passed, so
// much less of the tolerance is left. kBroken is the exception there: kNotProved stands for both.
[[nodiscard]] PathComparison compare_paths(std::span<const PathPiece> a,
                                           std::span<const PathPiece> b, double tolerance,
                                           std::span<const double> beside_b = {});

// Passed together. They are on the chords of the pieces: on lines exactly, on arcs to within 0.5 %
// of the tolerance.
struct PlacePair {
  std::size_t piece_a = 0;
  std::size_t piece_b = 0;
  Point3 a = Point3::Zero();
  Point3 b = Point3::Zero();
  double t_a = 0;  // where on the piece, 0 to 1 in its own parameter; of match_paths only
  double t_b = 0;
};

struct PathMatching {
  PathComparison comparison;
  // From both starts to both ends, forward on both; between neighbours both run straight along one
  // chord. Every end of a piece of either path is in one of them. None where both paths are empty.
  std::vector<PlacePair> pairs;
};

// As compare_paths, with its certificate where it is proved: no distance of a pair is above
// `bounds.at_most`, and the greatest is below it by the chord errors only, 1 % of the tolerance
// together at most. Elsewhere the pairs are the best matching that was found.
[[nodiscard]] PathMatching match_paths(std::span<const PathPiece> a, std::span<const PathPiece> b,
                                       double tolerance);

}  // namespace batten::geometry
