// Which program a block calls, and which files are such programs.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/subprograms.h"
#include "gcode/text/program.h"

namespace batten::gcode {

struct CalledProgram {
  std::string name;     // "P1234", "O<PROBE>", "O100", "L54", "CONTOUR", "PGM PROBE"
  bool is_once = true;  // false: some number of times, at least once
};

// What a block calls that is a call by a number or a name and nothing else; nothing where that is
// not certain: M98 P51234, which is O51234 to some controls and five times O1234 to others; M98 P1
// H5, computed names, paths to other folders.
[[nodiscard]] std::optional<CalledProgram> called_program(const Program& program,
                                                          const Block& block);

// The names by which the program could be called within itself: those are no other files.
[[nodiscard]] std::vector<std::string> programs_within(const Program& program);

// The program as one that is called by this name. Nothing, and `why` for people, where it is
// another one, or where it is not certain that it comes back behind its call with what it has set
// (M99 P100, M30, RET(..), M73, PROC .. SAVE).
[[nodiscard]] std::optional<Subprogram> as_subprogram(std::string_view name, Program program,
                                                      std::string& why);

}  // namespace batten::gcode
