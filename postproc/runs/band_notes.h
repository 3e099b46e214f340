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

// Notes on a run, at most one of each id: `band-overlap` at the block where two parts of the run
// are nearest to each other, `band-cusp` at the first block whose side the edge of the band does
// not have. Each says how many such places there are.
//
// None where the section is no run, where the run is not flat across an axis, and where it lies in
// a heap (geometry::band_structure). Arcs are seen as the chords of the run.
[[nodiscard]] gcode::Diagnostics band_notes(const gcode::Program& program,
                                            const gcode::Interpretation& meaning,
                                            const Section& section, double tolerance_mm);

// As many as the messages of one id about the text.
inline constexpr std::size_t kMostBandNotes = 50;

// The notes of all runs in order, but no more than kMostBandNotes of them; then one that says how
// many more there are.
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

// Of a whole program.
void append_band_notes(std::span<const gcode::Diagnostics> of_runs, gcode::Diagnostics& found);

}  // namespace batten::postproc
