// Arcs that a target runs as chords: whether a new path keeps its tolerance as the target runs it.
#pragma once

#include <cstddef>
#include <vector>

#include "gcode/control/control.h"
#include "postproc/proof/path_part.h"

namespace batten::postproc {

// What the target makes of new arcs: mm, for each piece of the new part, by how much the chords
// that it cuts it into leave it. 0 for lines, and for arcs that the old program has, too.
struct TargetChords {
  std::vector<double> errors;  // none where no arc is cut
  double greatest = 0;
  std::size_t worst = 0;  // piece

  [[nodiscard]] bool is_cut(std::size_t piece) const {
    return !errors.empty() && errors[piece] > 0;
  }
};

// `target`: nullptr where nobody is asked.
[[nodiscard]] TargetChords chords_of_target(const PathPartPair& pair, const gcode::Control* target);

// The path that keeps the tolerance by itself keeps it as the target runs it, too: else the arcs to
// blame, all that alone are too coarse or the worst one.
[[nodiscard]] std::vector<Violation> chords_violations(const PathPartPair& pair,
                                                       const TargetChords& chords,
                                                       const geometry::PathComparison& proved,
                                                       const Promise& promise);

}  // namespace batten::postproc
