// Controls that run inside a PLC: CODESYS SoftMotion, Beckhoff TwinCAT CNC (the ISG kernel).
// Facts: docs/controllers/plc_family.md.
#include "gcode/controls/built_in.h"

namespace batten::gcode {
namespace {

Control plc(std::string_view name, std::string_view description) {
  Control control;
  control.name = name;
  control.description = description;
  control.places = control.arc_ends = control.centers = {4, 5};
  control.smoothing_off = "";
  return control;
}

// G98 makes I J K places, which the reader does not follow: R is the same under either.
// Parentheses are comments only where the project says so.
Control codesys() {
  Control control =
      plc("codesys", "CODESYS SoftMotion: arcs by R in G17, G18, G19; blanks between words");
  control.arc_form = ArcForm::kRadius;
  control.max_sweep_deg = 90;
  control.comments = CommentStyle::kNone;
  control.other_meanings = {
      {200, "a conditional jump on CODESYS; units are those of the axes (--units)"},
      {210, "no word for millimetres on CODESYS; units are those of the axes (--units)"},
      {980, "absolute arc centres on CODESYS, the end of a cycle to the reader"},
      {990, "relative arc centres on CODESYS, the end of a cycle to the reader"}};
  control.lacks += mode::kUnits;  // no word turns them over
  control.refused = "G40 G43 G49 G80 G94 M6 H T";
  return control;
}

Control beckhoff() {
  Control control = plc(
      "beckhoff", "Beckhoff TwinCAT CNC, ISG kernel: arcs and helices in G17, G18, G19; G70, G71");
  control.max_line_length = 4000;
  control.other_meanings = {{200, "ends mirroring on this control, whose units are G70 and G71"},
                            {210, "mirrors the path on this control, whose units are G70 and G71"}};
  control.smoothing_words = {
      "before-run = [\"#HSC ON [BSPLINE PATH_DEV={tolerance}]\"]  # always with a value: the "
      "default",
      "after-run = [\"#HSC OFF\"]                                 # is 0.2 or 1 mm"};
  control.known_marks = mark(SourceMark::kHashCommand);
  control.refused = "G43 G49 G80 M6 H";
  control.dwell_form = DwellForm::kSecondsX;
  control.own_words = {{"G53", "position unknown"}};  // no work offset, for all blocks behind it
  control.unit_words = {.mm = "G71", .inch = "G70"};  // known for certain
  return control;
}

}  // namespace

std::vector<Control> plc_family() { return {codesys(), beckhoff()}; }

}  // namespace batten::gcode
