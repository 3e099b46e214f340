#include "gcode/curves/nurbs_write.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "gcode/curves/clamped_cubic.h"
#include "gcode/curves/curve_print.h"
#include "gcode/state/units.h"

namespace batten::gcode {
namespace {

using geometry::BsplineCurve;
using geometry::Point3;

constexpr std::size_t kOrder = 4;

// Six digits before the point: what nine digits in the least increment leave in millimetres.
constexpr double kGreatestNurbsPlace = 999999.999;

bool only_named_axes_move(const std::vector<Point3>& points, const CurveSetting& setting) {
  const double step = printed_step(setting.places, setting.units);
  for (const Point3& point : points) {
    for (int axis = 0; axis < 3; ++axis) {
      if (setting.axes[static_cast<std::size_t>(axis)]) continue;
      // Half a step is what printing would take away, too.
      if (std::abs(point[axis] - setting.start[axis]) > step / 2) return false;
    }
  }
  return true;
}

// The words of the control points, without knots; empty when one cannot be printed.
struct Points {
  std::vector<PrintedPlace> printed;
  std::string trouble;
};

Points print_points(const std::vector<Point3>& points, const CurveSetting& setting) {
  const PlacePrinter printer(setting);
  Points result;
  const auto start = printer.start();
  if (!start) {
    result.trouble = "the start has more decimals than the control reads";
    return result;
  }
  result.printed.push_back(*start);
  for (std::size_t i = 1; i < points.size(); ++i) {
    result.printed.push_back(i + 1 < points.size() ? printer.place(points[i])
                                                   : printer.last_place(points[i]));
    if (result.printed.back().mm.cwiseAbs().maxCoeff() > kGreatestNurbsPlace * printer.unit()) {
      result.trouble = "a place beyond 999999.999";
      return result;
    }
  }
  return result;
}

BsplineCurve with_points(const BsplineCurve& curve, const Points& points) {
  std::vector<Point3> places;
  places.reserve(points.printed.size());
  for (const PrintedPlace& place : points.printed) places.push_back(place.mm);
  return {curve.basis(), std::move(places)};
}

class NurbsLines {
 public:
  NurbsLines(const CurveSetting& setting, const NurbsRules& rules, int knot_decimals)
      : setting_(setting), rules_(rules), knots_(setting.other) {
    knots_.decimals = knot_decimals;
  }

  void point(const std::string& opening, double knot, const PrintedPlace& place,
             const std::string& closing) {
    std::string line = opening;
    add_word(line, "K" + to_text(knot, knots_), setting_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (place.digits[axis].empty()) continue;
      add_word(line, kAxisNames[axis] + place.digits[axis], setting_);
    }
    if (rules_.weights) add_word(line, "R" + to_text(1, knots_), setting_);
    add_word(line, closing, setting_);
    lines_.push_back(std::move(line));
  }

  void knot_alone(double knot) { lines_.push_back("K" + to_text(knot, knots_)); }
  void frame(std::string_view text) { lines_.emplace_back(text); }

  [[nodiscard]] CurveLines take() { return std::move(lines_); }

 private:
  const CurveSetting& setting_;
  const NurbsRules& rules_;
  NumberFormat knots_;
  CurveLines lines_;
};

std::string_view trouble_with(const BsplineCurve& curve, const CurveSetting& setting,
                              const NurbsRules& rules) {
  if (!is_clamped_cubic(curve)) return "G06.2 is written for clamped cubic curves only";
  const auto named = std::ranges::count(setting.axes, true);
  if (named == 0) return "no axis is named";
  if (rules.three_axes && named < 3) return "this control's G06.2 names X, Y and Z";
  if (!only_named_axes_move(curve.control_points(), setting))
    return "an axis moves and has no word";
  return {};
}

}  // namespace

CurveWriting write_nurbs(const BsplineCurve& curve, const CurveSetting& setting,
                         const NurbsRules& rules) {
  const std::string_view trouble = trouble_with(curve, setting, rules);
  if (!trouble.empty()) return CurveRefusal{std::string(trouble)};
  const Points points = print_points(curve.control_points(), setting);
  if (!points.trouble.empty()) return CurveRefusal{points.trouble};

  KnotDigits digits = rules.knots;
  if (setting.other.decimals < digits.decimals) {
    digits.digits -= digits.decimals - setting.other.decimals;
    digits.decimals = setting.other.decimals;
  }
  const auto knots =
      print_knots(with_points(curve, points), digits, printed_step(setting.places, setting.units));
  if (!knots) return CurveRefusal{"distinct knots meet when they are rounded"};

  NurbsLines lines(setting, rules, knots->decimals);
  std::string opening = "G06.2";
  add_word(opening, "P4", setting);
  if (rules.framed) lines.frame(kFrameBegin);
  for (std::size_t i = 0; i < points.printed.size(); ++i) {
    const bool first = i == 0;
    lines.point(first ? opening : std::string(), knots->knots[i], points.printed[i],
                first ? feed_word(setting) : std::string());
  }
  for (std::size_t i = 0; i < kOrder; ++i) lines.knot_alone(knots->knots.back());
  if (rules.framed) lines.frame(kFrameEnd);
  return lines.take();
}

}  // namespace batten::gcode
