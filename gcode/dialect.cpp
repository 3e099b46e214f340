#include "gcode/dialect.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "gcode/dialects/built_in.h"

namespace batten::gcode {

std::span<const Dialect* const> dialects() {
  static const std::vector<const Dialect*> kAll = [] {
    std::vector<const Dialect*> all = {&linuxcnc_dialect()};
    for (const auto family :
         {grbl_family(), printer_family(), pc_family(), machining_center_family(), fanuc_family(),
          plc_family(), siemens_family()}) {
      all.insert(all.end(), family.begin(), family.end());
    }
    return all;
  }();
  return kAll;
}

double chord_error(const ArcChords& chords, double radius) {
  if (!(chords.longest > 0)) return chords.error;
  double length = chords.longest;
  if (chords.per_circle > 0) {
    const double wished = 2 * std::numbers::pi * radius / chords.per_circle;
    length = std::clamp(wished, chords.shortest, chords.longest);
  }
  const double half_angle = std::min(length / (2 * radius), std::numbers::pi / 2);
  return std::max(chords.error, radius * (1 - std::cos(half_angle)));
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
