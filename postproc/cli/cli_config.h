// Options that the command line does not give: from files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "postproc/cli/cli_given.h"

namespace batten::postproc {

// Completes what is given from these files, the first that gives an option counts:
//
//   1. --config FILE
//   2. batten.toml in the folder of the program, or in the nearest folder above it that has one
//   3. the file that the variable BATTEN_CONFIG names
//   4. the user's own, which `batten setup` writes
//
// Taken are options that `command` has and that mean the same to it as to `smooth`. `program`: as
// given, a folder too; empty or "-": the current folder counts. Files that are found rather than
// named (2 to 4) give no machine for a target that was named before them.
void complete_from_configs(std::string_view command, const std::string& program, Given& given,
                           Problems& problems);

// $XDG_CONFIG_HOME/batten/config.toml, ~/.config/batten/config.toml; empty where neither is known.
[[nodiscard]] std::filesystem::path user_config_file();

}  // namespace batten::postproc
