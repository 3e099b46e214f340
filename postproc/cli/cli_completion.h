// Completion of commands, options and their values for shells, made from the table of commands.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/cli/cli_table.h"

namespace batten::postproc {

// The values that an option can have, where they are names: those of its help ("time|size"), the
// targets, the machines, the reasons that can be lifted.
[[nodiscard]] std::vector<std::string_view> names_for(const OptionRow& row);

// Whether a file can stand as the option's value.
[[nodiscard]] bool takes_file(const OptionRow& row);

[[nodiscard]] std::string bash_completion();
[[nodiscard]] std::string zsh_completion();

// By the shell's name, "bash" or "zsh"; nothing for others.
[[nodiscard]] std::optional<std::string> completion_for(std::string_view shell);

}  // namespace batten::postproc
