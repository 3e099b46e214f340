// Finds where parameters and expressions end; does not compute them.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace batten::gcode {

// All functions take the place where something starts and give the place after it, or
// nothing when it does not stand there in full. Blanks are skipped.

// #5  ##5  #<name>  #[1+2]
[[nodiscard]] std::optional<std::size_t> after_parameter(std::string_view text, std::size_t at);

// [1+[2*3]], without comments or strings inside.
[[nodiscard]] std::optional<std::size_t> after_brackets(std::string_view text, std::size_t at);

// SIN[30], FIX[#1]: a function's name and its brackets. ATAN[1]/[2] is two operands.
[[nodiscard]] std::optional<std::size_t> after_function(std::string_view text, std::size_t at);

// A value that a letter may take in place of a number: an optional sign, then a parameter,
// brackets or a function.
[[nodiscard]] std::optional<std::size_t> after_computed_value(std::string_view text,
                                                              std::size_t at);

// The right side of an assignment: values, numbers and R parameters, joined by operators.
[[nodiscard]] std::optional<std::size_t> after_sum(std::string_view text, std::size_t at);

}  // namespace batten::gcode
