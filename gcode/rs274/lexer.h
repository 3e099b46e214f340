// One line to tokens. The grammar is that of RS-274/NGC, wide enough for what shops write:
// blanks anywhere, also inside numbers; either case; words in any order.
#pragma once

#include <cstddef>
#include <string_view>

#include "gcode/rs274/token.h"

namespace batten::gcode {

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
  [[nodiscard]] const Token& line_comment();
  [[nodiscard]] const Token& block_delete();
  [[nodiscard]] const Token& checksum();
  [[nodiscard]] const Token& parameter_assignment();
  [[nodiscard]] const Token& assigned(std::size_t equals_at);
  [[nodiscard]] const Token& corner_word();

  // A token from the present place to `end`; the next one starts there.
  const Token& take(TokenKind kind, std::size_t end);
  // A token that ends the line: its span runs from `where` to the end.
  const Token& rest(TokenKind kind, std::size_t where);
  const Token& unreadable(std::size_t where, std::string_view trouble);

  [[nodiscard]] std::size_t after_blanks(std::size_t at) const;
  // The character there, NUL behind the end of the line.
  [[nodiscard]] char peek(std::size_t at) const { return at < text_.size() ? text_[at] : '\0'; }

  void take_number(const ReadNumber& number);

  Token token_;
  std::string_view text_;  // the source up to the end of the line
  std::size_t begin_;
  std::size_t at_;
};

}  // namespace batten::gcode
