// LinuxCNC 2.9. Facts and measurements: docs/controllers/linuxcnc.md.
#include "gcode/controls/built_in.h"
#include "gcode/curves/g5_curve.h"

namespace batten::gcode {

std::vector<Control> linuxcnc_family() {
  Control control;
  control.name = "linuxcnc";
  control.description = "LinuxCNC 2.9: arcs and helices in G17, G18, G19; lines of 252 characters";
  control.machine = "linuxcnc";

  // Vertices of chords: 0.00009 mm lost in space at the most, a hundredth of the usual tolerance.
  // The angle between chords of 0.3 mm changes by 0.001 rad at the most, far less than the
  // chords turn anyway.
  control.places = {4, 5};

  // LinuxCNC runs through a joint without slowing where kink * speed / servo period stays
  // below a tenth of the acceleration: 1.6e-3 rad at 250 mm/s, 4000 mm/s2 and 1 ms, 2.5e-4 rad
  // at 400 mm/s and 1000 mm/s2. A joint that is rounded across the path by d turns each of its
  // two arcs of length L by 2 d / L. With d = 0.7 steps (half a step on both axes) and
  // L = 0.5 mm the two make 5.6e-3 rad at 3 decimals, 5.6e-4 at 4, 5.6e-5 at 5; so 5, for one byte
  // per word. In inches 6 decimals: 1.4e-4 rad.
  control.arc_ends = {5, 6};

  // The path of an arc of less than a sixth of a turn is known better by R than by a centre, which
  // takes a number more.
  control.arc_form = ArcForm::kShorter;

  // A centre that is off by d turns the ends by d / r at the most: 7e-5 rad at r = 0.1 mm with the
  // decimals of the ends, so no more are needed.
  control.centers = control.arc_ends;

  control.max_line_length = 252;
  control.arc_distance_mode = true;
  control.arc_rule = ArcRule::kLinuxcnc;
  control.max_sweep_deg = 360;

  // Below, rounding of the centre turns the ends by 1.4e-4 rad and more, and the control needs
  // fewer blocks for the one chord or two that such an arc is.
  control.min_radius = 0.05;
  // Flatter arcs are lines to within 0.001 mm over 9 mm; their centres cost digits.
  control.max_radius = 1e4;

  control.dwell_unit = DwellUnit::kSeconds;
  control.dwell_form = DwellForm::kSecondsP;
  control.known_marks = mark(SourceMark::kSubWords) | mark(SourceMark::kNamedParameters) |
                        mark(SourceMark::kBlendTolerance) | mark(SourceMark::kUniformNurbs);
  control.curves = &linuxcnc_g5();
  // Coordinates turn by G10 L2 R, which is an offset and no mode of the text. A user's own remap of
  // G68.2 or G51 is a known word when it stands in the program.
  control.lacks = mode::kToolCenterPoint + mode::kTiltedPlane + mode::kScaling + mode::kRotation +
                  mode::kMirror + mode::kPolar + mode::kPolarInterpolation + mode::kCylindrical +
                  mode::kControlSmoothing + mode::kModalMacro;
  return {control};
}

}  // namespace batten::gcode
