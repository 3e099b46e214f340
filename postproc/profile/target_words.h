// Whether the words of a program mean to the target what they mean to the reader.
#pragma once

#include "gcode/control/dialect.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"

namespace batten::postproc {

// An error "word-means-other" for the first use of each G word that the target takes for something
// else than the reader does (G21 mirrors on some): such a program was not read as its control reads
// it.
void tell_of_other_meanings(const gcode::Program& program, const gcode::Dialect& target,
                            gcode::Diagnostics& found);

}  // namespace batten::postproc
