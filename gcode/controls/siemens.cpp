// Siemens Sinumerik 840D, 828D, ONE. Facts: docs/controllers/siemens.md.
#include <array>
#include <cmath>
#include <numbers>

#include "gcode/controls/built_in.h"
#include "gcode/controls/rs274_family.h"
#include "gcode/curves/siemens_bspline.h"
#include "gcode/curves/siemens_poly.h"
#include "gcode/state/modal_state.h"

namespace batten::gcode {
namespace {

constexpr double kLeastSiemensSweep = 0.5 * std::numbers::pi / 180;
constexpr double kGreatestSiemensSweep = 350 * std::numbers::pi / 180;

class Siemens final : public Rs274Dialect {
 public:
  Siemens(std::string_view name, std::string_view description, const CurveFormat& curves)
      : name_(name), description_(description), curves_(curves) {}

  std::string_view name() const override { return name_; }
  std::string_view description() const override { return description_; }

  Language language() const override { return Language::kSiemens; }

  // The control computes to a micrometre by default and reads more.
  NumberFormat coordinates(Units units) const override {
    return {.decimals = units == Units::kInch ? 5 : 4};
  }
  NumberFormat arc_offsets(Units units) const override { return coordinates(units); }

  std::size_t max_line_length() const override { return 512; }

  // A helix wants words of its own (TURN) where it is more than a turn; it is not written.
  bool takes_helices() const override { return false; }

  // The radii may differ by a machine datum of the builder's. Two steps of the last digit are
  // what rounding alone can make.
  std::string_view arc_complaint(const geometry::Arc& printed, Units units) const override {
    const EndRadii radii = end_radii(printed);
    const double sweep = std::abs(printed.sweep);
    if (radii.mismatch() > 2 * printed_step(coordinates(units), units)) {
      return "radius at the start differs from radius at the end";
    }
    if (sweep < kLeastSiemensSweep) return "arc of less than 0.5 degrees";
    if (sweep > kGreatestSiemensSweep) return "arc of more than 350 degrees";
    return {};
  }
  double min_arc_radius() const override { return 0.1; }
  double max_arc_radius() const override { return 1000; }

  // "; text": parentheses belong to functions there.
  std::string comment(std::string_view text) const override {
    if (Rs274Dialect::comment(text).empty()) return {};
    return "; " + std::string(text);
  }

  SourceMarks known_marks() const override { return 0; }

  const CurveFormat* curves() const override { return &curves_; }
  std::string_view unit_word(Units units) const override {
    return units == Units::kInch ? "G700" : "G710";
  }
  DwellForm dwell_form() const override { return DwellForm::kSecondsF; }
  std::string_view default_machine() const override { return "mill"; }

 private:
  std::string_view name_;
  std::string_view description_;
  const CurveFormat& curves_;
};

}  // namespace

std::span<const Dialect* const> siemens_family() {
  static const Siemens kPoly(
      "siemens", "Siemens 840D, 828D, ONE: POLY, arcs; lines of 512 characters", siemens_poly());
  static const Siemens kBspline(
      "siemens-bspline",
      "as siemens, with BSPLINE under --output curves: not verified, try it first",
      siemens_bspline());
  static const std::array<const Dialect*, 2> kAll = {&kPoly, &kBspline};
  return kAll;
}

}  // namespace batten::gcode
