#include "gcode/curves/curve_print.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>

#include "gcode/state/modal_state.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {

using geometry::CubicBezier;
using geometry::Point3;
using geometry::Vector3;

PlacePrinter::PlacePrinter(const CurveSetting& setting)
    : setting_(setting), unit_(millimetres_per(setting.units)) {}

PrintedPlace PlacePrinter::place(const Point3& mm, bool is_last) const {
  NumberFormat format = setting_.places;
  if (is_last) format.decimals = std::max(format.decimals, setting_.last_decimals);
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

std::optional<PrintedPlace> PlacePrinter::start() const {
  PrintedPlace printed = place(setting_.start, true);
  const Vector3 off = printed.mm - setting_.start;
  if (off.cwiseAbs().maxCoeff() > geometry::kSamePlace) return std::nullopt;
  printed.mm = setting_.start;
  return printed;
}

bool PlacePrinter::starts_at(const Point3& first) const {
  return (first - setting_.start).cwiseAbs().maxCoeff() <=
         printed_step(setting_.places, setting_.units);
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

void add_place(std::string& line, const PrintedPlace& place, const CurveSetting& setting) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (place.digits[axis].empty()) continue;
    add_word(line, kAxisNames[axis] + place.digits[axis], setting);
  }
}

bool is_clamped_cubic(const geometry::BsplineCurve& curve) {
  constexpr std::size_t kOrder = 4;
  const auto& t = curve.basis().knots();
  return curve.degree() == 3 && t[0] == t[kOrder - 1] && t[t.size() - kOrder] == t.back();
}

double greatest_move(std::span<const CubicBezier> a, std::span<const CubicBezier> b) {
  assert(a.size() == b.size());
  double greatest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int j = 0; j < 4; ++j) {
      greatest = std::max(greatest, (a[i].control[j] - b[i].control[j]).norm());
    }
  }
  return greatest;
}

CubicBezier between(const CubicBezier& piece, const Point3& start, const Point3& end) {
  const Point3* p = piece.control;
  return {{start, p[1] + (start - p[0]), p[2] + (end - p[3]), end}};
}

double kink_between(const CubicBezier& before, const CubicBezier& after) {
  const Vector3 arriving = geometry::direction_at(before, 1);
  const Vector3 leaving = geometry::direction_at(after, 0);
  // Zero vectors make both parts zero, and the angle 0.
  return std::atan2(arriving.cross(leaving).norm(), arriving.dot(leaving));
}

namespace {

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

std::vector<CubicBezier> pieces_with(const geometry::BsplineCurve& curve,
                                     std::vector<double> knots) {
  return geometry::BsplineCurve(geometry::BsplineBasis(curve.degree(), std::move(knots)),
                                curve.control_points())
      .bezier_pieces();
}

}  // namespace

std::optional<PrintedKnots> print_knots(const geometry::BsplineCurve& curve,
                                        const KnotDigits& digits, double enough) {
  const std::vector<double> exact = without_noise(curve.basis().knots());
  const std::vector<CubicBezier> wanted = pieces_with(curve, exact);
  std::optional<PrintedKnots> finest;
  const int before_point = digits.digits - digits.decimals;
  // The last knot is 10^places, a number of places + 1 digits. With fewer than 100 steps hardly any
  // curve keeps its shape, and no byte is saved.
  for (int places = std::min(2, digits.digits - 1); places < digits.digits; ++places) {
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
