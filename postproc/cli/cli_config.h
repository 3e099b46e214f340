// Options in a file: TOML, one key per long option of `batten smooth`.
//
//   target = "linuxcnc"
//   tolerance = "0.01mm"
//   allow = ["exact-stop"]
//   strict = true
#pragma once

#include <optional>
#include <string>

#include "postproc/cli/cli_given.h"
#include "postproc/cli/cli_values.h"

namespace batten::postproc {

// Numbers, strings and booleans count as the text that stands for them on the command line. A
// file that cannot be read, a key that is no option, and a value of another kind are problems,
// each with file and line.
[[nodiscard]] Given read_config(const std::string& file, Problems& problems);

// All options that may stand in such a file: those given and those with a default as they are,
// the others as comments. `read_config` reads it back to the same options.
[[nodiscard]] std::string config_text(const Given& given);

}  // namespace batten::postproc
