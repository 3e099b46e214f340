#include <fmt/format.h>

#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/machine_fields.h"
#include "postproc/text/toml_text.h"

namespace batten::postproc {

namespace {

// The number is the shortest that is read as the same value.
std::string line_of(std::string_view key, double value, std::string_view unit,
                    std::string_view text) {
  return fmt::format("{} = {}  # {}, {}\n", key, value, unit, text);
}

}  // namespace

std::string machine_file_text(const Machine& machine) {
  std::string text =
      "# A machine for --machine FILE.toml; docs/machine_file.md tells about the keys. A value in\n"
      "# another unit is a text: \"5000 mm/min\". With based-on = \"NAME\" only what differs is "
      "needed.\n";
  text += fmt::format("name = {}\n", toml_quoted(machine.name));
  text += fmt::format("description = {}\n", toml_quoted(machine.description));
  text += fmt::format("model = \"{}\"  # linuxcnc, grbl or look-ahead\n", name_of(machine.model));
  text += fmt::format(
      "path-mode = \"{}\"  # until the program says: blend (G64), exact-path (G61) or exact-stop\n",
      name_of(machine.path_mode));
  text += fmt::format("look-ahead = {}  # blocks\n", machine.look_ahead);
  for (const MachineField& field : machine_fields()) {
    text +=
        line_of(field.key, machine.*field.place, units_of(field.quantity).front().name, field.text);
  }
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto axis = static_cast<Axis>(i);
    text += fmt::format("\n[axis.{}]\n", name_of(axis));
    for (const AxisField& field : axis_fields()) {
      const Quantity quantity = i < kLinearAxes ? field.linear : field.rotary;
      text += line_of(field.key, machine.axis(axis).*field.place, units_of(quantity).front().name,
                      field.text);
    }
  }
  return text;
}

}  // namespace batten::postproc
