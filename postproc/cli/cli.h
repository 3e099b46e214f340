// The command line: words to a command with checked options, or every problem at once.
#pragma once

#include <string>
#include <vector>

#include "postproc/cli/cli_commands.h"

namespace batten::postproc {

struct CommandLine {
  Command command;
  Problems problems;      // not empty: `command` means nothing
  std::string help_hint;  // what to call for help on it
};

// `arguments` without the program's own name. Reads the files of --config, --machine and
// --grbl-settings and touches no other.
[[nodiscard]] CommandLine read_command_line(const std::vector<std::string>& arguments);

}  // namespace batten::postproc
