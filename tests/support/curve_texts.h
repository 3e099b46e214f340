// Curves for the tests of curve words: one golden curve with its values, and seeded random ones.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "gcode/reading/parser.h"
#include "geometry/path/bspline_curve.h"

namespace batten::curve_tests {

// Cubic, clamped, not uniform, in the plane: knots 0 0 0 0 0.4 1 1 1 1.
inline geometry::BsplineCurve golden_curve() {
  return {geometry::BsplineBasis::clamped(3, {0, 0.4, 1}),
          {{0, 0, 0}, {10, 0, 0}, {20, 10, 0}, {30, 10, 0}, {40, 0, 0}}};
}

struct GoldenValue {
  double u;
  double x;
  double y;
};

// Its points, computed with the definition of B-splines in exact fractions.
inline constexpr std::array<GoldenValue, 5> kGoldenValues = {{{0.2, 11.25, 2.3},
                                                              {0.4, 18, 6.4},
                                                              {0.55, 22.5625, 8.325},
                                                              {0.7, 27.5, 8.3},
                                                              {0.85, 33.1875, 5.725}}};

// A cubic with 4 to 40 control points whose legs are 0.3 to 8 mm long and turn by up to 40 degrees;
// knots by the lengths of the legs, within a factor of two; some knots are double or triple (a
// corner). The first point has three decimals. In the plane z = -1.5 unless `in_space`.
inline geometry::BsplineCurve random_curve(std::uint32_t seed, bool in_space) {
  std::mt19937 random(seed);
  const auto between = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
  };
  const int count = 4 + static_cast<int>(between(0, 36.99));
  geometry::Point3 place(std::round(between(-2e5, 2e5)) / 1000,
                         std::round(between(-2e5, 2e5)) / 1000, -1.5);
  double heading = between(-3, 3);
  std::vector<geometry::Point3> points = {place};
  std::vector<double> legs;
  for (int i = 1; i < count; ++i) {
    heading += between(-0.7, 0.7);
    legs.push_back(between(0.3, 8));
    const double rise = in_space ? between(-0.5, 0.5) : 0;
    place += legs.back() * geometry::Vector3(std::cos(heading), std::sin(heading), rise);
    points.push_back(place);
  }
  std::vector<double> knots(4, 0.0);
  while (knots.size() < points.size()) {
    const double step = legs[knots.size() - 3] * between(0.7, 1.4);
    const double next = knots.back() + step;
    const auto times = static_cast<std::size_t>(between(0, 1) < 0.1 ? between(2, 3.99) : 1);
    for (std::size_t i = 0; i < times && knots.size() < points.size(); ++i) knots.push_back(next);
  }
  const double last = knots.back() + legs.back();
  for (int i = 0; i < 4; ++i) knots.push_back(last);
  return {geometry::BsplineBasis(3, knots), points};
}

inline gcode::Program parsed(const std::string& text,
                             gcode::Language language = gcode::Language::kRs274) {
  gcode::Diagnostics ignored;
  return gcode::parse(gcode::SourceText("test", text), language, ignored);
}

inline std::string refusal_of(const gcode::CurveResult& result) {
  const auto* refusal = std::get_if<gcode::CurveRefusal>(&result);
  return refusal != nullptr ? refusal->why : "";
}

// Fails where it was refused.
inline gcode::CurveReading reading_of(const gcode::CurveResult& result) {
  EXPECT_EQ(refusal_of(result), "");
  const auto* reading = std::get_if<gcode::CurveReading>(&result);
  return reading != nullptr ? *reading : gcode::CurveReading{};
}

// The curve whose pieces these are, each of which ends where the next one begins.
inline geometry::BsplineCurve curve_of(const std::vector<geometry::CubicBezier>& pieces) {
  std::vector<double> knots(4, 0.0);
  std::vector<geometry::Point3> points = {pieces.front().control[0]};
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    points.insert(points.end(), pieces[i].control + 1, pieces[i].control + 4);
    knots.insert(knots.end(), i + 1 < pieces.size() ? 3 : 4, static_cast<double>(i + 1));
  }
  return {geometry::BsplineBasis(3, knots), points};
}

inline std::string joined(const gcode::CurveLines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

// Lines of a text that ends with a line end.
inline std::uint32_t lines_in(const std::string& text) {
  return static_cast<std::uint32_t>(std::count(text.begin(), text.end(), '\n'));
}

inline gcode::CurveStart starting_at(const geometry::Point3& place,
                                     gcode::Units units = gcode::Units::kMillimetre) {
  return {{place, {true, true, true}}, units};
}

// The lines, or the refusal in their place.
inline std::string text_of(const gcode::CurveWriting& writing) {
  if (const auto* refusal = std::get_if<gcode::CurveRefusal>(&writing)) return refusal->why;
  return joined(std::get<gcode::CurveLines>(writing));
}

inline std::vector<geometry::PathPiece> pieces_of(const gcode::CurveReading& reading) {
  std::vector<geometry::PathPiece> pieces;
  for (const gcode::CurveMotion& motion : reading.motions) pieces.push_back(motion.piece);
  return pieces;
}

// Requires Bezier pieces only; a straight one is turned into one.
inline std::vector<geometry::CubicBezier> beziers_of(const gcode::CurveReading& reading) {
  std::vector<geometry::CubicBezier> pieces;
  for (const gcode::CurveMotion& motion : reading.motions) {
    if (const auto* line = std::get_if<geometry::Line>(&motion.piece)) {
      const geometry::Vector3 third = (line->end - line->start) / 3;
      pieces.push_back({{line->start, line->start + third, line->end - third, line->end}});
    } else {
      pieces.push_back(std::get<geometry::CubicBezier>(motion.piece));
    }
  }
  return pieces;
}

inline std::vector<geometry::PathPiece> pieces_of(const geometry::BsplineCurve& curve) {
  std::vector<geometry::PathPiece> pieces;
  for (const geometry::CubicBezier& piece : curve.bezier_pieces()) pieces.emplace_back(piece);
  return pieces;
}

// "line id" of each alarm, for comparing all at once.
template <typename Alarms>
std::vector<std::string> short_forms(const Alarms& alarms) {
  std::vector<std::string> forms;
  for (const auto& alarm : alarms) {
    forms.push_back(std::to_string(alarm.line) + " " + std::string(alarm.id));
  }
  return forms;
}

}  // namespace batten::curve_tests
