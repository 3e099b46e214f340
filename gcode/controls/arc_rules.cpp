#include "gcode/controls/arc_rules.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "gcode/curves/heidenhain_spl.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

// The number that grbl reads from these digits: whole digits in 32 bits, times a hundredth and a
// tenth as often as there were decimals, each time in 32 bits.
float read_by_grbl(std::string_view text) {
  const bool negative = text.starts_with('-');
  std::uint32_t digits = 0;
  int count = 0;
  int exponent = 0;
  bool behind_point = false;
  for (const char c : text.substr(negative ? 1 : 0)) {
    if (c == '.') {
      behind_point = true;
      continue;
    }
    if (++count <= kArcRules.grbl_digits) {
      digits = digits * 10 + static_cast<std::uint32_t>(c - '0');
      exponent -= behind_point ? 1 : 0;
    } else {
      exponent += behind_point ? 0 : 1;
    }
  }
  auto value = static_cast<float>(digits);
  if (digits != 0) {
    for (; exponent <= -2; exponent += 2) value *= 0.01F;
    for (; exponent < 0; ++exponent) value *= 0.1F;
    for (; exponent > 0; --exponent) value *= 10.0F;
  }
  return negative ? -value : value;
}

// A coordinate as grbl holds it: read in the program's units, inches then multiplied by 25.4 in 32
// bits.
float held(double mm, Units units) {
  constexpr int kMostDecimals = 9;  // more than any number of ours: further ones are noise
  const double unit = millimetres_per(units);
  return read_by_grbl(to_text(mm / unit, {.decimals = kMostDecimals})) * static_cast<float>(unit);
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
  return mismatch > kArcRules.grbl_mismatch &&
         (mismatch > kArcRules.grbl_greatest_mismatch ||
          mismatch > kArcRules.grbl_relative_mismatch * start_radius);
}

// Whether ends and centre, and each offset between them, are numbers that may be written.
bool is_written(const geometry::Arc& arc, double unit) {
  for (const geometry::Point3& place : {arc.start, arc.end, arc.center}) {
    if (!(place.cwiseAbs().maxCoeff() / unit < kNumberLimit / 2)) return false;
  }
  return true;
}

struct EndRadii {  // mm, in double precision
  double start = 0;
  double end = 0;
  [[nodiscard]] double mismatch() const { return std::abs(end - start); }
};

EndRadii end_radii(const geometry::Arc& arc) {
  const auto across = [&arc](const geometry::Point3& place) {
    const geometry::Vector3 from_center = place - arc.center;
    return (from_center - from_center.dot(arc.axis) * arc.axis).norm();
  };
  return {across(arc.start), across(arc.end)};
}

std::string_view sweep_complaint(const geometry::Arc& printed) {
  const double sweep = std::abs(printed.sweep);
  if (sweep < kArcRules.least_sweep) return "arc of less than 0.5 degrees";
  if (sweep > kArcRules.greatest_sweep) return "arc of more than 350 degrees";
  return {};
}

// mm: of a place on the arc or its centre.
double rounding_in_32_bits(const geometry::Arc& arc) {
  const double greatest = std::max({arc.start.cwiseAbs().maxCoeff(), arc.end.cwiseAbs().maxCoeff(),
                                    arc.center.cwiseAbs().maxCoeff()});
  return greatest * std::numeric_limits<float>::epsilon() / 2;
}

// Whether firmware of this rule computes arcs in single precision, or may on some boards.
bool is_in_32_bits(ArcRule rule) {
  return rule == ArcRule::kGrbl || rule == ArcRule::kTinyg || rule == ArcRule::kUnchecked;
}

// The radii agree as well as the printed digits can say, so that no control of these digits can
// ask for more, and the sweep is no matter of rounding.
std::string_view strictest(const geometry::Arc& printed, Units units, const Control& control) {
  const double step = printed_step(center_format(control, units), units);
  if (end_radii(printed).mismatch() > kArcRules.steps_of_mismatch * step) {
    return "radii at the ends of the arc differ by more than the printed digits";
  }
  if (std::abs(printed.sweep) < kArcRules.least_known_sweep) return "arc of less than 0.1 degrees";
  return {};
}

// Marlin, Klipper, Smoothieware, RepRapFirmware turn about the centre by the angle to the end and
// take the last chord to the end itself. The centre must not print as the start, and the arc must
// be long enough to be run at all.
std::string_view unchecked(const geometry::Arc& printed, Units units, const Control& control) {
  if (end_radii(printed).start * std::abs(printed.sweep) < kArcRules.least_length) {
    return "arc so short that it is not run";
  }
  if (std::abs(printed.sweep) > kArcRules.greatest_sweep) return "arc of more than 350 degrees";
  return strictest(printed, units, control);
}

