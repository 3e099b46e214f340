// The dialects by family, each family in the .cpp of its name: a class where a control has ways of
// its own, a row of a table (row_dialect.h) where values and known rules say all. To add one: a row
// in its family, or its .cpp, a line here and its place in the list of built_in.cpp.
#pragma once

#include "gcode/control/dialect.h"

namespace batten::gcode {

[[nodiscard]] const Dialect& linuxcnc_dialect();
[[nodiscard]] const Dialect& grbl_dialect();
[[nodiscard]] std::span<const Dialect* const> grbl_family();              // grbl first
[[nodiscard]] std::span<const Dialect* const> printer_family();           // Marlin ..
[[nodiscard]] std::span<const Dialect* const> pc_family();                // Mach3 ..
[[nodiscard]] std::span<const Dialect* const> machining_center_family();  // Haas ..
[[nodiscard]] std::span<const Dialect* const> plc_family();               // CODESYS ..
[[nodiscard]] std::span<const Dialect* const> fanuc_family();       // FANUC, Syntec, Mitsubishi
[[nodiscard]] std::span<const Dialect* const> siemens_family();     // by curve words
[[nodiscard]] std::span<const Dialect* const> heidenhain_family();  // Klartext

// All built-in dialects, in the order in which `batten targets` lists them.
[[nodiscard]] std::span<const Dialect* const> dialects();

// Nothing when there is no dialect of that name.
[[nodiscard]] const Dialect* find_dialect(std::string_view name);

}  // namespace batten::gcode
