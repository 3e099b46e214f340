// Does the control remember the same when two programs come to the same event?
#pragma once

#include <string_view>

#include "postproc/proof/program_events.h"

namespace batten::postproc {

// What differs, in words ("units", "plane" ..); empty when nothing does. The motion word is asked
// for at kText events only: other events do not depend on it, and the cuts after them have their
// own. The feed is asked for at kText events, whatever uses it there, and where an F stands in
// either program that no cut has used: a rapid may run with it, that of its own block too, and
// behind G20, G93 or M2 it is not known any more.
[[nodiscard]] std::string_view different_item(const ProgramEvent& before,
                                              const ReadProgram& old_program,
                                              const ProgramEvent& after,
                                              const ReadProgram& new_program);

// Between programs of two languages: what bends the path, or the meaning of a feed. How arcs and
// units are read does not count, since motions are compared in millimetres.
[[nodiscard]] std::string_view different_in_common(const ProgramEvent& before,
                                                   const ReadProgram& old_program,
                                                   const ProgramEvent& after,
                                                   const ReadProgram& new_program);

// The same after the last block, without the motion word.
[[nodiscard]] std::string_view different_item_at_end(const ReadProgram& old_program,
                                                     const ReadProgram& new_program);

}  // namespace batten::postproc
