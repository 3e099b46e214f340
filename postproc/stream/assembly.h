// The written program: copied bytes, the text of rewritten runs, and what is said around them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "gcode/text/program.h"
#include "postproc/options/profile_words.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/run_smoother.h"

namespace batten::postproc {

struct Additions {
  std::string comment;  // that the program was smoothed, before the first rewritten run; or empty
  ProfileWords words;   // with the tolerance filled in
};

struct AssembledText {
  std::string text;
  std::vector<std::size_t> begins;  // of each section
};

// The bytes of the program's blocks where nothing is rewritten; additions then are left out too.
// `works` in the order of their sections. Added lines end as the lines around them do.
//
// The header goes before the first block that says anything but a program mark, the footer before
// the last M2, M30 or M99 outside runs, before the closing % where there is none, or at the end.
[[nodiscard]] AssembledText assemble(const gcode::Program& program,
                                     std::span<const Section> sections,
                                     std::span<const RunState> works, const Additions& additions);

}  // namespace batten::postproc
