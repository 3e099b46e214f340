// From what was given as text to commands with checked options.
#pragma once

#include <string>
#include <vector>

#include "postproc/cli/cli_given.h"
#include "postproc/cli/cli_values.h"
#include "postproc/commands/commands.h"

namespace batten::postproc {

// Each adds to `problems` all that is wrong, not only the first; the command then means nothing.
// `files`: the words that are no options.
[[nodiscard]] SmoothCommand smooth_command(const Given& given,
                                           const std::vector<std::string>& files,
                                           Problems& problems);
[[nodiscard]] VerifyCommand verify_command(const Given& given,
                                           const std::vector<std::string>& files,
                                           Problems& problems);
[[nodiscard]] InspectCommand inspect_command(const Given& given,
                                             const std::vector<std::string>& files,
                                             Problems& problems);
[[nodiscard]] TimeCommand time_command(const Given& given, const std::vector<std::string>& files,
                                       Problems& problems);
[[nodiscard]] BatchCommand batch_command(const Given& given, const std::vector<std::string>& files,
                                         Problems& problems);
[[nodiscard]] FreecadCommand freecad_command(const Given& given,
                                             const std::vector<std::string>& files,
                                             Problems& problems);
[[nodiscard]] ListCommand list_command(BuiltIn what, const Given& given,
                                       const std::vector<std::string>& files, Problems& problems);
[[nodiscard]] MachinesCommand machines_command(const Given& given,
                                               const std::vector<std::string>& files,
                                               Problems& problems);

}  // namespace batten::postproc
