// The written program: copied bytes, the text of rewritten runs, and what is said around them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/program.h"
#include "postproc/options/profile_words.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/run_smoother.h"

namespace batten::postproc {

struct Additions {
  std::string comment;  // that the program was smoothed; or empty
  ProfileWords words;   // with the tolerance filled in
};

struct AssembledText {
  std::string text;
  std::vector<std::size_t> begins;  // of each section
};

// The bytes of the program's blocks where nothing is rewritten; additions then are left out too.
// `works` in the order of their sections. Added lines end as the lines around them do.
//
// The comment goes behind the words of the first rewritten block, where that is no curve and has
// room for it on the target; else before it, on a line of its own. The header goes before the first
// block that says anything but a program mark, the footer before the last M2, M30 or M99 outside
// runs, before the closing % where there is none, or at the end.
[[nodiscard]] AssembledText assemble(const gcode::Program& program,
                                     std::span<const Section> sections,
                                     std::span<const RunState> works, const Additions& additions,
                                     const gcode::Control& target);

// Lines from 1, both outside: those between hold the rewritten runs.
struct LineBracket {
  std::uint32_t before = 0;
  std::uint32_t after = 0;
};

// The lines that a profile adds to a program, found in the written text again: exactly these, where
// they belong, and nothing else.
struct AddedLines {
  std::string text;       // the new program with these lines empty, so that its line numbers stay
  std::size_t lines = 0;  // how many there were
  std::vector<LineBracket> brackets;
  std::vector<Violation> violations;  // of these lines; the text then still has them where in doubt
};

// Takes the header once, before-run and after-run by turns, the footer once, each in whole; nothing
// where the old program has such words itself, for what it had set would be set anew, and its lines
// could not be distinguished. `words` with the tolerance filled in.
[[nodiscard]] AddedLines take_added_lines(const gcode::Program& old_program,
                                          std::string_view new_text, const ProfileWords& words);

// The first line of the program with a code or a name that acts in the words too, whatever its
// arguments; 0: none.
[[nodiscard]] std::uint32_t line_with_words_of(const gcode::Program& program,
                                               const ProfileWords& words);

// A violation for each bracket in which something acts but cutting moves. `read` is the program of
// AddedLines::text.
[[nodiscard]] std::vector<Violation> events_in_brackets(const ReadProgram& read,
                                                        const std::vector<LineBracket>& brackets);

}  // namespace batten::postproc
