// A path as a chain of chords, each with a bound on how far the path is from it. Lines are their
// own chords. docs/algorithms/path_distance.md
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::geometry {

struct ChordPolyline {
  std::vector<Point3> points;  // all on the path; one more than edges
  // mm: how far the chord, run along linearly, and the path in its own parameter are from each
  // other at most. 0 for lines.
  std::vector<double> errors;
  std::vector<std::size_t> pieces;  // which piece of the path the chord belongs to

  [[nodiscard]] std::size_t edge_count() const { return errors.size(); }
};

// Cuts arcs and Bezier pieces so finely that each chord's error is at most `max_error` (mm, > 0);
// larger where that takes more chords than a path may have, as `errors` says. Lines of no length
// are left out, and a gap between pieces becomes a line. There is always one edge at least, of no
// length when the path has none. Requires: `path` is not empty.
[[nodiscard]] ChordPolyline cut_into_chords(std::span<const PathPiece> path, double max_error);

// For who cuts a path part by part: the chords that a piece is cut into within an error, 0 for a
// line; and the error, `max_error` or more, within which a path that would take `wanted` chords
// takes no more than it may have.
[[nodiscard]] double chords_wanted(const PathPiece& piece, double max_error);
[[nodiscard]] double affordable_error(double wanted, double max_error);

// The greatest of |x|, |y|, |z| (mm): what the rounding of differences is relative to.
[[nodiscard]] double greatest_coordinate(const ChordPolyline& polyline);

// points[edge] + t * (points[edge + 1] - points[edge]), where t in [0, 1] is exactly the number
// that the double is.
struct PlaceOnChord {
  std::size_t edge = 0;
  double t = 0;
};

[[nodiscard]] Point3 point_at(const ChordPolyline& polyline, const PlaceOnChord& place);

// Where that is on its piece, 0 to 1 in the piece's own parameter: its chords are equal steps of
// it.
[[nodiscard]] double piece_parameter(const ChordPolyline& polyline, const PlaceOnChord& place);

// The place of a parameter of a piece; of a piece without chords, where the next one begins.
[[nodiscard]] PlaceOnChord place_on_piece(const ChordPolyline& polyline, std::size_t piece,
                                          double parameter);

// The t in [from, to] on the edge that is nearest to `point`.
[[nodiscard]] double nearest_parameter(const ChordPolyline& polyline, std::size_t edge,
                                       const Point3& point, double from, double to);

}  // namespace batten::geometry
