// A long run cut into pieces, so that those that gain are rewritten and the others stay.
// Method: docs/algorithms/fair.md, section Long runs.
#pragma once

#include <cstddef>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

struct CuttingOptions {
  // By vertices, of which an arc has several.
  std::size_t shortest = 60;  // in a piece, but for a run that is shorter itself
  std::size_t longest = 400;  // in a piece, but where it cannot be cut
};

// The vertices at which a run is cut, increasing, neither its first nor its last: where a cut
// costs least, that is at reversals, else at the sharpest corner, else within a straight line, else
// where the path turns least; never within an arc, nor before one that takes its G2 or G3 from the
// block before it. Linear cost; they depend on the path alone.
[[nodiscard]] std::vector<std::size_t> cut_places(const Run& run, const CuttingOptions& options);

// A piece of a run as a section of its own, and where it lies in it.
struct RunPiece {
  Section section;        // content is a Run
  std::size_t first = 0;  // vertices of the whole run
  std::size_t last = 0;
};

// The pieces cover the section's blocks, each once. A place is left out where blocks that do not
// move stand between the motions that meet there. One piece when nothing can be cut.
//
// Requires: `section` is a Run of this program.
[[nodiscard]] std::vector<RunPiece> cut_run(const Section& section,
                                            const gcode::Interpretation& interpretation,
                                            const CuttingOptions& options);

// How well the vertices of a path serve as places where it is cut into runs.

// The greater the better: reversals, else the sharpest corner, else within a straight line, else
// where the path turns least.
struct Fitness {
  int rank = 0;
  double within_rank = 0;

  friend bool operator<(const Fitness& a, const Fitness& b) {
    return a.rank != b.rank ? a.rank < b.rank : a.within_rank < b.within_rank;
  }
};

// Of the vertex `at` between its neighbours.
[[nodiscard]] Fitness split_score_at(const geometry::Point3& before, const geometry::Point3& at,
                                     const geometry::Point3& after);

}  // namespace batten::postproc
