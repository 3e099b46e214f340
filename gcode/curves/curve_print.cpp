#include "gcode/curves/curve_print.h"

#include <algorithm>
#include <cmath>

#include "gcode/state/units.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {

PlacePrinter::PlacePrinter(const CurveSetting& setting)
    : setting_(setting), unit_(millimetres_per(setting.units)) {}

PrintedPlace PlacePrinter::print(const geometry::Point3& mm, const NumberFormat& format) const {
  PrintedPlace printed;
  printed.mm = setting_.start;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    if (!setting_.axes[i]) continue;
    printed.digits[i] = to_text(mm[axis] / unit_, format);
    printed.mm[axis] = read_number(printed.digits[i])->value * unit_;
  }
  return printed;
}

PrintedPlace PlacePrinter::place(const geometry::Point3& mm) const {
  return print(mm, setting_.places);
}

PrintedPlace PlacePrinter::last_place(const geometry::Point3& mm) const {
  NumberFormat format = setting_.places;
  format.decimals = std::max(format.decimals, setting_.last_decimals);
  return print(mm, format);
}

std::optional<PrintedPlace> PlacePrinter::start() const {
  PrintedPlace printed = last_place(setting_.start);
  const geometry::Vector3 off = printed.mm - setting_.start;
  if (off.cwiseAbs().maxCoeff() > geometry::kSamePlace) return std::nullopt;
  printed.mm = setting_.start;
  return printed;
}

std::string feed_word(const CurveSetting& setting) {
  if (!setting.feed) return {};
  return "F" + to_text(*setting.feed / millimetres_per(setting.units), setting.feeds);
}

void add_word(std::string& line, std::string_view word, const CurveSetting& setting) {
  if (word.empty()) return;
  if (setting.blanks && !line.empty()) line.push_back(' ');
  line += word;
}

}  // namespace batten::gcode
