// Which event of the new program is which event of the old one.
#pragma once

#include <cstddef>
#include <vector>

#include "postproc/proof/program_events.h"

namespace batten::postproc {

struct EventPair {
  std::size_t before = 0;  // index into the old program's events
  std::size_t after = 0;
};

struct EventAlignment {
  std::vector<EventPair> same;  // in order on both sides
  // False: after too many differences the rest was not looked at.
  bool complete = true;
};

// Do two events do the same? Rapids do when every axis that one of them names ends at the same
// place; the axes that none names stand where the path before has left them.
[[nodiscard]] bool same_event(const ProgramEvent& before, const ReadProgram& old_program,
                              const ProgramEvent& after, const ReadProgram& new_program);

// In order; where the lists differ, the nearest place is taken from which two events in a row
// are the same again. Linear where the programs agree.
[[nodiscard]] EventAlignment align_events(const ProgramEvents& before,
                                          const ReadProgram& old_program,
                                          const ProgramEvents& after,
                                          const ReadProgram& new_program);

}  // namespace batten::postproc
