#include "gcode/dialects/arc_rules.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gcode/dialects/rs274_family.h"
#include "gcode/plane_axes.h"

namespace batten::gcode {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// grbl refuses an arc (error 33) whose radii differ by more than kMismatch and by more than
// either of the other two.
constexpr float kMismatch = 0.005F;          // mm
constexpr float kGreatestMismatch = 0.5F;    // mm
constexpr float kRelativeMismatch = 0.001F;  // of the radius at the start

// Below half a degree the angle that grbl computes in single precision is mostly noise, and a
// noisy angle of the wrong sign is a full turn. Near a full turn the same noise makes it none.
constexpr double kLeastSweep = 0.5 * kDegree;
constexpr double kGreatestSweep = 350 * kDegree;

// TinyG: one of two thresholds around which its sources and their comments disagree; refusing by
// the relative part alone is right in both readings.
constexpr double kTinygRelative = 0.001;

// mm: firmware that cuts arcs into chords runs nothing at all below a tenth of this.
constexpr double kLeastLength = 0.01;

// A sweep below this (0.1 degrees) depends on the last printed digits where nothing is known of
// how the control computes.
constexpr double kLeastKnownSweep = 0.1 * kDegree;

// The centre is printed next to the bisector of the printed ends: the radii at the ends then differ
// by 1.5 steps of its last decimal at the most (gcode/arc_center.h).
constexpr double kStepsOfMismatch = 1.5;

// A coordinate as grbl holds it: read into 32 bits in the program's units, inches then
// multiplied by 25.4 in 32 bits.
float held(double mm, Units units) {
  if (units != Units::kInch) return static_cast<float>(mm);
  return static_cast<float>(mm / 25.4) * 25.4F;
}

// The check of grbl's g-code parser, number by number, in 32 bits as on its processor.
bool radii_differ_in_32_bits(const geometry::Arc& arc, Units units) {
  const PlaneAxes* plane = plane_across(arc.axis);
  if (plane == nullptr) return true;
  const int a = plane->first;
  const int b = plane->second;
  const float offset_a = held(arc.center[a] - arc.start[a], units);
  const float offset_b = held(arc.center[b] - arc.start[b], units);
  const float end_a = held(arc.end[a], units) - held(arc.start[a], units) - offset_a;
  const float end_b = held(arc.end[b], units) - held(arc.start[b], units) - offset_b;
  const float start_radius = std::sqrt(offset_a * offset_a + offset_b * offset_b);
  const float end_radius = std::sqrt(end_a * end_a + end_b * end_b);
  const float mismatch = std::abs(end_radius - start_radius);
  return mismatch > kMismatch &&
         (mismatch > kGreatestMismatch || mismatch > kRelativeMismatch * start_radius);
}

// mm
double step_of_centers(Units units, const TargetTable& table) {
  const int decimals = units == Units::kInch ? table.centers.inch : table.centers.mm;
  return printed_step({.decimals = decimals}, units);
}

}  // namespace

std::string_view grbl_arc_rule(const geometry::Arc& printed, Units units,
                               const TargetTable& table) {
  const double sweep = std::abs(printed.sweep);
  if (end_radii(printed).start < table.min_radius) return "arc radius below the least";
  if (radii_differ_in_32_bits(printed, units)) {
    return "error 33: radii at the ends of the arc differ";
  }
  if (sweep < kLeastSweep) return "arc of less than 0.5 degrees";
  if (sweep > kGreatestSweep) return "arc of more than 350 degrees";
  return {};
}

std::string_view tinyg_arc_rule(const geometry::Arc& printed, Units, const TargetTable& table) {
  const EndRadii radii = end_radii(printed);
  const double sweep = std::abs(printed.sweep);
  if (radii.start < table.min_radius) return "arc radius below the least";
  if (radii.mismatch() > kTinygRelative * radii.start) {
    return "radii at the ends of the arc differ by more than 0.1 %";
  }
  if (sweep < kLeastSweep) return "arc of less than 0.5 degrees";
  if (sweep > kGreatestSweep) return "arc of more than 350 degrees";
  return {};
}

std::string_view unchecked_arc_rule(const geometry::Arc& printed, Units units,
                                    const TargetTable& table) {
  if (end_radii(printed).start * std::abs(printed.sweep) < kLeastLength) {
    return "arc so short that it is not run";
  }
  return strictest_arc_rule(printed, units, table);
}

std::string_view strictest_arc_rule(const geometry::Arc& printed, Units units,
                                    const TargetTable& table) {
  const EndRadii radii = end_radii(printed);
  if (std::min(radii.start, radii.end) < table.min_radius) return "arc radius below the least";
  if (radii.mismatch() > kStepsOfMismatch * step_of_centers(units, table)) {
    return "radii at the ends of the arc differ by more than the printed digits";
  }
  if (std::abs(printed.sweep) < kLeastKnownSweep) return "arc of less than 0.1 degrees";
  return {};
}

}  // namespace batten::gcode
