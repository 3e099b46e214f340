#include "gcode/controls/rs274_family.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

bool fits_in_comment(char c) { return c >= ' ' && c <= '~' && c != '(' && c != ')'; }

// Comments that begin so are orders, blanks and case ignored.
bool acts(std::string_view text) {
  constexpr std::array<std::string_view, 10> kOrders = {
      "MSG,",       "DEBUG,",   "PRINT,", "LOG,",      "LOGOPEN,",
      "LOGAPPEND,", "LOGCLOSE", "PY,",    "PROBEOPEN", "PROBECLOSE"};
  std::string bare;
  for (const char c : text) {
    if (c != ' ' && c != '\t') bare.push_back(upper(c));
  }
  return std::ranges::any_of(kOrders,
                             [&](std::string_view order) { return bare.starts_with(order); });
}

}  // namespace

double EndRadii::mismatch() const { return std::abs(end - start); }

EndRadii end_radii(const geometry::Arc& arc) {
  const auto across = [&arc](const geometry::Point3& place) {
    const geometry::Vector3 from_center = place - arc.center;
    return (from_center - from_center.dot(arc.axis) * arc.axis).norm();
  };
  return {across(arc.start), across(arc.end)};
}

NumberFormat Rs274Dialect::feeds(Units) const { return {.decimals = 6}; }

std::size_t Rs274Dialect::line_length(std::string_view line) const { return line.size(); }

bool Rs274Dialect::takes_arcs_in(Plane plane) const { return plane != Plane::kUnknown; }

std::string Rs274Dialect::comment(std::string_view text) const {
  if (!std::ranges::all_of(text, fits_in_comment) || acts(text)) return {};
  std::string line = "(" + std::string(text) + ")";
  if (line_length(line) > max_line_length()) return {};
  return line;
}

}  // namespace batten::gcode
