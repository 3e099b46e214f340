// What is worth knowing about the band of a tolerance around a run: where it lies over itself, and
// where the run bends more tightly than the band is wide. Method:
// docs/algorithms/tolerance_band.md.
#pragma once

#include <cstddef>
#include <span>

#include "gcode/state/motion.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

// Notes on a run, at most one of each id, each with how many such positions there are:
// `band-overlap` at the block where two parts of the run are nearest to each other, `band-cusp` at
// the first block whose side the edge of the band does not have.
//
// None where the section is no run, where the run is not flat across an axis, and where too many
// of its parts are close by (geometry::band_structure). Arcs are seen as the chords of the run.
[[nodiscard]] gcode::Diagnostics band_notes(const gcode::Program& program,
                                            const gcode::Interpretation& meaning,
                                            const Section& section, double tolerance_mm);

// As many as the messages of one id about the text.
inline constexpr std::size_t kMostBandNotes = 50;

// The notes of all runs in order, at most kMostBandNotes of them, then how many more there are.
class BandNoteTally {
 public:
  void add(std::span<const gcode::Diagnostics> of_runs, gcode::Diagnostics& found);
  // At the end of the program.
  void tell_rest(gcode::Diagnostics& found) const;

 private:
  std::size_t told_ = 0;
  std::size_t left_out_ = 0;
  gcode::SourceSpan first_untold_;
};

}  // namespace batten::postproc
