// The band of a flat path (all within a tolerance of it): where it lies over itself, where its edge
// has cusps, and its outline for pictures. Method: docs/algorithms/tolerance_band.md.
//
// A path in the band of another one may cross itself where the other does not, but only where the
// band lies over itself: there two parts of the path are nearer to each other than twice the
// tolerance, and either may move over to the other side of its neighbour. `new_crossings` looks for
// that.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// Two parts of one path whose bands overlap: edges first_from..first_to and second_from..second_to.
struct BandOverlap {
  std::size_t first_from = 0;
  std::size_t first_to = 0;
  std::size_t second_from = 0;
  std::size_t second_to = 0;
  double distance = 0;        // mm, least distance of the two parts
  std::size_t edge = 0;       // of the first part, where that is met
  bool meets_itself = false;  // the parts cross, touch or run over each other
};

// A side of an edge that the edge of the band does not have: the bends at its ends are so near to
// each other that the band's radius is greater than that of the path there.
struct BandCusp {
  std::size_t edge = 0;
  bool left = false;  // on the left of the way of travel
};

struct BandStructure {
  std::vector<BandOverlap> overlaps;  // in order of their first edges
  std::vector<BandCusp> cusps;        // in order
};

// Of the polyline through `points` (mm) under `tolerance` (mm, > 0). Parts between which the path
// never leaves the band, as the legs of a corner, are one part and do not overlap. The ends of a
// closed path are neighbours.
//
// Nothing where the path lies in a heap: more than kMostPairs (tolerance_band_pairs.h) pairs of
// edges for each edge are near to each other. Throws std::invalid_argument when the tolerance is
// not a positive number.
[[nodiscard]] std::optional<BandStructure> band_structure(std::span<const Point2> points,
                                                          double tolerance);

struct NewCrossing {
  std::size_t first_piece = 0;   // of the new path
  std::size_t second_piece = 0;  // which meets the first one
  Point3 place = Point3::Zero();
};

// A path whose pieces are made where they are needed, so that it need not be held.
struct PathSource {
  std::size_t size = 0;  // pieces
  std::function<PathPiece(std::size_t)> piece;
};

// Where the new path crosses, touches or runs over itself, while the old one, which it follows
// within `tolerance` both ways and in order, does not there. Looked at are the pieces that lie in
// planes across an axis (the one across which most of them lie), each plane for itself; arcs and
// Bezier pieces as chords nearer to them than a hundredth of the tolerance. In the order of their
// first pieces, one for each two pieces.
//
// None in planes where a path lies in a heap (see above): this is a safeguard beside the proof of
// the distance, and says nothing about what runs through space.
[[nodiscard]] std::vector<NewCrossing> new_crossings(const PathSource& before,
                                                     const PathSource& after, double tolerance);

// The edge of the band as closed polygons: the outer ones counter-clockwise, holes clockwise. Round
// ends and corners have corners of their own every 15 degrees, on the outside by less than a
// hundredth of the tolerance. Cost: some tenths of a millisecond and 9 kB for each edge. Throws
// std::bad_alloc where twice that memory is missing.
[[nodiscard]] std::vector<std::vector<Point2>> band_outline(std::span<const Point2> points,
                                                            double tolerance);

}  // namespace batten::geometry
