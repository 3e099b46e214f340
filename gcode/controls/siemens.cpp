// Siemens Sinumerik 840D, 828D, ONE. Facts: docs/controllers/siemens.md.
#include <utility>

#include "gcode/controls/built_in.h"
#include "gcode/curves/siemens_curves.h"

namespace batten::gcode {
namespace {

Control siemens(std::string_view name, std::string_view description, const CurveFormat& curves) {
  Control control;
  control.name = name;
  control.description = description;
  control.language = Language::kSiemens;
  // The control computes to a micrometre by default and reads more.
  control.places = control.arc_ends = control.centers = {4, 5};
  control.max_line_length = 512;
  control.helices = false;  // one of more than a turn wants words of its own (TURN)
  control.arc_rule = ArcRule::kSiemens;
  control.max_sweep_deg = 360;
  control.comments = CommentStyle::kSemicolon;  // parentheses belong to functions there
  control.unit_words = {.mm = "G710", .inch = "G700"};
  control.dwell_form = DwellForm::kSecondsF;
  control.curves = &curves;
  return control;
}

}  // namespace

std::vector<Control> siemens_family() {
  Control poly = siemens("siemens", "Siemens 840D, 828D, ONE: POLY, arcs; lines of 512 characters",
                         siemens_poly());
  poly.curves_in_auto = true;
  return {std::move(poly),
          siemens("siemens-bspline",
                  "as siemens, with BSPLINE under --output curves: not verified, try it first",
                  siemens_bspline())};
}

}  // namespace batten::gcode
