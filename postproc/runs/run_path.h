// The path of a run: its motions as exact pieces, and the vertices by which it is smoothed.
// Method: docs/algorithms/arcs_in_runs.md.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

// Appends an arc or a piece of a curve, one of the `of_block` (1 ..) that its block says, to the
// run, whose points hold at least its start; `bend.first` and `last` are set here. Chords between
// its vertices leave it by at most `max_chord_error` (mm, > 0); at least four for a block, so that
// the path bends evenly, but for a piece that is a line: that is one.
void append_bend(RunBend bend, std::size_t of_block, double max_chord_error, Run& run);

[[nodiscard]] std::size_t motion_count(const Run& run);

// mm/min, of each edge between two vertices.
[[nodiscard]] std::vector<double> edge_feeds(const Run& run);

struct RunMotion {
  geometry::PathPiece piece;
  std::size_t first = 0;  // vertex where it starts
};

// The exact path between two vertices, motion by motion: of a bend that a vertex cuts, the part.
[[nodiscard]] std::vector<RunMotion> motions_between(const Run& run, std::size_t first,
                                                     std::size_t last);

// mm, rms over the run: about how far its arcs are from the curve that they stand for, estimated
// from the steps of curvature and direction where they meet. 0 without arcs.
[[nodiscard]] double arc_scatter(const Run& run);

// Radians, where one segment ends and the next one starts.
[[nodiscard]] double turn_between(const geometry::PathPiece& before,
                                  const geometry::PathPiece& after);

// The same motions, with their feeds.
[[nodiscard]] std::vector<TimedPiece> timed_pieces(const Run& run, std::size_t first,
                                                   std::size_t last);

}  // namespace batten::postproc
