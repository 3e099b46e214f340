// One line to tokens. The grammar is that of RS-274/NGC, wide enough for what shops write:
// blanks anywhere, also inside numbers; either case; words in any order.
#pragma once

#include <cstddef>
#include <string_view>

#include "gcode/token.h"

namespace batten::gcode {

class LineLexer {
 public:
  // `line` is a span of `source`, without its line end.
  LineLexer(std::string_view source, SourceSpan line)
      : text_(source.substr(0, line.end)), begin_(line.begin), at_(line.begin) {}

  // The next token; kEnd after the last one. After kFlow, kForeign or kUnreadable the line is
  // at its end. Linear in the line as a whole.
  [[nodiscard]] Token next();

 private:
  [[nodiscard]] Token letter_token();
  [[nodiscard]] Token number_word(char letter, std::size_t value_at);
  [[nodiscard]] Token value_word(char letter, std::size_t value_at);
  [[nodiscard]] Token o_word();
  [[nodiscard]] Token keyword();
  [[nodiscard]] Token sign_token(char c);
  [[nodiscard]] Token comment();
  [[nodiscard]] Token line_comment();
  [[nodiscard]] Token block_delete();
  [[nodiscard]] Token checksum();
  [[nodiscard]] Token parameter_assignment();
  [[nodiscard]] Token assigned(std::size_t equals_at);
  [[nodiscard]] Token corner_word();

  // A token from the present place to `end`; the next one starts there.
  Token take(TokenKind kind, std::size_t end);
  // A token that ends the line: its span runs from `where` to the end.
  Token rest(TokenKind kind, std::size_t where);
  Token unreadable(std::size_t where, std::string_view trouble);

  [[nodiscard]] std::size_t after_blanks(std::size_t at) const;
  // The character there, NUL behind the end of the line.
  [[nodiscard]] char peek(std::size_t at) const { return at < text_.size() ? text_[at] : '\0'; }

  std::string_view text_;  // the source up to the end of the line
  std::size_t begin_;
  std::size_t at_;
};

}  // namespace batten::gcode
