// One line to tokens. The grammar is that of RS-274/NGC, wide enough for what shops write:
// blanks anywhere, also inside numbers; either case; words in any order.
#pragma once

#include <cstddef>
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

class LineLexer {
 public:
  // `line` is a span of `source`, without its line end and without blanks before its first
  // character.
  LineLexer(std::string_view source, SourceSpan line)
      : text_(source.substr(0, line.end)), begin_(line.begin), at_(line.begin) {}

  // The next token, valid until the next call; kEnd after the last one. After kFlow, kForeign
  // or kUnreadable the line is at its end. Linear in the line as a whole.
  [[nodiscard]] const Token& next();

 private:
  [[nodiscard]] const Token& letter_token();
  [[nodiscard]] const Token& number_word(char letter, std::size_t value_at);
  [[nodiscard]] const Token& value_word(char letter, std::size_t value_at);
  [[nodiscard]] const Token& o_word();
  [[nodiscard]] const Token& keyword();
  [[nodiscard]] const Token& sign_token(char c);
  [[nodiscard]] const Token& comment();
  [[nodiscard]] const Token& block_delete();
  [[nodiscard]] const Token& checksum();
  [[nodiscard]] const Token& parameter_assignment();
  [[nodiscard]] const Token& assigned(std::size_t equals_at);
  [[nodiscard]] const Token& corner_word();

  // A token from the present position to `end`; the next one starts there.
  const Token& take(TokenKind kind, std::size_t end);
  // A token that ends the line: its span runs from `where` to the end.
  const Token& rest(TokenKind kind, std::size_t where);
  const Token& unreadable(std::size_t where, std::string_view trouble);

  void take_number(const ReadNumber& number);

  Token token_;
  std::string_view text_;  // the source up to the end of the line
  std::size_t begin_;
  std::size_t at_;
};

// (MSG,..) (DEBUG,..) (PRINT,..) (LOG,..) (LOGOPEN,..) (LOGAPPEND,..) (LOGCLOSE)
// (PROBEOPEN ..) (PROBECLOSE) (PY,..) (ABORT,..), in either case and with blanks anywhere;
// also behind a semicolon. `comment` starts with its bracket or semicolon.
[[nodiscard]] bool is_active_comment(std::string_view comment);

}  // namespace batten::gcode
