#include "gcode/dialect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "gcode/dialects/built_in.h"

namespace batten::gcode {

std::span<const Dialect* const> dialects() {
  static const std::array<const Dialect*, 2> kAll = {&linuxcnc_dialect(), &grbl_dialect()};
  return kAll;
}

const Dialect* find_dialect(std::string_view name) {
  const auto all = dialects();
  const auto found = std::ranges::find(all, name, &Dialect::name);
  return found == all.end() ? nullptr : *found;
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
