// The machine that a user names: `--machine` of every command, and what a machine file is based on;
// a machine of the user's own as a TOML file, and any machine written as one. The keys, their units
// and an example: docs/machine_file.md.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "postproc/machine/machine.h"

namespace batten::postproc {

// The name of a built-in machine, a machine file (NAME.toml), the INI of a LinuxCNC machine
// (NAME.ini), or the configuration of one with Klipper (NAME.cfg), FluidNC (NAME.yaml),
// RepRapFirmware (config.g) or Marlin (NAME.txt, its answer to M503). Adds to `problems` what is
// wrong and returns nothing then; `asked_by` stands in front of what is wrong with the choice
// itself
// ("--machine"). `being_read`: see read_machine_file.
[[nodiscard]] std::shared_ptr<const Machine> choose_machine(
    const std::string& choice, const std::string& asked_by, std::vector<std::string>& problems,
    const std::vector<std::filesystem::path>& being_read = {});

// `base` with the settings in a file that holds grbl's answer to `$$`; named after the file. No
// `base`: grbl. Read are $11, $12, and $110 to $112 and $120 to $122 for X Y Z (a dump of grblHAL
// goes on for A B C). Adds to `problems` what is wrong and returns nothing then.
[[nodiscard]] std::shared_ptr<const Machine> machine_with_grbl_settings(
    const Machine* base, const std::string& file, std::vector<std::string>& problems);

// "linuxcnc, router, .., a file NAME.toml, or the NAME.ini of a LinuxCNC machine"
[[nodiscard]] std::string possible_machines();

// A file says what it is based on (a built-in machine or another file) and what differs; or it
// says everything. Its name is that of the file when it says none.
//
// Adds a sentence to `problems` for everything that is wrong, each with file, line, column, key,
// the value and what is allowed, and then returns nothing. `being_read`: files that are based on
// this one, which it must not be based on in turn.
[[nodiscard]] std::shared_ptr<const Machine> read_machine_file(
    const std::string& file, std::vector<std::string>& problems,
    const std::vector<std::filesystem::path>& being_read = {});

// A LinuxCNC machine from its INI file: how fast its axes are, and what its planner is set to.
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

// A machine with Klipper from its printer.cfg. Read are [printer] max_velocity, max_accel,
// max_z_velocity, max_z_accel, square_corner_velocity, minimum_cruise_ratio (or the older
// max_accel_to_decel), and [gcode_arcs] resolution; the first two must be there, the others have
// Klipper's defaults. All else is as the built-in machine klipper-router has it. Files that
// [include ..] names are read, too.
//
// Adds to `problems` what is wrong, with file, line and column, and returns nothing then.
[[nodiscard]] std::shared_ptr<const Machine> read_printer_cfg(const std::string& file,
                                                              std::vector<std::string>& problems);

// A machine with Marlin from what it answers to M503: M92, M201, M203, M204 T, M205 X Y Z or J; all
// else is as marlin-router has it. One with RepRapFirmware from its config.g: M201, M203, M566 (or
// M205), M204 T; planned with ends as programmed. Where a word stands twice, the last counts.
[[nodiscard]] std::shared_ptr<const Machine> read_marlin_settings(
    const std::string& file, std::vector<std::string>& problems);
[[nodiscard]] std::shared_ptr<const Machine> read_reprap_config(const std::string& file,
                                                                std::vector<std::string>& problems);

// A machine with FluidNC from its YAML: axes/x/steps_per_mm, max_rate_mm_per_min and
// acceleration_mm_per_sec2 (y, z), junction_deviation_mm, arc_tolerance_mm, planner_blocks; all
// else is as router has it.
[[nodiscard]] std::shared_ptr<const Machine> read_fluidnc_yaml(const std::string& file,
                                                               std::vector<std::string>& problems);

// The text of a file that says everything: read again, it is the same machine.
[[nodiscard]] std::string machine_file_text(const Machine& machine);

}  // namespace batten::postproc
