#include "gcode/control/target_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "gcode/rs274/active_comment.h"

namespace batten::gcode {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;

int decimals_in(const DecimalsByUnit& decimals, Units units) {
  return units == Units::kInch ? decimals.inch : decimals.mm;
}

DecimalsByUnit decimals_of(const Dialect& dialect, NumberFormat (Dialect::*format)(Units) const) {
  return {(dialect.*format)(Units::kMillimetre).decimals, (dialect.*format)(Units::kInch).decimals};
}

// Degrees as a person would write them: 180, not 179.99999999999997.
double whole_degrees(double radians) {
  constexpr double kFine = 1e9;
  return std::round(radians / kOneDegree * kFine) / kFine;
}

bool can_stand_in_comment(char c) { return c >= ' ' && c <= '~' && c != '(' && c != ')'; }

}  // namespace

TargetTable table_of(const Dialect& dialect) {
  const NumberFormat places = dialect.coordinates(Units::kMillimetre);
  const std::string comment = dialect.comment("x");
  TargetTable table;
  table.name = dialect.name();
  table.description = dialect.description();
  table.places = decimals_of(dialect, &Dialect::coordinates);
  table.arc_ends = decimals_of(dialect, &Dialect::arc_ends);
  table.centers = decimals_of(dialect, &Dialect::arc_offsets);
  table.feed_decimals = dialect.feeds(Units::kMillimetre).decimals;
  table.decimal_point = places.always_point;
  table.trailing_zeros = places.trailing_zeros;
  table.max_line_length = dialect.max_line_length();
  table.blanks = dialect.blanks_between_words();
  table.comments = comment.starts_with('(')   ? CommentStyle::kParentheses
                   : comment.starts_with(';') ? CommentStyle::kSemicolon
                                              : CommentStyle::kNone;
  table.planes = {dialect.takes_arcs_in(Plane::kXY), dialect.takes_arcs_in(Plane::kZX),
                  dialect.takes_arcs_in(Plane::kYZ)};
  table.helices = dialect.takes_helices();
  table.arc_distance_mode = dialect.takes_arc_distance_mode();
  table.arc_form = dialect.arc_form();
  table.max_sweep_deg = whole_degrees(dialect.max_arc_sweep());
  table.single_quadrants = dialect.needs_single_quadrants();
  table.min_radius = dialect.min_arc_radius();
  table.max_radius = dialect.max_arc_radius();
  table.chords = dialect.arc_chords();
  table.repeats_words = dialect.repeats_words();
  table.machine = dialect.default_machine();
  return table;
}

std::string comment_in(CommentStyle style, std::string_view text) {
  std::string in_parentheses = "(" + std::string(text) + ")";
  if (!std::ranges::all_of(text, can_stand_in_comment) || is_active_comment(in_parentheses)) {
    return {};
  }
  switch (style) {
    case CommentStyle::kParentheses:
      return in_parentheses;
    case CommentStyle::kSemicolon:
      return "; " + std::string(text);
    case CommentStyle::kNone:
      break;
  }
  return {};
}

TableValues::TableValues(TargetTable table) : table_(std::move(table)) {}

NumberFormat TableValues::coordinates(Units units) const {
  return {decimals_in(table_.places, units), table_.trailing_zeros, table_.decimal_point};
}

NumberFormat TableValues::arc_ends(Units units) const {
  return {decimals_in(table_.arc_ends, units), table_.trailing_zeros, table_.decimal_point};
}

NumberFormat TableValues::arc_offsets(Units units) const {
  return {decimals_in(table_.centers, units), table_.trailing_zeros, table_.decimal_point};
}

NumberFormat TableValues::feeds(Units) const {
  return {table_.feed_decimals, false, table_.decimal_point};
}

bool TableValues::takes_arcs_in(Plane plane) const {
  switch (plane) {
    case Plane::kXY:
      return table_.planes[0];
    case Plane::kZX:
      return table_.planes[1];
    case Plane::kYZ:
      return table_.planes[2];
    case Plane::kUnknown:
      break;
  }
  return false;
}

double TableValues::max_arc_sweep() const { return table_.max_sweep_deg * kOneDegree; }

std::string TableValues::comment(std::string_view text) const {
  std::string line = comment_in(table_.comments, text);
  if (line_length(line) > max_line_length()) return {};
  return line;
}

}  // namespace batten::gcode
