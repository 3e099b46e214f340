// FANUC and the controls that read its curves: Syntec, Mitsubishi. Facts:
// docs/controllers/fanuc.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "gcode/controls/built_in.h"
#include "gcode/controls/rs274_family.h"
#include "gcode/curves/nurbs.h"
#include "gcode/state/modal_state.h"

namespace batten::gcode {
namespace {

// An arc of less is a matter of the last digit, and one of nearly a full turn of none.
constexpr double kLeastFanucSweep = 0.5 * std::numbers::pi / 180;
constexpr double kGreatestFanucSweep = 350 * std::numbers::pi / 180;

char capital(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

class Fanuc final : public Rs274Dialect {
 public:
  Fanuc(std::string_view name, std::string_view description, const CurveFormat& curves)
      : name_(name), description_(description), curves_(curves) {}

  std::string_view name() const override { return name_; }
  std::string_view description() const override { return description_; }

  // Least increments of 0.001 mm and 0.0001 inch (IS-B). The point is always written: X5 may be
  // five increments.
  NumberFormat coordinates(Units units) const override {
    return {.decimals = units == Units::kInch ? 4 : 3, .always_point = true};
  }
  NumberFormat arc_offsets(Units units) const override { return coordinates(units); }
  NumberFormat feeds(Units) const override { return {.decimals = 6, .always_point = true}; }

  // No manual that was read names the characters of a block; no line of ours needs half of these.
  std::size_t max_line_length() const override { return 128; }

  // The control lets radii differ by a parameter that its builder has set. Two steps of the last
  // digit are what rounding alone can make.
  std::string_view arc_complaint(const geometry::Arc& printed, Units units) const override {
    const EndRadii radii = end_radii(printed);
    const double sweep = std::abs(printed.sweep);
    if (radii.mismatch() > 2 * printed_step(coordinates(units), units)) {
      return "radius at the start differs from radius at the end";
    }
    if (sweep < kLeastFanucSweep) return "arc of less than 0.5 degrees";
    if (sweep > kGreatestFanucSweep) return "arc of more than 350 degrees";
    return {};
  }
  double min_arc_radius() const override { return 0.1; }
  double max_arc_radius() const override { return 1000; }

  // Older controls have no small letters.
  std::string comment(std::string_view text) const override {
    std::string line = Rs274Dialect::comment(text);
    std::ranges::transform(line, line.begin(), &capital);
    return line;
  }

  SourceMarks known_marks() const override {
    return mark(SourceMark::kMacroFlow) | mark(SourceMark::kHighSpeedMode);
  }

  // DPI, No. 3401; Mitsubishi: #1078.
  bool may_imply_decimals() const override { return true; }

  DwellForm dwell_form() const override { return DwellForm::kSecondsXOrMsP; }

  const CurveFormat* curves() const override { return &curves_; }
  std::string_view default_machine() const override { return "mill"; }

 private:
  std::string_view name_;
  std::string_view description_;
  const CurveFormat& curves_;
};

}  // namespace

std::span<const Dialect* const> fanuc_family() {
  static const Fanuc kFanuc("fanuc", "FANUC: arcs and helices; G06.2 under --output curves",
                            fanuc_curves());
  static const Fanuc kSyntec("syntec",
                             "Syntec: arcs and helices; G06.2 in G05 P10000 under --output curves",
                             syntec_curves());
  static const Fanuc kMitsubishi(
      "mitsubishi", "Mitsubishi M700V: arcs and helices; G06.2 in G05 P10000 under --output curves",
      mitsubishi_curves());
  static const std::array<const Dialect*, 3> kAll = {&kFanuc, &kSyntec, &kMitsubishi};
  return kAll;
}

}  // namespace batten::gcode
