// What a program says that its target cannot be told.
#pragma once

#include <string>
#include <vector>

#include "gcode/control/dialect.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"

namespace batten::postproc {

struct Obstacle {
  gcode::SourceSpan where;
  std::string why;  // goes on after the text that stands there: "is not taken there"
};

// Adds an error "cannot-convert" for each, in their order; after 50 one more says how many there
// are.
void tell_obstacles(const std::vector<Obstacle>& obstacles, const gcode::Program& program,
                    const gcode::Dialect& target, gcode::Diagnostics& found);

}  // namespace batten::postproc
