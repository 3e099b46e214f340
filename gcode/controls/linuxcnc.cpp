// LinuxCNC 2.9. Facts and measurements: docs/controllers/linuxcnc.md.
#include <algorithm>
#include <cmath>

#include "gcode/controls/built_in.h"
#include "gcode/controls/rs274_family.h"
#include "gcode/curves/g5_curve.h"

namespace batten::gcode {
namespace {

// The interpreter refuses an arc whose radii differ by more than this (mm, measured) and by
// more than this part of the radius; never more than the last number (mm).
constexpr double kRadiusMismatch = 0.0283;
constexpr double kRelativeCenterError = 1e-3;
constexpr double kGreatestCenterError = 2.83;

// The interpreter takes an arc of a smaller radius (mm, measured) for one of none.
constexpr double kLeastLinuxcncRadius = 0.00127;

// Sweeps below 1e-6 rad are read as a full turn. Ten times that keeps clear of rounding.
constexpr double kLeastLinuxcncSweep = 1e-5;

class LinuxCnc final : public Rs274Dialect {
 public:
  std::string_view name() const override { return "linuxcnc"; }
  std::string_view description() const override {
    return "LinuxCNC 2.9: arcs and helices in G17, G18, G19; lines of 252 characters";
  }

  // Vertices of chords: 0.00009 mm lost in space at the most, a hundredth of the usual tolerance.
  // The angle between chords of 0.3 mm changes by 0.001 rad at the most, far less than the
  // chords turn anyway.
  NumberFormat coordinates(Units units) const override {
    return {.decimals = units == Units::kInch ? 5 : 4};
  }

  // LinuxCNC runs through a joint without slowing where kink * speed / servo period stays
  // below a tenth of the acceleration: 1.6e-3 rad at 250 mm/s, 4000 mm/s2 and 1 ms, 2.5e-4 rad
  // at 400 mm/s and 1000 mm/s2. A joint that is rounded across the path by d turns each of its
  // two arcs of length L by 2 d / L. With d = 0.7 steps (half a step on both axes) and
  // L = 0.5 mm the two make 5.6e-3 rad at 3 decimals, 5.6e-4 at 4, 5.6e-5 at 5; so 5, for one byte
  // per word. In inches 6 decimals: 1.4e-4 rad.
  NumberFormat arc_ends(Units units) const override {
    return {.decimals = units == Units::kInch ? 6 : 5};
  }

  // A centre that is off by d turns the ends by d / r at the most: 7e-5 rad at r = 0.1 mm with the
  // decimals of the ends, so no more are needed.
  NumberFormat arc_offsets(Units units) const override { return arc_ends(units); }

  std::size_t max_line_length() const override { return 252; }
  bool takes_arc_distance_mode() const override { return true; }

  std::string_view arc_complaint(const geometry::Arc& printed, Units) const override {
    const EndRadii radii = end_radii(printed);
    const double shorter = std::min(radii.start, radii.end);
    const double allowed =
        std::min(std::max(kRadiusMismatch, kRelativeCenterError * shorter), kGreatestCenterError);
    if (!(shorter > kLeastLinuxcncRadius)) return "arc with a radius of zero";
    if (radii.mismatch() > allowed) return "radius at the start differs from radius at the end";
    if (std::abs(printed.sweep) < kLeastLinuxcncSweep)
      return "arc so short that it is read as a full turn";
    return {};
  }

  // Below, rounding of the centre turns the ends by 1.4e-4 rad and more, and the control needs
  // fewer blocks for the one chord or two that such an arc is.
  double min_arc_radius() const override { return 0.05; }
  // Flatter arcs are lines to within 0.001 mm over 9 mm; their centres cost digits.
  double max_arc_radius() const override { return 1e4; }

  DwellUnit dwell_unit() const override { return DwellUnit::kSeconds; }
  DwellForm dwell_form() const override { return DwellForm::kSecondsP; }

  SourceMarks known_marks() const override {
    return mark(SourceMark::kSubWords) | mark(SourceMark::kNamedParameters) |
           mark(SourceMark::kBlendTolerance) | mark(SourceMark::kUniformNurbs);
  }

  const CurveFormat* curves() const override { return &linuxcnc_g5(); }

  std::string_view default_machine() const override { return "linuxcnc"; }
};

}  // namespace

const Dialect& linuxcnc_dialect() {
  static const LinuxCnc kDialect;
  return kDialect;
}

}  // namespace batten::gcode
