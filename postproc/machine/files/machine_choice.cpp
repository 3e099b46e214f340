#include "postproc/machine/files/machine_choice.h"

#include <fmt/format.h>

#include <optional>
#include <string_view>

#include "gcode/text/source_text.h"
#include "postproc/machine/files/grbl_settings.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/files/machine_ini.h"
#include "postproc/text/nearest_name.h"

namespace batten::postproc {
namespace {

std::vector<std::string_view> built_in_names() {
  std::vector<std::string_view> names;
  for (const Machine& machine : built_in_machines()) names.emplace_back(machine.name);
  return names;
}

// Built-in machines live as long as the program.
std::shared_ptr<const Machine> shared_built_in(const Machine& machine) {
  return {std::shared_ptr<const Machine>(), &machine};
}

bool has_suffix(const std::string& file, std::string_view suffix) {
  std::string last = std::filesystem::path(file).extension().string();
  for (char& letter : last) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return last == suffix;
}

}  // namespace

std::string possible_machines() {
  std::string text;
  for (const std::string_view name : built_in_names()) text += std::string(name) + ", ";
  return text + "a file NAME.toml, or the NAME.ini of a LinuxCNC machine";
}

std::shared_ptr<const Machine> choose_machine(
    const std::string& choice, const std::string& asked_by, std::vector<std::string>& problems,
    const std::vector<std::filesystem::path>& being_read) {
  if (const Machine* machine = find_machine(choice)) return shared_built_in(*machine);
  if (has_suffix(choice, ".toml")) return read_machine_file(choice, problems, being_read);
  if (has_suffix(choice, ".ini")) return read_machine_ini(choice, problems);
  problems.push_back(fmt::format("{}: there is no machine '{}'{}; possible: {}", asked_by, choice,
                                 suggestion(choice, built_in_names()), possible_machines()));
  return nullptr;
}

std::shared_ptr<const Machine> machine_with_grbl_settings(const Machine* base,
                                                          const std::string& file,
                                                          std::vector<std::string>& problems) {
  if (base != nullptr && base->model != ControllerModel::kGrbl) {
    problems.push_back(
        fmt::format("--grbl-settings: the control of machine {} is {}, expected a machine with "
                    "grbl, such as router",
                    base->name, name_of(base->model)));
    return nullptr;
  }
  std::string error;
  const auto dump = gcode::SourceText::map_file(file, error);
  if (!dump) {
    problems.push_back("--grbl-settings: " + error);
    return nullptr;
  }
  auto machine = with_grbl_settings(base == nullptr ? *find_machine("grbl") : *base, dump->text(),
                                    file, problems);
  if (!machine) return nullptr;
  machine->name = std::filesystem::path(file).stem().string();
  machine->description = "grbl with the settings in " + file;
  return std::make_shared<const Machine>(std::move(*machine));
}

}  // namespace batten::postproc
