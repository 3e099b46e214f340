#include "postproc/options/target_on_machine.h"

#include "gcode/controls/built_in.h"

namespace batten::postproc {
namespace {

gcode::ArcChords chords_on(const gcode::Control& target, const Machine& machine) {
  gcode::ArcChords chords = target.chords;
  // grbl, grblHAL and FluidNC have one parser.
  if (target.arc_rule == gcode::ArcRule::kGrbl && chords.error > 0 && is_grbl(machine.model)) {
    chords.error = machine.arc_tolerance;
  }
  const bool by_length = chords.longest > 0 && chords.per_circle == 0;
  if (by_length && machine.model == ControllerModel::kKlipper) {
    chords.longest = machine.arc_resolution;
  }
  return chords;
}

}  // namespace

std::shared_ptr<const gcode::Control> target_on_machine(const gcode::Control& target,
                                                        const Machine& machine) {
  const gcode::ArcChords chords = chords_on(target, machine);
  if (chords == target.chords) return {std::shared_ptr<const gcode::Control>(), &target};
  gcode::Control set_up = target;
  set_up.chords = chords;
  return std::make_shared<const gcode::Control>(std::move(set_up));
}

const gcode::Control* only_control_of(ControllerModel model) {
  const gcode::Control* only = nullptr;
  for (const gcode::Control& control : gcode::controls()) {
    if (find_machine(control.machine)->model != model) continue;
    if (only != nullptr) return nullptr;
    only = &control;
  }
  return only;
}

}  // namespace batten::postproc
