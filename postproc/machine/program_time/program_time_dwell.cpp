#include "postproc/machine/program_time/program_time_dwell.h"

namespace batten::postproc {
namespace {

using gcode::DwellUnit;

constexpr double kMillisecond = 0.001;

std::optional<double> number(const gcode::BlockWords& words, char letter) {
  const gcode::Word* word = words.find(letter);
  if (word == nullptr || !word->is_number || !(word->value >= 0)) return std::nullopt;
  return word->value;
}

}  // namespace

DwellTime dwell_of(const gcode::BlockWords& words, gcode::DwellUnit unit,
                   std::optional<double> spindle_speed) {
  if (const auto p = number(words, 'P')) {
    if (unit == DwellUnit::kSeconds) return {*p, false};
    const bool seconds = unit == DwellUnit::kByPoint && words.find('P')->has_point;
    const bool assumed = unit == DwellUnit::kByPoint && !seconds && *p > 0;
    return {seconds ? *p : *p * kMillisecond, assumed};
  }
  for (const char letter : {'X', 'U', 'F'}) {
    if (const auto seconds = number(words, letter)) return {seconds, false};
  }
  if (const auto turns = number(words, 'S'); turns && spindle_speed && *spindle_speed > 0) {
    return {*turns * 60 / *spindle_speed, false};
  }
  return {};
}

DwellUnit dwell_unit_of(const gcode::Dialect* target, const Machine& machine) {
  if (target != nullptr) return target->dwell_unit();
  return machine.model == ControllerModel::kLookAhead ? DwellUnit::kByPoint : DwellUnit::kSeconds;
}

}  // namespace batten::postproc
