// Controls that run on a PC or a board of their own and read RS-274/NGC with additions: Mach3,
// Mach4, UCCNC, EdingCNC, PlanetCNC, Masso, Centroid. Facts: docs/controllers/pc_family.md.
#include <array>

#include "gcode/controls/built_in.h"
#include "gcode/controls/row_dialect.h"

namespace batten::gcode {
namespace {

// Numbers are doubles; how many digits are kept was not read for any of them but by their posts.
TargetTable pc_table(std::string_view name, std::string_view description) {
  TargetTable table;
  table.name = name;
  table.description = description;
  table.places = {4, 5};
  table.arc_ends = {4, 5};
  table.centers = {4, 5};
  // What posts of these controls allow: half turns, radii to 1000 mm.
  table.max_sweep_deg = 180;
  table.max_radius = 1000;
  table.max_line_length = 120;  // unknown; no line of ours needs more
  return table;
}

// Whether I J K are offsets is a setting of the control, and G90.1 changes it: R is the same under
// either. Quarter turns at the most, as its centre is the less certain the longer the arc.
TargetTable by_radius(TargetTable table) {
  table.arc_form = ArcForm::kRadius;
  table.max_sweep_deg = 90;
  return table;
}

TargetRow mach3() {
  return {by_radius(pc_table("mach3", "Mach3: arcs by R in G17, G18, G19; helices"))};
}

TargetRow mach4() {
  return {by_radius(pc_table("mach4", "Mach4: arcs by R in G17, G18, G19; helices"))};
}

TargetRow uccnc() {
  return {by_radius(pc_table("uccnc", "UCCNC: arcs by R in G17, G18, G19; helices"))};
}

TargetRow edingcnc() {
  TargetRow row{pc_table("edingcnc", "EdingCNC: arcs and helices in G17, G18, G19")};
  row.known_marks = mark(SourceMark::kBlendTolerance);
  return row;
}

TargetRow planetcnc() {
  TargetRow row{pc_table("planetcnc", "PlanetCNC: arcs and helices in G17, G18, G19")};
  row.known_marks = mark(SourceMark::kBlendTolerance) | mark(SourceMark::kUniformNurbs);
  return row;
}

TargetRow masso() {
  TargetTable table = pc_table("masso", "Masso: arcs and helices in G17, G18, G19");
  table.places = {3, 4};
  table.arc_ends = {3, 4};
  table.centers = {3, 4};
  return {table};
}

TargetRow centroid() {
  TargetTable table =
      pc_table("centroid", "Centroid: arcs and helices in G17, G18, G19; decimal point always");
  table.places = {3, 4};
  table.arc_ends = {3, 4};
  table.centers = {3, 4};
  table.decimal_point = true;
  return {table};
}

}  // namespace

std::span<const Dialect* const> pc_family() {
  static const RowDialect kMach3(mach3());
  static const RowDialect kMach4(mach4());
  static const RowDialect kUccnc(uccnc());
  static const RowDialect kEding(edingcnc());
  static const RowDialect kPlanet(planetcnc());
  static const RowDialect kMasso(masso());
  static const RowDialect kCentroid(centroid());
  static const std::array<const Dialect*, 7> kAll = {&kMach3,  &kMach4, &kUccnc,   &kEding,
                                                     &kPlanet, &kMasso, &kCentroid};
  return kAll;
}

}  // namespace batten::gcode
