// The command line: words to a command with checked options, or every problem at once.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "postproc/cli/cli_given.h"
#include "postproc/commands/commands.h"

namespace batten::postproc {

// What follows a command's name. All that is wrong with it is in `problems`, not only the first;
// the command then means nothing.
struct Arguments {
  Given given;
  std::vector<std::string> files;  // the words that are no options
  Problems problems = {};

  template <typename... Values>
  void complain(fmt::format_string<Values...> text, Values&&... values) {
    problems.push_back(fmt::format(text, std::forward<Values>(values)...));
  }
};

// --help, --version, --print-config, man ..: for standard output, and the program is done.
struct PrintText {
  std::string text;
};

using Command = std::variant<PrintText, SmoothCommand, SmoothFilesCommand, SetupCommand,
                             ExploreCommand, VerifyCommand, InspectCommand, TimeCommand,
                             BatchCommand, FreecadCommand, ListCommand, MethodsCommand>;

// `name` is one of those that read, list or write programs and machines: "smooth" .. "methods".
[[nodiscard]] Command command_of(std::string_view name, Arguments& in);

[[nodiscard]] SmoothCommand smooth_command(Arguments& in);

[[nodiscard]] SetupCommand setup_command(Arguments& in);

// Asks on standard error for what is to be kept, and reads the answers from standard input.
void ask_for_setup(SetupCommand& command, Problems& problems);

// 'a': one word too many.
void refuse_words_after(std::size_t expected, std::string_view what, Arguments& in);

struct CommandLine {
  Command command;
  Problems problems;               // not empty: `command` means nothing
  std::string help_hint;           // what to call for help on it
  std::vector<std::string> notes;  // which files gave options, where the command does not say it
};

// `arguments` without the program's own name. Reads files of configuration (cli_config.h), of
// --target, --profile, --machine and --grbl-settings, the beginning of a program whose target is
// not given, and for `setup` standard input. Writes none.
[[nodiscard]] CommandLine read_command_line(const std::vector<std::string>& arguments);

}  // namespace batten::postproc
