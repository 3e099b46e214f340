// The machine that the options of a command name; the same options for every command.
#pragma once

#include <memory>
#include <string_view>

#include "postproc/cli/cli_given.h"
#include "postproc/cli/cli_values.h"
#include "postproc/machine/machine.h"

namespace batten::postproc {

// --machine, or the built-in machine `otherwise` (may be empty) when that is not given, with what
// --grbl-settings says. Null when there is none, and when something was wrong, which `problems`
// tell then.
[[nodiscard]] std::shared_ptr<const Machine> machine_given(const Given& given,
                                                           std::string_view otherwise,
                                                           Problems& problems);

}  // namespace batten::postproc
