// Where values of a Siemens program end: numbers, and expressions that are not computed here.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace batten::gcode {

// All take the place where something starts and give the place after it, or nothing when it does
// not stand there in full.

// [+-]digits[.digits], without blanks and without an exponent.
[[nodiscard]] std::optional<std::size_t> after_siemens_number(std::string_view text,
                                                              std::size_t at);

// ( .. ) or [ .. ], with strings and brackets inside.
[[nodiscard]] std::optional<std::size_t> after_siemens_brackets(std::string_view text,
                                                                std::size_t at);

// Letters, digits, _ and $.
[[nodiscard]] std::size_t after_siemens_name(std::string_view text, std::size_t at);

// Operands (numbers, names with index and arguments, strings, brackets) joined by operators:
// R1*2+SIN(30), AC(10), "text" << R2, (1,2,3).
[[nodiscard]] std::optional<std::size_t> after_siemens_expression(std::string_view text,
                                                                  std::size_t at);

}  // namespace batten::gcode
