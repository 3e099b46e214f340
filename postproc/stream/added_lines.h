// The lines that a profile adds to a program, found in the written text again: exactly these, where
// they belong, and nothing else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/program.h"
#include "postproc/options/profile_words.h"
#include "postproc/proof/verification.h"

namespace batten::postproc {

// Lines from 1, both outside: those between hold the rewritten runs.
struct LineBracket {
  std::uint32_t before = 0;
  std::uint32_t after = 0;
};

struct AddedLines {
  std::string text;       // the new program with these lines empty, so that its line numbers stay
  std::size_t lines = 0;  // how many there were
  std::vector<LineBracket> brackets;
  std::vector<Violation> violations;  // of these lines; the text then still has them where in doubt
};

// Takes the header once, before-run and after-run by turns, the footer once, each in whole. Where
// the old program has such words itself, nothing is taken: what it had set would be set anew, and
// its lines could not be told apart. `words` with the tolerance filled in.
[[nodiscard]] AddedLines take_added_lines(const gcode::Program& old_program,
                                          std::string_view new_text, const ProfileWords& words);

// The first line of the program with a code or a name that acts in the words too, whatever its
// arguments; 0: none.
[[nodiscard]] std::uint32_t line_with_words_of(const gcode::Program& program,
                                               const ProfileWords& words);

// Between the lines before and behind runs nothing acts but cutting moves: one violation for each
// bracket in which something does. `read` is the program of AddedLines::text.
[[nodiscard]] std::vector<Violation> events_in_brackets(const ReadProgram& read,
                                                        const std::vector<LineBracket>& brackets);

}  // namespace batten::postproc
