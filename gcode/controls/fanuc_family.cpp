// FANUC and the controls that read its curves: Syntec, Mitsubishi. Facts:
// docs/controllers/fanuc.md.
#include "gcode/controls/built_in.h"
#include "gcode/curves/nurbs.h"

namespace batten::gcode {
namespace {

// Least increments of 0.001 mm and 0.0001 inch (IS-B). The point is always written: X5 may be
// five increments (DPI, No. 3401; Mitsubishi: #1078).
Control fanuc_like(std::string_view name, std::string_view description, const CurveFormat& curves) {
  Control control;
  control.name = name;
  control.description = description;
  control.decimal_point = true;
  control.has_increments = true;
  // No manual that was read names the characters of a block; no line of ours needs half of these.
  control.max_line_length = 128;
  control.capital_comments = true;
  // R makes an arc of one radius, which the control has nothing to compare.
  control.arc_form = ArcForm::kShorter;
  control.arc_rule = ArcRule::kFanuc;
  control.max_sweep_deg = 360;
  control.known_marks = mark(SourceMark::kMacroFlow) | mark(SourceMark::kHighSpeedMode);
  control.dwell_form = DwellForm::kSecondsXOrMsP;
  control.curves = &curves;
  // G90.1 and G91.1 are no words for the centres of arcs there, G7 and G8 none for diameters.
  control.lacks = mode::kArcDistance + mode::kLatheDiameter;
  return control;
}

}  // namespace

std::vector<Control> fanuc_family() {
  Control fanuc =
      fanuc_like("fanuc", "FANUC: arcs and helices; G06.2 under --output curves", fanuc_curves());
  const Control syntec =
      fanuc_like("syntec", "Syntec: arcs and helices; G06.2 in G05 P10000 under --output curves",
                 syntec_curves());
  Control mitsubishi = fanuc_like(
      "mitsubishi", "Mitsubishi M700V: arcs and helices; G06.2 in G05 P10000 under --output curves",
      mitsubishi_curves());
  // The tool turns into the tilted plane; the axes are kept out of a zone; to a reference point,
  // and back.
  fanuc.own_words = {{"G53.1", "position unknown"},
                     {"G22", "keeps state"},
                     {"G23", "keeps state"},
                     {"G27", "moves"},
                     {"G29", "moves"}};
  mitsubishi.own_words = fanuc.own_words;
  fanuc.own_words.push_back({"G53.6", "position unknown"});
  return {fanuc, syntec, mitsubishi};
}

}  // namespace batten::gcode
