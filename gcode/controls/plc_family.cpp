// Controls that run inside a PLC: CODESYS SoftMotion, Beckhoff TwinCAT CNC (the ISG kernel).
// Facts: docs/controllers/plc_family.md.
#include <array>

#include "gcode/controls/built_in.h"
#include "gcode/controls/row_dialect.h"

namespace batten::gcode {
namespace {

TargetTable plc_table(std::string_view name, std::string_view description) {
  TargetTable table;
  table.name = name;
  table.description = description;
  table.places = {4, 5};
  table.arc_ends = {4, 5};
  table.centers = {4, 5};
  table.max_sweep_deg = 180;
  table.max_radius = 1000;
  return table;
}

constexpr std::array kCodesysMeanings = {
    OtherMeaning{200, "a conditional jump on CODESYS; units are those of the axes (--units)"},
    OtherMeaning{210, "no word for millimetres on CODESYS; units are those of the axes (--units)"},
    OtherMeaning{980, "absolute arc centres on CODESYS, the end of a cycle to the reader"},
    OtherMeaning{990, "relative arc centres on CODESYS, the end of a cycle to the reader"}};

// G98 makes I J K places, which the reader does not follow: R is the same under either.
// Parentheses are comments only where the project says so.
TargetRow codesys() {
  TargetTable table =
      plc_table("codesys", "CODESYS SoftMotion: arcs by R in G17, G18, G19; blanks between words");
  table.arc_form = ArcForm::kRadius;
  table.max_sweep_deg = 90;
  table.comments = CommentStyle::kNone;
  TargetRow row{table};
  row.other_meanings = kCodesysMeanings;
  row.refused = "G40 G43 G49 G80 G94 M6 H T";
  return row;
}

constexpr std::array kBeckhoffMeanings = {
    OtherMeaning{200, "ends mirroring on this control, whose units are G70 and G71"},
    OtherMeaning{210, "mirrors the path on this control, whose units are G70 and G71"}};

constexpr std::array<std::string_view, 2> kBeckhoffSmoothing = {
    "before-run = [\"#HSC ON [BSPLINE PATH_DEV={tolerance}]\"]  # always with a value: the default",
    "after-run = [\"#HSC OFF\"]                                 # is 0.2 or 1 mm"};

TargetRow beckhoff() {
  TargetTable table = plc_table(
      "beckhoff", "Beckhoff TwinCAT CNC, ISG kernel: arcs and helices in G17, G18, G19; G70, G71");
  table.max_line_length = 4000;
  TargetRow row{table};
  row.other_meanings = kBeckhoffMeanings;
  row.smoothing_words = kBeckhoffSmoothing;
  row.known_marks = mark(SourceMark::kHashCommand);
  row.refused = "G43 G49 G80 M6 H";
  row.dwell_form = DwellForm::kSecondsX;
  row.units_by_g70 = true;
  return row;
}

}  // namespace

std::span<const Dialect* const> plc_family() {
  static const RowDialect kCodesys(codesys());
  static const RowDialect kBeckhoff(beckhoff());
  static const std::array<const Dialect*, 2> kAll = {&kCodesys, &kBeckhoff};
  return kAll;
}

}  // namespace batten::gcode
