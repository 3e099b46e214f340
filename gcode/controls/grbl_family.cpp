// grbl 1.1, its descendants grblHAL and FluidNC, and g2core. Facts: docs/controllers/grbl.md,
// docs/controllers/grbl_family.md.
#include <array>

#include "gcode/controls/built_in.h"
#include "gcode/controls/row_dialect.h"
#include "gcode/curves/g5_curve.h"

namespace batten::gcode {
namespace {

// grbl holds 32-bit numbers (0.00002 mm at 200 mm) and steps of some 0.004 mm, and its serial
// line is what starves it: the fourth decimal would be sent for nothing. A kink of 0.006 rad,
// the most that 3 decimals make between arcs of 0.5 mm, allows 1000 mm/s and more by its
// junction deviation of 0.01 mm.
constexpr DecimalsByUnit kPlaces = {3, 4};

// One more, so that the radii at the two ends agree to 0.0002 mm, far inside the 0.005 mm
// that grbl asks for, and the arc lies where the rounded ends say to within their own rounding.
constexpr DecimalsByUnit kCenters = {4, 5};

// Centres are 32-bit numbers: at 1000 mm they are right to 0.0001 mm, at ten times that to
// 0.001 mm only, and so are the chords that grbl makes.
constexpr double kMaxRadius = 1000;

// Longer arcs are noise away from none in 32 bits: see arc_rules.
constexpr double kMaxSweepDeg = 350;

// ! ~ ? are taken out of the serial stream and obeyed wherever they stand, in comments too; a line
// that starts with $ is an order.
constexpr std::string_view kObeyed = "$!~?";

TargetTable grbl_table(std::string_view name, std::string_view description) {
  TargetTable table;
  table.name = name;
  table.description = description;
  table.places = kPlaces;
  table.arc_ends = kPlaces;
  table.centers = kCenters;
  table.max_radius = kMaxRadius;
  table.max_sweep_deg = kMaxSweepDeg;
  table.machine = "router";
  return table;
}

TargetRow grbl() {
  TargetTable table =
      grbl_table("grbl", "grbl 1.1: arcs and helices in G17, G18, G19; lines of 79 characters");
  // The line buffer is 80 bytes with its terminator, filled after blanks and comments are gone.
  table.max_line_length = 79;
  TargetRow row{table, LineCount::kWithoutBlanksAndComments, kObeyed, &grbl_arc_rule};
  row.dwell_unit = DwellUnit::kSeconds;
  row.dwell_form = DwellForm::kSecondsP;
  row.known_marks = mark(SourceMark::kDollarLine);
  row.refused = "M6 G43 H";
  return row;
}

// Line buffers of 256 bytes; what of a line counts was not read, so all of it does.
constexpr SourceMarks kProgramming = mark(SourceMark::kDollarLine) | mark(SourceMark::kSubWords) |
                                     mark(SourceMark::kNamedParameters);

TargetRow grblhal() {
  TargetTable table =
      grbl_table("grblhal", "grblHAL: arcs and helices in G17, G18, G19; lines of 255 characters");
  TargetRow row{table, LineCount::kAll, kObeyed, &grbl_arc_rule};
  row.dwell_unit = DwellUnit::kSeconds;
  row.dwell_form = DwellForm::kSecondsP;
  row.known_marks = kProgramming;
  row.curves = &chopped_g5();
  return row;
}

TargetRow fluidnc() {
  TargetTable table =
      grbl_table("fluidnc", "FluidNC: arcs and helices in G17, G18, G19; lines of 255 characters");
  TargetRow row{table, LineCount::kAll, kObeyed, &grbl_arc_rule};
  row.dwell_unit = DwellUnit::kSeconds;
  row.dwell_form = DwellForm::kSecondsP;
  row.known_marks = kProgramming;
  row.refused = "G43 H";  // not read of it
  return row;
}

TargetRow g2core() {
  TargetTable table = grbl_table(
      "g2core", "g2core and TinyG: arcs and helices in G17, G18, G19; lines of 250 characters");
  // 255 bytes in one of its line buffers, fewer by the comment in others.
  table.max_line_length = 250;
  // TinyG asks for radii that agree to 0.1 %: at 0.2 mm that is 0.0002 mm, what the printed
  // offsets can say.
  table.min_radius = 0.2;
  table.centers = {5, 6};
  TargetRow row{table, LineCount::kAll, "$!~%{", &tinyg_arc_rule};
  row.dwell_unit = DwellUnit::kSeconds;
  row.dwell_form = DwellForm::kSecondsP;
  row.known_marks = mark(SourceMark::kDollarLine);
  row.refused = "M6 G43 G49 H";  // not read of it
  return row;
}

}  // namespace

const Dialect& grbl_dialect() {
  static const RowDialect kDialect(grbl());
  return kDialect;
}

std::span<const Dialect* const> grbl_family() {
  static const RowDialect kGrblhal(grblhal());
  static const RowDialect kFluidnc(fluidnc());
  static const RowDialect kG2core(g2core());
  static const std::array<const Dialect*, 4> kAll = {&grbl_dialect(), &kGrblhal, &kFluidnc,
                                                     &kG2core};
  return kAll;
}

}  // namespace batten::gcode
