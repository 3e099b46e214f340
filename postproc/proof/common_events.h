// What a program does in words that all languages have, to compare programs of different ones: the
// verifier's view, which knows nothing of how one was made from the other.
#pragma once

#include "postproc/proof/program_events.h"

namespace batten::postproc {

// As list_events (postproc/proof/program_events.h), but for:
//   tool 5           T5 M6, TOOL CALL 5 Z
//   speed 3000       S3000, TOOL CALL Z S3000: another one, or the first behind a tool
//   M3, M4, M8       before the motion of their block, as LinuxCNC and Klartext do them; M13 and
//                    M14 of Klartext are two of them
//   M5, M9           in a block without motion; in Klartext behind the motion of their block, too
//   G54              also a Klartext comment that its datum is active; the same one again is none
//   G49              before the first motion behind it; also Siemens D0, and a Klartext comment
//                    that lengths count
//   length not said  before the first motion along Z behind a tool, where neither G43 (Siemens: D1)
//                    nor G49 stands between; also a Klartext comment that says so
//   BLK FORM ..      a Klartext statement, or a comment that begins so, in capitals
//   line of X F500   motions from a place that is not known, by the axes that they name; where they
//                    go is compared as that of rapids
// No events: program marks and names, words that say how others are read (units, planes, G90, G94,
// G40 ..; what they change is compared where it counts), G64 without a tolerance, G43 and Siemens
// D1 behind the change of their tool as long as nothing moved along Z, and M30 behind a comment END
// PGM. Everything else is an event of its own text, which no other language has; G70 too, which
// leaves feeds in millimetres.
[[nodiscard]] ProgramEvents list_common_events(const ReadProgram& read);

}  // namespace batten::postproc
