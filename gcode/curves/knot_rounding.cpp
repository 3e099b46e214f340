#include "gcode/curves/knot_rounding.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {
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
