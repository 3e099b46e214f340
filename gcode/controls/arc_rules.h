// When controls refuse an arc, as functions of its printed numbers.
#pragma once

#include <numbers>
#include <optional>
#include <string_view>

#include "gcode/control/control.h"
#include "geometry/path/path.h"

namespace batten::gcode {

struct ArcRuleNumbers {
  static constexpr double kDegree = std::numbers::pi / 180;
  double same_radius = 1e-9;  // part of a radius that was read: what differs by less is noise
  // grbl refuses (error 33) radii that differ by more than the first and by more than either of the
  // others.
  float grbl_mismatch = 0.005F;           // mm
  float grbl_greatest_mismatch = 0.5F;    // mm
  float grbl_relative_mismatch = 0.001F;  // of the radius at the start
  int grbl_digits = 8;                    // that it reads of a number
  // Below, the angle that grbl computes in single precision is mostly noise: of the wrong sign it
  // is a full turn, and near a full turn it is none. On FANUC and Siemens it is a matter of the
  // last digit, too.
  double least_sweep = 0.5 * kDegree;
  double greatest_sweep = 350 * kDegree;
  // LinuxCNC refuses radii that differ by more than the first and the second; never more than the
  // third.
  double linuxcnc_mismatch = 0.0283;         // mm, measured
  double linuxcnc_relative_mismatch = 1e-3;  // of the radius
  double linuxcnc_greatest_mismatch = 2.83;  // mm
  double linuxcnc_least_radius = 0.00127;    // mm, measured: a smaller one is taken for none
  double linuxcnc_least_sweep = 1e-5;        // ten times what it reads as a full turn
  // TinyG: one of two thresholds around which its sources and their comments disagree; refusing by
  // the relative part alone is right in both readings.
  double tinyg_mismatch = 0.001;             // of the radius
  double least_length = 0.01;                // mm: ten times what firmware with chords does not run
  double least_known_sweep = 0.1 * kDegree;  // below, unknown controls go by the last digits
  // The centre is printed next to the bisector of the printed ends: the radii there differ by so
  // many steps of its last decimal at the most (gcode/text/arc_center.h).
  double steps_of_mismatch = 1.5;
  double grbl_full_turn = 5e-7;  // radians: a sweep nearer to 0 gets a full turn
  double count_noise = 1e-5;     // part of the number of chords, computed in single precision
  double certain_count = 2e-5;   // the same, with all that is computed before it
  double of_many_chords = 1.25;  // of the wished error, what arcs of ten chords and more have
};
inline constexpr ArcRuleNumbers kArcRules;

// Why the control is not given the printed arc (end and centre offsets rounded), empty where it is:
// below its least radius, or refused by its rule, or said by numbers that nobody writes.
[[nodiscard]] std::string_view arc_refusal(const Control& control, const geometry::Arc& printed,
                                           Units units);

// mm: how far the chords that the control makes of this arc leave it at most; 0: it makes none.
// Facts: docs/controllers/grbl.md, docs/controllers/printer_family.md.
[[nodiscard]] double chord_error(const ArcChords& chords, const geometry::Arc& arc);
// The same of an arc by its radius, sweep and length (mm, radians, mm).
[[nodiscard]] double chord_error(const ArcChords& chords, double radius, double sweep,
                                 double length);

// How many equal chords the control makes of this arc (0: none), and how far they may be from
// chords with their ends on it; nothing where a last digit decides on their number.
struct CertainChords {
  int count = 0;
  double off = 0;  // mm
};
[[nodiscard]] std::optional<CertainChords> certain_chords(const ArcChords& chords,
                                                          const geometry::Arc& arc);

// What else this control may make of an arc of a source, which was written for another one or by
// somebody who did not know: "no motion", "a full turn"; empty where it runs the arc. Arcs of our
// own are kept far from that by arc_refusal. Facts: docs/controllers/grbl.md.
[[nodiscard]] std::string_view misreading(const Control& control, const geometry::Arc& arc);

// mm: how far they leave arcs of many chords, where that is the same for all radii; infinite where
// it depends on the radius, 0 where there are none.
[[nodiscard]] double usual_chord_error(const ArcChords& chords);

}  // namespace batten::gcode
