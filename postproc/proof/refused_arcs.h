// What the target would not run of the written text: its rules for arcs, asked of the arcs as the
// text says them, when it is read again.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "gcode/control/dialect.h"
#include "postproc/proof/verification.h"

namespace batten::postproc {

// The line of the old program that a block of the new one stands for.
using OldLine = std::function<std::uint32_t(std::uint32_t block, const Stretch& stretch)>;

// A breach for each arc of a stretch that was compared which the target refuses (gcode/dialects/
// arc_rules.h). Arcs of the old program are its own affair: they are copied.
[[nodiscard]] std::vector<Violation> refused_arcs(const ReadProgram& before,
                                                  const ReadProgram& after,
                                                  const std::vector<Stretch>& stretches,
                                                  const gcode::Dialect& target,
                                                  const OldLine& old_line);

}  // namespace batten::postproc
