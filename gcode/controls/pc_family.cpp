// Controls that run on a PC or a board of their own and read RS-274/NGC with additions: Mach3,
// Mach4, UCCNC, EdingCNC, PlanetCNC, Masso, Centroid. Facts: docs/controllers/pc_family.md.
#include "gcode/controls/built_in.h"

namespace batten::gcode {
namespace {

// Numbers are doubles; how many digits are kept was not read for any of them but by their posts.
// Half turns and radii to 1000 mm are what posts of these controls allow.
Control pc(std::string_view name, std::string_view description, DecimalsByUnit decimals = {4, 5}) {
  Control control;
  control.name = name;
  control.description = description;
  control.places = control.arc_ends = control.centers = decimals;
  control.max_line_length = 120;  // unknown; no line of ours needs more
  // None of them wraps a path around a cylinder or a face, or fits its own curves by G5.1 or G131.
  control.lacks = mode::kPolarInterpolation + mode::kCylindrical + mode::kControlSmoothing;
  return control;
}

// Whether I J K are offsets is a setting of the control, and G90.1 changes it: R is the same under
// either. Quarter turns at the most, as its centre is the less certain the longer the arc.
Control by_radius(std::string_view name, std::string_view description) {
  Control control = pc(name, description);
  control.arc_form = ArcForm::kRadius;
  control.max_sweep_deg = 90;
  // G51 with a negative factor mirrors: that is scaling. Diameters are a setting.
  control.lacks += mode::kTiltedPlane + mode::kMirror + mode::kLatheDiameter;
  return control;
}

}  // namespace

std::vector<Control> pc_family() {
  Control edingcnc = pc("edingcnc", "EdingCNC: arcs and helices in G17, G18, G19");
  edingcnc.known_marks = mark(SourceMark::kBlendTolerance);

  edingcnc.own_words = {{"MSG", "keeps state"}};  // shown to people

  Control planetcnc = pc("planetcnc", "PlanetCNC: arcs and helices in G17, G18, G19");
  planetcnc.known_marks = mark(SourceMark::kBlendTolerance) | mark(SourceMark::kUniformNurbs) |
                          mark(SourceMark::kSubWords) | mark(SourceMark::kNamedParameters);

  Control centroid =
      pc("centroid", "Centroid: arcs and helices in G17, G18, G19; decimal point always", {3, 4});
  centroid.decimal_point = true;

  return {by_radius("mach3", "Mach3: arcs by R in G17, G18, G19; helices"),
          by_radius("mach4", "Mach4: arcs by R in G17, G18, G19; helices"),
          by_radius("uccnc", "UCCNC: arcs by R in G17, G18, G19; helices"),
          edingcnc,
          planetcnc,
          pc("masso", "Masso: arcs and helices in G17, G18, G19", {3, 4}),
          centroid};
}

}  // namespace batten::gcode
