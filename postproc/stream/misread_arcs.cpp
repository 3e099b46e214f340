#include "postproc/stream/misread_arcs.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/controls/arc_rules.h"

namespace batten::postproc {

gcode::Diagnostics note_misread_arcs(const gcode::Program& program,
                                     const gcode::Interpretation& meaning,
                                     const gcode::Control& target) {
  constexpr std::size_t kMostLines = 5;
  gcode::Diagnostics notes;
  std::vector<std::uint32_t> others;
  bool more = false;
  if (target.sweep_noise == gcode::SweepNoise::kNone) return notes;
  for (const gcode::Motion& motion : meaning.motions) {
    const geometry::Arc* arc = motion.piece.arc();
    if (arc == nullptr || !motion.start_known || !motion.end_known) continue;
    const std::string_view taken_for = gcode::misreading(target, *arc);
    if (taken_for.empty()) continue;
    const gcode::Block& block = program.blocks[motion.block];
    if (notes.empty()) {
      constexpr double kRadian = 180 / std::numbers::pi;
      notes.push_back(
          {gcode::Severity::kNote, "arc-misread", block.span,
           fmt::format(
               "{} may take this arc of radius {:.4g} mm and {:.4g} degrees for "
               "{}: rounding decides; {}",
               target.name, geometry::radius_of(*arc), std::abs(arc->sweep) * kRadian, taken_for,
               taken_for == "no motion" ? "expected two half circles" : "expected a line")});
    } else if (others.size() < kMostLines) {
      others.push_back(block.line);
    } else {
      more = true;
    }
  }
  if (!others.empty()) {
    notes.front().message +=
        fmt::format("; the same in {} {}{}", others.size() > 1 ? "lines" : "line",
                    fmt::join(others, ", "), more ? " and more" : "");
  }
  return notes;
}

}  // namespace batten::postproc
