#include "gcode/curves/curve_print.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "gcode/state/modal_state.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {

PlacePrinter::PlacePrinter(const CurveSetting& setting)
    : setting_(setting), unit_(millimetres_per(setting.units)) {}

PrintedPlace PlacePrinter::print(const geometry::Point3& mm, const NumberFormat& format) const {
  PrintedPlace printed;
  printed.mm = setting_.start;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    if (!setting_.axes[i]) continue;
    printed.digits[i] = to_text(mm[axis] / unit_, format);
    printed.mm[axis] = read_number(printed.digits[i])->value * unit_;
  }
  return printed;
}

PrintedPlace PlacePrinter::place(const geometry::Point3& mm) const {
  return print(mm, setting_.places);
}

PrintedPlace PlacePrinter::last_place(const geometry::Point3& mm) const {
  NumberFormat format = setting_.places;
  format.decimals = std::max(format.decimals, setting_.last_decimals);
  return print(mm, format);
}

std::optional<PrintedPlace> PlacePrinter::start() const {
  PrintedPlace printed = last_place(setting_.start);
  const geometry::Vector3 off = printed.mm - setting_.start;
  if (off.cwiseAbs().maxCoeff() > geometry::kSamePlace) return std::nullopt;
  printed.mm = setting_.start;
  return printed;
}

std::string feed_word(const CurveSetting& setting) {
  if (!setting.feed) return {};
  return "F" + to_text(*setting.feed / millimetres_per(setting.units), setting.feeds);
}

void add_word(std::string& line, std::string_view word, const CurveSetting& setting) {
  if (word.empty()) return;
  if (setting.blanks && !line.empty()) line.push_back(' ');
  line += word;
}

namespace {

// With fewer steps hardly any curve keeps its shape, and no byte is saved.
constexpr int kFewestPlaces = 2;

// Knots that differ by rounding noise are one knot.
std::vector<double> without_noise(std::vector<double> knots) {
  const double noise = geometry::kSameKnot * (knots.back() - knots.front());
  for (std::size_t i = 1; i < knots.size(); ++i) {
    if (knots[i] - knots[i - 1] <= noise) knots[i] = knots[i - 1];
  }
  return knots;
}

// The knots in steps of the range; empty where distinct knots would meet.
std::vector<std::int64_t> in_steps(const std::vector<double>& knots, double steps) {
  const double range = knots.back() - knots.front();
  std::vector<std::int64_t> rounded;
  rounded.reserve(knots.size());
  for (std::size_t i = 0; i < knots.size(); ++i) {
    rounded.push_back(std::llround((knots[i] - knots.front()) / range * steps));
    if (i > 0 && knots[i] > knots[i - 1] && rounded[i] <= rounded[i - 1]) return {};
  }
  return rounded;
}

std::vector<geometry::CubicBezier> pieces_with(const geometry::BsplineCurve& curve,
                                               std::vector<double> knots) {
  return geometry::BsplineCurve(geometry::BsplineBasis(curve.degree(), std::move(knots)),
                                curve.control_points())
      .bezier_pieces();
}

}  // namespace

std::optional<PrintedKnots> print_knots(const geometry::BsplineCurve& curve,
                                        const KnotDigits& digits, double enough) {
  const std::vector<double> exact = without_noise(curve.basis().knots());
  const std::vector<geometry::CubicBezier> wanted = pieces_with(curve, exact);
  std::optional<PrintedKnots> finest;
  const int before_point = digits.digits - digits.decimals;
  // The last knot is 10^places, a number of places + 1 digits.
  for (int places = std::min(kFewestPlaces, digits.digits - 1); places < digits.digits; ++places) {
    const std::vector<std::int64_t> rounded = in_steps(exact, std::pow(10.0, places));
    if (rounded.empty()) continue;
    PrintedKnots printed;
    printed.decimals = std::max(0, places + 1 - before_point);
    if (printed.decimals > digits.decimals) break;
    const double step = std::pow(10.0, printed.decimals);
    for (const std::int64_t count : rounded) {
      printed.knots.push_back(static_cast<double>(count) / step);
    }
    printed.move = greatest_move(wanted, pieces_with(curve, printed.knots));
    finest = std::move(printed);
    if (finest->move <= enough) break;
  }
  return finest;
}

}  // namespace batten::gcode
