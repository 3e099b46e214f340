#include "gcode/state/path_control.h"

#include <algorithm>

namespace batten::gcode {

PathControl path_control_of(PathMode mode, const BlockWords& words, Units units) {
  PathControl control = mode;
  if (mode != PathMode::kBlending) return control;
  const double unit = units == Units::kInch ? kMillimetresPerInch : 1;
  const auto value = [&](char letter, double otherwise) {
    const Word* word = words.find(letter);
    return word != nullptr && word->is_number ? std::max(0.0, word->value * unit) : otherwise;
  };
  control.blend_tolerance = value('P', 0);
  control.naive_cam_tolerance = value('Q', *control.blend_tolerance);
  return control;
}

}  // namespace batten::gcode