std::string_view linuxcnc(const geometry::Arc& printed) {
  const EndRadii radii = end_radii(printed);
  const double shorter = std::min(radii.start, radii.end);
  const double allowed = std::min(
      std::max(kArcRules.linuxcnc_mismatch, kArcRules.linuxcnc_relative_mismatch * shorter),
      kArcRules.linuxcnc_greatest_mismatch);
  if (!(shorter > kArcRules.linuxcnc_least_radius)) return "arc with a radius of zero";
  if (radii.mismatch() > allowed) return "radius at the start differs from radius at the end";
  if (std::abs(printed.sweep) < kArcRules.linuxcnc_least_sweep) {
    return "arc so short that it is read as a full turn";
  }
  return {};
}

// The control lets radii differ by a parameter that its builder has set. Two steps of its own last
// digit are what rounding alone can make.
std::string_view two_steps(const geometry::Arc& printed, Units units, DecimalsByUnit own) {
  const int decimals = units == Units::kInch ? own.inch : own.mm;
  if (end_radii(printed).mismatch() > 2 * printed_step({.decimals = decimals}, units)) {
    return "radius at the start differs from radius at the end";
  }
  return sweep_complaint(printed);
}

std::string_view heidenhain(const geometry::Arc& printed, Units units, const Control& control) {
  if (std::abs(printed.axis.z()) < 0.5) return "CC and C are written in the plane of X and Y";
  if (end_radii(printed).mismatch() > kKlartextRadiusMismatch) {
    return "radii at the ends of the arc differ";
  }
  return strictest(printed, units, control);
}

std::string_view complaint(const geometry::Arc& printed, Units units, const Control& control) {
  switch (control.arc_rule) {
    case ArcRule::kUnchecked:
      return unchecked(printed, units, control);
    case ArcRule::kGrbl:
      return radii_differ_in_32_bits(printed, units)
                 ? "error 33: radii at the ends of the arc differ"
                 : sweep_complaint(printed);
    case ArcRule::kTinyg:
      return end_radii(printed).mismatch() > kArcRules.tinyg_mismatch * end_radii(printed).start
                 ? "radii at the ends of the arc differ by more than 0.1 %"
                 : sweep_complaint(printed);
    case ArcRule::kLinuxcnc:
      return linuxcnc(printed);
    case ArcRule::kFanuc:
      return two_steps(printed, units, {3, 4});
    case ArcRule::kSiemens:
      return two_steps(printed, units, {4, 5});
    case ArcRule::kHeidenhain:
      return heidenhain(printed, units, control);
    case ArcRule::kStrictest:
      break;
  }
  return strictest(printed, units, control);
}

// How many equal chords the control wants to make of an arc; infinite: it makes none.
double wished_chords(const ArcChords& chords, double radius, double sweep, double arc_length) {
  double count = std::numeric_limits<double>::infinity();
  if (chords.error > 0) {
    const double half = std::sqrt(std::max(0.0, chords.error * (2 * radius - chords.error)));
    count = half > 0 ? std::abs(sweep) * radius / (2 * half) : 1;
  }
  if (chords.longest > 0) {
    double length = chords.longest;
    if (chords.per_circle > 0) {
      const double wished = 2 * std::numbers::pi * radius / chords.per_circle;
      length = std::clamp(wished, chords.shortest, chords.longest);
    }
    count = std::min(count, arc_length / length);
  }
  return count;
}

// 0: none. In single precision a whole number may come out as the one below.
double chord_count(const ArcChords& chords, double radius, double sweep, double arc_length) {
  const double count = wished_chords(chords, radius, sweep, arc_length);
  return std::isinf(count) ? 0 : std::max(1.0, std::floor((1 - kArcRules.count_noise) * count));
}

// mm: by how much the radius shrinks with each chord that is turned on by the first terms of a
// series: the next one.
double shrinking(double radius, double turn) { return radius * turn * turn * turn * turn / 24; }

}  // namespace

double chord_error(const ArcChords& chords, const geometry::Arc& arc) {
  return chord_error(chords, geometry::radius_of(arc), arc.sweep, geometry::length_of(arc));
}

double chord_error(const ArcChords& chords, double radius, double sweep, double length) {
  const double count = chord_count(chords, radius, sweep, length);
  if (count == 0) return 0;
  const double turn = std::abs(sweep) / count;
  return radius * (1 - std::cos(turn / 2)) +
         std::min(count - 1, chords.turned) * shrinking(radius, turn);
}

