// What a user says of a path and of one beside it: the two readings of a tolerance
// (docs/tolerances.md), its side, its seam.
#pragma once

#include <numbers>

namespace batten::geometry {

enum class ToleranceKind {
  // New and old path are within tolerance of each other, both ways and in order.
  kPath,
  // The new path is within tolerance of the old one, in order; a corner of two lines may be
  // further from the new path than that, by 1 / sin(half the angle between them) times at most.
  kBand,
};

// Corners with a smaller angle between their lines are held to the strict reading even so: a
// bound of 5.8 times the tolerance is the loosest that anyone gets. Without this, two rows
// that meet at a reversal might vanish, since each lies in the band of the other.
inline constexpr double kSharpestCut = 20 * std::numbers::pi / 180;

// On which side of a path another one may be.

// Of the way of travel, seen from above (against Z).
enum class Side { kBoth, kLeft, kRight };

// What becomes of a corner where a path begins and ends: it stays, or the path is rounded there,
// too, but still goes through that point.
enum class Seam { kCorner, kSmooth };

}  // namespace batten::geometry
