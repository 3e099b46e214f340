// A LinuxCNC machine from its INI file: how fast its axes are, and what its planner is set to.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "postproc/machine/machine.h"

namespace batten::postproc {

// Read are, in machine units, millimetres or inches as [TRAJ]LINEAR_UNITS says:
//   [AXIS_X] .. [AXIS_C]  MAX_VELOCITY, MAX_ACCELERATION, for rapids too
//   [JOINT_n]             where an axis has none: the joint that [KINS]KINEMATICS coordinates= or
//                         [TRAJ]COORDINATES puts there; [AXIS_n] in files of LinuxCNC 2.7
//   [TRAJ]                MAX_LINEAR_VELOCITY, ARC_BLEND_OPTIMIZATION_DEPTH
//   [EMCMOT]              SERVO_PERIOD
//   [RS274NGC]            RS274NGC_STARTUP_CODE: G64 P Q, G61, G61.1
// All else is as the built-in machine linuxcnc has it, but that there is no G64 P Q without a
// startup code that says so. Axes that the machine has not are never the limit.
//
// Adds to `problems` what is wrong, with file, line and column, and returns nothing then.
[[nodiscard]] std::shared_ptr<const Machine> read_machine_ini(const std::string& file,
                                                              std::vector<std::string>& problems);

}  // namespace batten::postproc
