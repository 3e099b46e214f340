// grbl 1.1, its descendants grblHAL and FluidNC, and g2core. Facts: docs/controllers/grbl.md,
// docs/controllers/grbl_family.md.
#include "gcode/controls/built_in.h"
#include "gcode/curves/g5_curve.h"

namespace batten::gcode {
namespace {

// What grbl 1.1 does not have beside units, plane, distance and feed mode: the tables of words of
// its parser know no others. G40, G91.1 and G61 name what is always so.
constexpr ModeSet kBeyondGrbl =
    mode::kAll - mode::kUnits - mode::kPlane - mode::kDistance - mode::kFeedMode;

Control grbl_like(std::string_view name, std::string_view description, SourceMarks marks,
                  std::string_view refused) {
  Control control;
  control.name = name;
  control.description = description;
  control.machine = "router";
  // grbl holds 32-bit numbers (0.00002 mm at 200 mm) and steps of some 0.004 mm, and its serial
  // line is what starves it: the fourth decimal would be sent for nothing. A kink of 0.006 rad,
  // the most that 3 decimals make between arcs of 0.5 mm, allows 1000 mm/s and more by its
  // junction deviation of 0.01 mm.
  control.places = control.arc_ends = {3, 4};
  // One more, so that the radii at the two ends agree to 0.0002 mm, far inside the 0.005 mm
  // that grbl asks for, and the arc lies where the rounded ends say to within their own rounding.
  control.centers = {4, 5};
  // Centres are 32-bit numbers: at 1000 mm they are right to 0.0001 mm, at ten times that to
  // 0.001 mm only, and so are the chords that grbl makes.
  control.max_radius = 1000;
  control.arc_rule = ArcRule::kGrbl;
  control.max_sweep_deg = 350;  // longer arcs are noise away from none in 32 bits
  // ! ~ ? are taken out of the serial stream and obeyed wherever they stand, in comments too; a
  // line that starts with $ is an order.
  control.not_in_comments = "$!~?";
  control.dwell_unit = DwellUnit::kSeconds;
  control.dwell_form = DwellForm::kSecondsP;
  control.chords = {.error = 0.002, .turned = 12};  // $12, N_ARC_CORRECTION
  control.sweep_noise = SweepNoise::kSinglePrecision;
  control.known_marks = marks;
  control.refused = refused;
  control.lacks = kBeyondGrbl;
  return control;
}

constexpr SourceMarks kSettings = mark(SourceMark::kDollarLine);
constexpr SourceMarks kProgramming =
    kSettings | mark(SourceMark::kSubWords) | mark(SourceMark::kNamedParameters);

}  // namespace

std::vector<Control> grbl_family() {
  Control grbl =
      grbl_like("grbl", "grbl 1.1: arcs and helices in G17, G18, G19; lines of 79 characters",
                kSettings, "M6 G43 H");
  // The line buffer is 80 bytes with its terminator, filled after blanks and comments are gone.
  grbl.max_line_length = 79;
  grbl.line_count = LineCount::kWithoutBlanksAndComments;

  // Line buffers of 256 bytes; what of a line counts was not read, so all of it does.
  Control grblhal =
      grbl_like("grblhal", "grblHAL: arcs and helices in G17, G18, G19; lines of 255 characters",
                kProgramming, "");
  grblhal.machine = "grblhal-router";
  grblhal.sweep_noise = SweepNoise::kNone;  // centre and sweep in double precision
  grblhal.curves = &chopped_g5();
  // G51 scales; G66, G7, G96 by how it was built.
  grblhal.lacks -= mode::kScaling + mode::kModalMacro + mode::kSurfaceSpeed + mode::kLatheDiameter;

  // What it refuses was not read of it, nor of g2core.
  const Control fluidnc =
      grbl_like("fluidnc", "FluidNC: arcs and helices in G17, G18, G19; lines of 255 characters",
                kProgramming, "G43 H");

  Control g2core = grbl_like(
      "g2core", "g2core and TinyG: arcs and helices in G17, G18, G19; lines of 250 characters",
      kSettings, "M6 G43 G49 H");
  g2core.machine = "router-unrounded";
  g2core.lacks -= mode::kPath + mode::kArcDistance;  // G61, G61.1, G64; G90.1
  // 255 bytes in one of its line buffers, fewer by the comment in others.
  g2core.max_line_length = 250;
  g2core.arc_rule = ArcRule::kTinyg;
  g2core.sweep_noise = SweepNoise::kNone;  // not read
  g2core.chords = {.error = 0.01};         // $ct; chords of less than 10 ms do not count
  // TinyG asks for radii that agree to 0.1 %: at 0.2 mm that is 0.0002 mm, what the printed
  // offsets can say.
  g2core.min_radius = 0.2;
  g2core.centers = {5, 6};
  g2core.not_in_comments = "$!~%{";

  return {grbl, grblhal, fluidnc, g2core};
}

}  // namespace batten::gcode
