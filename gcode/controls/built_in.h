// The built-in controls by family, each family in the .cpp of its name. To add one: a value in its
// family; or a .cpp for a new family, a line here and its place in the list of built_in.cpp.
#pragma once

#include <span>
#include <vector>

#include "gcode/control/control.h"

namespace batten::gcode {

[[nodiscard]] std::vector<Control> linuxcnc_family();
[[nodiscard]] std::vector<Control> grbl_family();
[[nodiscard]] std::vector<Control> printer_family();           // Marlin ..
[[nodiscard]] std::vector<Control> pc_family();                // Mach3 ..
[[nodiscard]] std::vector<Control> machining_center_family();  // Haas ..
[[nodiscard]] std::vector<Control> fanuc_family();             // FANUC, Syntec, Mitsubishi
[[nodiscard]] std::vector<Control> plc_family();               // CODESYS ..
[[nodiscard]] std::vector<Control> siemens_family();           // by curve words
[[nodiscard]] std::vector<Control> heidenhain_family();        // Klartext

// All of them, in the order in which `batten targets` lists them.
[[nodiscard]] std::span<const Control> controls();

// Nothing when there is no control of that name.
[[nodiscard]] const Control* find_control(std::string_view name);

}  // namespace batten::gcode
