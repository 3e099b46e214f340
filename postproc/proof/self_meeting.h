// Whether a long path may meet itself: cross, touch or run over itself. What new_crossings
// (geometry/band/tolerance_band.h) looks for is found among such meetings only. Holds the corners
// of the path's chords, 24 bytes each, and nothing else of it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::postproc {

class SelfMeeting {
 public:
  // Arcs and Bezier pieces are cut into the chords that new_crossings cuts them into under this
  // tolerance (mm, > 0).
  explicit SelfMeeting(double tolerance_mm) : tolerance_(tolerance_mm) {}

  // What follows; it begins where the path has ended so far.
  void add(std::span<const geometry::PathPiece> path);

  // False: no two chords come nearer to each other than kApart, but neighbours at the corner that
  // they share; of a path that is so long that as a whole it is cut into longer chords, no nearer
  // than those may be off. True where that is not certain.
  [[nodiscard]] bool may_meet() const;

  // mm: far above the rounding of places, far below a step of what is printed.
  static constexpr double kApart = 1e-6;

 private:
  [[nodiscard]] std::size_t edges() const { return corners_.empty() ? 0 : corners_.size() - 1; }
  [[nodiscard]] bool turns_back() const;

  double tolerance_;
  std::vector<geometry::Point3> corners_;
  std::size_t bent_chords_ = 0;    // of arcs and Bezier pieces
  bool has_short_chords_ = false;  // that count as meetings
};

}  // namespace batten::postproc
