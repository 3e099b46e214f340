// A machine of the user's own, from a TOML file. It starts as one of the built-in machines and
// changes what differs:
//
//   based-on = "linuxcnc"          # batten machines; required
//   name = "router"
//   max-velocity = 200             # mm/s on every axis
//   max-acceleration = 1500        # mm/s2 on every axis
//   rapid-velocity = 250           # mm/s
//   block-period = 0.001           # s
//   look-ahead = 2000              # blocks
//   junction-deviation = 0.01      # mm (grbl's $11)
//   arc-tolerance = 0.002          # mm (grbl's $12)
//   blend-tolerance = 0.01         # mm (LinuxCNC's G64 P)
//   naive-cam-tolerance = 0        # mm (LinuxCNC's G64 Q)
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "postproc/machine/machine.h"

namespace batten::postproc {

// Adds a sentence to `problems` for everything that is wrong, each with file and line, and then
// returns nothing.
[[nodiscard]] std::shared_ptr<const Machine> read_machine_file(const std::string& file,
                                                               std::vector<std::string>& problems);

}  // namespace batten::postproc
