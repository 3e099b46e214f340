// From what was given as text to commands with checked options.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "postproc/cli/cli_given.h"
#include "postproc/commands/commands.h"

namespace batten::postproc {

// What stands behind a command's name. All that is wrong with it is told in `problems`, not only
// the first; the command then means nothing.
struct Arguments {
  Given given;
  std::vector<std::string> files;  // the words that are no options
  Problems problems = {};
};

// --help, --version, --print-config: for standard output, and the program is done.
struct PrintText {
  std::string text;
};

using Command = std::variant<PrintText, SmoothCommand, VerifyCommand, InspectCommand, TimeCommand,
                             BatchCommand, FreecadCommand, ListCommand, MachinesCommand>;

// `name` is one of those that read, list or write programs and machines: "smooth" .. "methods".
[[nodiscard]] Command command_of(std::string_view name, Arguments& in);

[[nodiscard]] SmoothCommand smooth_command(Arguments& in);

// "--output: there is no 'arc'; did you mean arcs? Possible: auto, arcs, lines"
[[nodiscard]] std::string unknown_name(std::string_view option, std::string_view text,
                                       std::span<const std::string_view> names);

// 'a': one word too many.
void refuse_words_after(std::size_t expected, std::string_view what, Arguments& in);

}  // namespace batten::postproc
