#include "gcode/state/units.h"

#include <cmath>
#include <stdexcept>

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

double millimetres_per(Units units) {
  switch (units) {
    case Units::kMillimetre:
      return 1;
    case Units::kInch:
      return 25.4;
    case Units::kUnknown:
      break;
  }
  throw std::invalid_argument("millimetres_per: units unknown, expected millimetre or inch");
}

double printed_step(const NumberFormat& format, Units units) {
  return std::pow(10.0, -format.decimals) * millimetres_per(units);
}

}  // namespace batten::gcode
