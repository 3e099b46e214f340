// The smallest parts of a block that mean something.
#pragma once

#include <string_view>

#include "gcode/text/number_format.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

enum class TokenKind {
  kWord,           // a letter and a number: X-.5
  kValueWord,      // a letter and a value that is computed: X[#1+2], X#5, XSIN[30]
  kCornerWord,     // ,R2 ,C1 ,A45: `letter` is R, C or A
  kComment,        // (text), or ( to the end of the line where nothing closes it
  kLineComment,    // ; to the end of the line
  kBlockDelete,    // / or /2
  kChecksum,       // *71 at the end of the line: `number` is 71
  kAssignment,     // #1=#2+3, #<name>=[..], R1=5: one, with its right side
  kProgramNumber,  // O1000, and nothing but comments after it
  kFlow,           // an O-word, IF, GOTO, a label ..: the rest of the line is not split
  kForeign,        // another language: the rest of the line is not split
  kUnreadable,     // see `trouble`: the rest of the line is not split
  kEnd,            // nothing more in this line
};

struct Token {
  TokenKind kind = TokenKind::kEnd;
  char letter = 0;         // upper case
  bool has_value = false;  // `number` was read
  bool unclosed = false;   // a comment that nothing closes
  ReadNumber number;       // means nothing without has_value
  SourceSpan span;
  std::string_view trouble;  // kUnreadable: what cannot be read, for people
};

}  // namespace batten::gcode