std::optional<CertainChords> certain_chords(const ArcChords& chords, const geometry::Arc& arc) {
  constexpr double kMost = 1e4;  // whoever asks for so many is better served by chord_error
  const double radius = geometry::radius_of(arc);
  const double wished = wished_chords(chords, radius, arc.sweep, geometry::length_of(arc));
  if (std::isinf(wished)) return CertainChords{};
  const double sweep_noise = std::numbers::sqrt2 * rounding_in_32_bits(arc) / radius;
  const double noise = (kArcRules.certain_count + sweep_noise / std::abs(arc.sweep)) * wished;
  const double count = std::max(1.0, std::floor(wished - noise));
  if (count > kMost || std::max(1.0, std::floor(wished + noise)) != count) return std::nullopt;
  const double turn = std::abs(arc.sweep) / count;
  return CertainChords{static_cast<int>(count),
                       std::min(count - 1, chords.turned) * shrinking(radius, turn)};
}

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

// By how much the sweep that comes from a rounded centre may be wrong (radians).
double grbl_sweep_noise(const geometry::Arc& arc) {
  return std::numbers::sqrt2 * rounding_in_32_bits(arc) / geometry::radius_of(arc);
}

std::string_view misread_by_grbl(const geometry::Arc& arc) {
  const double sweep = std::abs(arc.sweep);
  const double noise = grbl_sweep_noise(arc);
  const double gap = std::max(0.0, kTurn - sweep);
  if (noise - gap > kArcRules.grbl_full_turn) return "no motion";
  return sweep - noise <= kArcRules.grbl_full_turn ? "a full turn" : "";
}

// As a decimal of nine digits is read.
double as_printed(double mm) {
  constexpr double kSteps = 1e9;
  return std::round(mm * kSteps) / kSteps;
}

// The sweep by Klipper's own computation, number by number, for a plane of X and Y.
std::string_view misread_by_klipper(const geometry::Arc& arc, const ArcChords& chords) {
  const double r_x = -as_printed(arc.center.x() - arc.start.x());
  const double r_y = -as_printed(arc.center.y() - arc.start.y());
  const double x = arc.end.x() - (arc.start.x() - r_x);
  const double y = arc.end.y() - (arc.start.y() - r_y);
  double sweep = std::atan2(r_x * y - r_y * x, r_x * x + r_y * y);
  if (sweep < 0) sweep += kTurn;
  const bool clockwise = arc.sweep * arc.axis.z() < 0;
  if (clockwise) sweep -= kTurn;
  const bool closed = arc.start.head<2>() == arc.end.head<2>();
  if (sweep == 0 && closed) sweep = kTurn;
  const bool is_circle = std::abs(arc.sweep) > kArcRules.greatest_sweep;
  if (std::abs(sweep) < std::abs(arc.sweep) - std::numbers::pi) return "no motion";
  if (std::abs(sweep) > std::abs(arc.sweep) + std::numbers::pi) return "a full turn";
  return is_circle && closed &&
                 chord_count(chords, geometry::radius_of(arc), arc.sweep,
                             geometry::length_of(arc)) == 1
             ? "no motion"
             : "";
}

}  // namespace

std::string_view misreading(const Control& control, const geometry::Arc& arc) {
  switch (control.sweep_noise) {
    case SweepNoise::kSinglePrecision:
      return misread_by_grbl(arc);
    case SweepNoise::kDoublePrecision:
      return misread_by_klipper(arc, control.chords);
    case SweepNoise::kNone:
      break;
  }
  return {};
}

double usual_chord_error(const ArcChords& chords) {
  if (chords.longest > 0) return std::numeric_limits<double>::infinity();
  return kArcRules.of_many_chords * chords.error;
}

std::string_view arc_refusal(const Control& control, const geometry::Arc& printed, Units units) {
  if (!is_written(printed, millimetres_per(units))) return "numbers greater than any control takes";
  const EndRadii radii = end_radii(printed);
  if (!(std::min(radii.start, radii.end) >= control.min_radius * (1 - kArcRules.same_radius))) {
    return "arc radius below the least";
  }
  if (is_in_32_bits(control.arc_rule) &&
      rounding_in_32_bits(printed) > printed_step(arc_end_format(control, units), units) / 2) {
    return "coordinates so great that 32 bits move the centre by more than printing does";
  }
  return complaint(printed, units, control);
}

}  // namespace batten::gcode
