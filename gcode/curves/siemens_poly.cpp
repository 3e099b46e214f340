#include "gcode/curves/siemens_poly.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/curve_print.h"
#include "gcode/state/units.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;

// `PO[X]=(18,-18,6)`: the end and the coefficients of p^2 and p^3, without zeros at the end.
class PolyWord {
 public:
  PolyWord(const CurveSetting& setting, double unit) : setting_(setting), unit_(unit) {}

  [[nodiscard]] std::string text(std::size_t axis, const PrintedPlace& end,
                                 const CubicCoefficients& coefficients) const {
    const auto i = static_cast<int>(axis);
    std::string word = std::string("PO[") + kAxisNames[axis] + "]=(" + end.digits[axis];
    const std::string second = digits(coefficients.a[2][i]);
    const std::string third = digits(coefficients.a[3][i]);
    const bool has_third = !is_zero(third);
    if (has_third || !is_zero(second)) word += "," + second;
    if (has_third) word += "," + third;
    return word + ")";
  }

 private:
  [[nodiscard]] std::string digits(double mm) const { return to_text(mm / unit_, setting_.other); }
  [[nodiscard]] static bool is_zero(const std::string& digits) {
    return digits.find_first_not_of("0.") == std::string::npos;
  }

  const CurveSetting& setting_;
  double unit_;
};

}  // namespace

std::string_view poly_complaint(const ModalState& state) {
  if (state.feed_mode != FeedMode::kPerMinute) return "POLY needs feed per minute (G94)";
  if (state.distance != DistanceMode::kAbsolute) return "POLY is written in G90 only";
  const std::array<std::pair<TriState, std::string_view>, 10> items = {{
      {state.cutter_compensation, "POLY under G41 or G42"},
      {state.polar, "POLY in polar coordinates"},
      {state.cylindrical, "POLY in cylindrical interpolation"},
      {state.tool_center_point, "POLY under TRAORI"},
      {state.tilted_plane, "POLY in a tilted plane"},
      {state.scaling, "POLY under SCALE"},
      {state.rotation, "POLY under ROT"},
      {state.mirror, "POLY under MIRROR"},
      {state.constant_surface_speed, "POLY under constant surface speed"},
      {state.lathe_diameter, "POLY with diameters"},
  }};
  for (const auto& [item, complaint] : items) {
    if (item != TriState::kOff) return complaint;
  }
  return {};
}

CurveWriting write_poly(std::span<const CubicBezier> pieces, const CurveSetting& setting) {
  if (pieces.empty()) return CurveRefusal{"no curve"};
  const PlacePrinter printer(setting);
  const double step = printed_step(setting.places, setting.units);
  if ((pieces.front().control[0] - setting.start).cwiseAbs().maxCoeff() > step) {
    return CurveRefusal{"the curve does not start where the tool stands"};
  }
  const PolyWord word(setting, printer.unit());
  CurveLines lines;
  Point3 place = setting.start;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Point3& wanted = pieces[i].control[3];
    const PrintedPlace end =
        i + 1 < pieces.size() ? printer.place(wanted) : printer.last_place(wanted);
    const CubicCoefficients coefficients = coefficients_of(between(pieces[i], place, end.mm));
    std::string line = i == 0 ? "POLY" : "";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!setting.axes[axis]) continue;
      // A word that starts with a bracketed name needs a blank before it.
      if (!line.empty()) line.push_back(' ');
      line += word.text(axis, end, coefficients);
    }
    if (i == 0 && setting.feed) line += " " + feed_word(setting);
    if (line.size() > kSiemensLine) return CurveRefusal{"a block above 512 characters"};
    lines.push_back(std::move(line));
    place = end.mm;
  }
  return lines;
}

}  // namespace batten::gcode
