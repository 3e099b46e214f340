// The path of a run: its motions as exact pieces, and the vertices by which it is smoothed.
// Method: docs/algorithms/arcs_in_runs.md.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

// Appends a motion to the run, whose points hold at least the place where it starts.
void append_line(const geometry::Point3& end, Run& run);

// Chords between the arc's vertices leave it by `max_chord_error` (mm, > 0) at the most. At least
// four of them, so that the path bends evenly there.
void append_arc(const geometry::Arc& arc, bool names_motion, double max_chord_error, Run& run);

[[nodiscard]] std::size_t motion_count(const Run& run);

struct RunMotion {
  geometry::PathPiece piece;
  std::size_t first = 0;  // vertex where it starts
};

// The path between two vertices, exactly, motion by motion: an arc that is cut by one of them is a
// part of that arc.
class MotionWalk {
 public:
  // The run must outlive this object.
  MotionWalk(const Run& run, std::size_t first, std::size_t last);

  // The next motion; nothing at the end.
  [[nodiscard]] std::optional<RunMotion> next();

 private:
  const Run& run_;
  std::vector<RunArc>::const_iterator arc_;  // the first that may not be behind
  std::size_t at_;
  std::size_t last_;
};

// All of them.
[[nodiscard]] std::vector<RunMotion> motions_between(const Run& run, std::size_t first,
                                                     std::size_t last);

// mm, rms over the run: how far its arcs are about from the curve that they stand for, told from
// the steps of curvature and direction where they meet. 0 without arcs.
[[nodiscard]] double arc_scatter(const Run& run);

// Radians: the greatest turn between two moves that follow each other. Turns above 30 degrees are
// corners and do not count.
[[nodiscard]] double greatest_kink(std::span<const TimedPiece> moves);

// The motions of a run between two of its vertices.
[[nodiscard]] std::vector<TimedPiece> timed_pieces(const Run& run, std::size_t first,
                                                   std::size_t last);

}  // namespace batten::postproc
