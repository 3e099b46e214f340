// Which event of the new program is which event of the old one.
#pragma once

#include <cstddef>
#include <string_view>
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

// In order; where the lists differ, the nearest place is taken from which two events in a row
// are the same again. Linear where the programs agree.
[[nodiscard]] EventAlignment align_events(const ProgramEvents& before,
                                          const ReadProgram& old_program,
                                          const ProgramEvents& after,
                                          const ReadProgram& new_program);

// Does the control remember the same when two programs come to the same event?

// What differs, in words ("units", "plane" ..); empty when nothing does. The motion word is asked
// for at kText events only: other events do not depend on it, and the cuts after them have their
// own. The feed is asked for at kText events, whatever uses it there, and where an F stands in
// either program that no cut has used: a rapid may run with it, that of its own block too, and
// behind G20, G93 or M2 it is not known any more.
[[nodiscard]] std::string_view different_item(const EventAt& old, const EventAt& now);

// Between programs of two languages: what bends the path, or the meaning of a feed. How arcs and
// units are read does not count, since motions are compared in millimetres.
[[nodiscard]] std::string_view different_in_common(const EventAt& before, const EventAt& after);

// The same after the last block, without the motion word.
[[nodiscard]] std::string_view different_item_at_end(const ReadProgram& old_program,
                                                     const ReadProgram& new_program);

}  // namespace batten::postproc
