// The numbers of curve blocks, printed and as the control will read them.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::gcode {

struct PrintedPlace {
  std::array<std::string, 3> digits;               // empty for axes that are not named
  geometry::Point3 mm = geometry::Point3::Zero();  // as read; axes not named stay at the start
};

// Prints the places of one curve. All of them in the units and axes of its setting.
class PlacePrinter {
 public:
  // The setting must outlive the printer. Throws std::invalid_argument for unknown units.
  explicit PlacePrinter(const CurveSetting& setting);

  // Rounded to the decimals of places; the last place of a curve may have more.
  [[nodiscard]] PrintedPlace place(const geometry::Point3& mm, bool is_last) const;

  // The start, exactly; nothing when that needs more decimals than the last place may have.
  [[nodiscard]] std::optional<PrintedPlace> start() const;

  // Whether the curve's first point is the tool's position, to within a printed step.
  [[nodiscard]] bool starts_at(const geometry::Point3& first) const;

  // Millimetres to one unit of the program.
  [[nodiscard]] double unit() const { return unit_; }

 private:
  const CurveSetting& setting_;
  double unit_;
};

inline constexpr std::array<char, 3> kAxisNames = {'X', 'Y', 'Z'};

// `F3000`, in the units of the setting; empty when no feed is to be said.
[[nodiscard]] std::string feed_word(const CurveSetting& setting);

// Adds `word` to `line`, after a blank where the setting wants one and the line is not empty.
void add_word(std::string& line, std::string_view word, const CurveSetting& setting);

// The words of the axes that are named.
void add_place(std::string& line, const PrintedPlace& place, const CurveSetting& setting);

// Whether the curve is a cubic that starts and ends in its outer control points.
[[nodiscard]] bool is_clamped_cubic(const geometry::BsplineCurve& curve);

// How far two chains are apart at most (mm), pieces taken in pairs at equal parameters: the
// greatest distance of two control points. It bounds the distance of the curves in order, both
// ways, and counts places that slid along the curve as well as those that left it. Requires the
// same number of pieces.
[[nodiscard]] double greatest_move(std::span<const geometry::CubicBezier> a,
                                   std::span<const geometry::CubicBezier> b);

// The piece between two places near its ends, with the same tangents: inner control points move
// with the end that they belong to. So rounding of ends makes no kinks.
[[nodiscard]] geometry::CubicBezier between(const geometry::CubicBezier& piece,
                                            const geometry::Point3& start,
                                            const geometry::Point3& end);

// The angle (radians) between the direction in which `before` arrives and the one in which
// `after` leaves; 0 where one of them has none.
[[nodiscard]] double kink_between(const geometry::CubicBezier& before,
                                  const geometry::CubicBezier& after);

// Knots with few digits. A knot vector may be moved and stretched without changing its curve, so
// knots are scaled to a range that its printed digits resolve before they are rounded.
struct KnotDigits {
  int digits = 9;    // all together
  int decimals = 3;  // of them behind the point
};

struct PrintedKnots {
  std::vector<double> knots;  // from 0, each a number with `decimals` decimals
  int decimals = 0;
  double move = 0;  // mm: how far the curve is from the one with exact knots, by greatest_move
};

// The fewest steps for the whole range, of 100, 1000, .. that keep the curve within `enough` (mm)
// of the one with exact knots; the most steps that the digits allow where none do. Distinct knots
// stay distinct and equal ones equal; nothing where the digits do not allow that. Whole numbers as
// long as the digits before the point suffice. Requires degree 3 or less and a clamped curve.
[[nodiscard]] std::optional<PrintedKnots> print_knots(const geometry::BsplineCurve& curve,
                                                      const KnotDigits& digits, double enough);

}  // namespace batten::gcode
