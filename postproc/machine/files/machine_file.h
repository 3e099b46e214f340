// A machine of the user's own as a TOML file, and any machine written as one. The keys, their units
// and an example: docs/machine_file.md.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "postproc/machine/machine.h"

namespace batten::postproc {

// A file says what it is based on (a built-in machine or another file) and what differs; or it
// says everything. Its name is that of the file when it says none.
//
// Adds a sentence to `problems` for everything that is wrong, each with file, line, column, key,
// the value and what is allowed, and then returns nothing. `being_read`: files that are based on
// this one, which it must not be based on in turn.
[[nodiscard]] std::shared_ptr<const Machine> read_machine_file(
    const std::string& file, std::vector<std::string>& problems,
    const std::vector<std::filesystem::path>& being_read = {});

// The text of a file that says everything: read again, it is the same machine.
[[nodiscard]] std::string machine_file_text(const Machine& machine);

}  // namespace batten::postproc
