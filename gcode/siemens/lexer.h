// One line of a Siemens program to tokens: addresses with values (`X10`, `X=10`), and names with
// what belongs to them (`CR=5`, `R1=R2*3`, `MSG("..")`, `PO[X]=(1,2)`, `SOFT`).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "gcode/text/number_format.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

enum class SiemensTokenKind : std::uint8_t {
  kWord,        // one letter and a plain number: X10, X=-.5
  kValueWord,   // one letter and a value that is computed: X=R1, X=AC(10)
  kName,        // anything longer, with its index, its value and its arguments
  kLabel,       // NAME: or :10 at the beginning of the block
  kComment,     // ; to the end of the line
  kSkip,        // / or /0 to /9
  kUnreadable,  // see `trouble`: the rest of the line is not split
  kEnd,
};

struct SiemensToken {
  SiemensTokenKind kind = SiemensTokenKind::kEnd;
  char letter = 0;         // upper case: kWord, kValueWord
  ReadNumber number;       // kWord
  bool assigned = false;   // an = stands behind the name
  bool arguments = false;  // kName: parentheses with something in them
  SourceSpan span;
  SourceSpan name;  // kName, kLabel: without index, value and arguments
  std::string_view trouble;
};

class SiemensLexer {
 public:
  // `line` is a span of `source`, without its line end.
  SiemensLexer(std::string_view source, SourceSpan line)
      : text_(source.substr(0, line.end)), at_(line.begin) {}

  // kEnd after the last token. Linear in the line as a whole.
  [[nodiscard]] SiemensToken next();

 private:
  [[nodiscard]] SiemensToken address();
  [[nodiscard]] SiemensToken named(std::size_t name_end);
  [[nodiscard]] SiemensToken assigned_letter(std::size_t value_at);

  SiemensToken token(SiemensTokenKind kind, std::size_t end);
  SiemensToken with_name(SiemensTokenKind kind, std::size_t name_end, std::size_t end);
  SiemensToken unreadable(std::string_view trouble);
  // Nothing where it is kNumberLimit or more.
  [[nodiscard]] std::optional<ReadNumber> number_in(std::size_t begin, std::size_t end) const;

  std::string_view text_;
  std::size_t at_;
  bool anything_ = false;  // a token that is no block number, skip sign or label
};

// Where values of a Siemens program end: numbers, and expressions that are not computed here. All
// take the position where something starts and give the one after it, or nothing when it is not
// there in full.

// [+-]digits[.digits], without blanks and without an exponent.
[[nodiscard]] std::optional<std::size_t> after_siemens_number(std::string_view text,
                                                              std::size_t at);

// ( .. ) or [ .. ], with strings and brackets inside.
[[nodiscard]] std::optional<std::size_t> after_siemens_brackets(std::string_view text,
                                                                std::size_t at);

// R5, M17, :10: one character with digits behind it, and nothing else.
[[nodiscard]] constexpr bool is_numbered(std::string_view name) {
  return name.size() > 1 && name.find_first_not_of("0123456789", 1) == std::string_view::npos;
}

// Letters, digits, _ and $.
[[nodiscard]] std::size_t after_siemens_name(std::string_view text, std::size_t at);

// Operands (numbers, names with index and arguments, strings, brackets) joined by operators:
// R1*2+SIN(30), AC(10), "text" << R2, (1,2,3).
[[nodiscard]] std::optional<std::size_t> after_siemens_expression(std::string_view text,
                                                                  std::size_t at);

}  // namespace batten::gcode
