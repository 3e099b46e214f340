// Heidenhain TNC controls in Klartext. Facts: docs/controllers/heidenhain.md.
#include "gcode/controls/built_in.h"
#include "gcode/curves/heidenhain_spl.h"

namespace batten::gcode {
namespace {

Control klartext(std::string_view name, std::string_view description, const CurveFormat* curves) {
  Control control;
  control.name = name;
  control.description = description;
  control.language = Language::kKlartext;
  control.places = control.arc_ends = control.centers = {4, 5};
  control.comments = CommentStyle::kSemicolon;
  control.planes = {true, false, false};
  control.helices = false;  // CP IPA IZ, not written
  control.repeats_words = true;
  control.arc_rule = ArcRule::kHeidenhain;
  control.curves = curves;
  control.dwell_unit = DwellUnit::kSeconds;
  control.known_marks = kAllMarks;  // they are words of other languages
  control.smoothing_words = {
      "CYCL DEF 32.0 TOLERANCE, CYCL DEF 32.1 T0.02, CYCL DEF 32.2 HSC-MODE:0 TA0.5: how far the "
      "control may round corners (0 finish, 1 rough); its T adds to the deviation"};
  return control;
}

}  // namespace

std::vector<Control> heidenhain_family() {
  return {
      klartext("heidenhain", "Heidenhain TNC 640, 620, 320, iTNC: Klartext, L, CC and C", nullptr),
      klartext("itnc530", "Heidenhain iTNC 530, TNC 426, 430: as heidenhain; SPL",
               &heidenhain_spl())};
}

}  // namespace batten::gcode
