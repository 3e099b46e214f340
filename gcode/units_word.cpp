#include "gcode/units_word.h"

namespace batten::gcode {

bool is_lathe_cycle(Code code, const BlockWords& words) {
  return (code == 700 || code == 710) && words.has_any("PQUVWDIJKRABCEFSXYZL");
}

std::optional<Units> units_set_by(const BlockWords& words) {
  for (const Code code : words.g_codes()) {
    const bool inch = code == 200 || code == 700;
    const bool millimetre = code == 210 || code == 710;
    if ((inch || millimetre) && !is_lathe_cycle(code, words)) {
      return inch ? Units::kInch : Units::kMillimetre;
    }
  }
  return std::nullopt;
}

}  // namespace batten::gcode
