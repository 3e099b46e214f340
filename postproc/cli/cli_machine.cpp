#include "postproc/cli/cli_machine.h"

#include "postproc/machine/files/machine_file.h"

namespace batten::postproc {

std::shared_ptr<const Machine> machine_given(const Given& given, std::string_view otherwise,
                                             Problems& problems) {
  const auto choice = given.value("machine");
  const auto settings = given.value("grbl-settings");
  std::shared_ptr<const Machine> machine;
  if (choice || !otherwise.empty()) {
    machine = choose_machine(choice.value_or(std::string(otherwise)), "--machine", problems);
    if (machine == nullptr) return nullptr;
  }
  if (!settings) return machine;
  // The settings say that the control is grbl; only who says otherwise contradicts them.
  const bool contradicts = machine != nullptr && machine->model != ControllerModel::kGrbl;
  const Machine* base = contradicts && !choice ? nullptr : machine.get();
  return machine_with_grbl_settings(base, *settings, problems);
}

}  // namespace batten::postproc
