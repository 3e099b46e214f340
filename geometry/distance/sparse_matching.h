// A matching of two paths in few pairs, for a certificate that is checked elsewhere: between two of
// them the paths are passed by a rule that everybody can follow, that of match_nearest.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// A place on a path: a piece, and how much of its parameter lies before the place.
struct PathPlace {
  std::size_t piece = 0;
  std::uint32_t billionths = 0;  // of the piece's parameter; below 1e9

  auto operator<=>(const PathPlace&) const = default;  // NOLINT(modernize-use-nullptr)
};

struct SparsePair {
  PathPlace a;
  PathPlace b;
};

// The pairs at the ends of the pieces of `b`, in order, and between them those without which the
// rule would leave the tolerance. The ends of the paths are not among them. Numbers are rounded to
// as few digits as the proof bears. Nothing where no choice of them proves it.
//
// The rule is followed on chords as the checker cuts them (checked_chords), for each of its
// finenesses until one proves it; where two steps are equal but for rounding, it may take either.
//
// Requires: `matching` is the one of match_paths for these paths and this tolerance or a greater
// one, and proved for that.
[[nodiscard]] std::optional<std::vector<SparsePair>> thin_matching(std::span<const PathPiece> a,
                                                                   std::span<const PathPiece> b,
                                                                   const PathMatching& matching,
                                                                   double tolerance);

}  // namespace batten::geometry
