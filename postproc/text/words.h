// Words for users and for files: escapes, and names that may have been meant.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace batten::postproc {

// The text with these characters replaced.
[[nodiscard]] std::string escaped(
    std::string_view text, std::initializer_list<std::pair<char, std::string_view>> replacements);

// Without these around it.
[[nodiscard]] std::string_view trimmed(std::string_view text, std::string_view blanks = " ");

// As TOML takes it: in quotes, with escapes where they are needed.
[[nodiscard]] std::string toml_quoted(std::string_view text);

// "1 run", "2 runs"
[[nodiscard]] std::string plural(std::size_t count, std::string_view noun);

// `batten` with these arguments, as one could type it in a shell.
[[nodiscard]] std::string command_line_of(std::span<const std::string> arguments);

// A line of a summary: the title in a column of its own.
[[nodiscard]] std::string titled(std::string_view title, std::string_view text);

// The name nearest to `text` when it is likely a slip of the finger; else empty.
[[nodiscard]] std::string_view nearest_name(std::string_view text,
                                            std::span<const std::string_view> names);

// ", did you mean 'grbl'?", or nothing.
[[nodiscard]] std::string suggestion(std::string_view text,
                                     std::span<const std::string_view> names);

}  // namespace batten::postproc
