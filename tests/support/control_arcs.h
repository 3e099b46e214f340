// Random arcs for tests of controls, and the program that a written one makes.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "gcode/state/modal_state.h"
#include "gcode/writer/writer.h"
#include "geometry/path/path.h"

namespace batten::gcode {

inline const Control& named_control(std::string_view name) {
  const Control* found = find_control(name);
  if (found == nullptr) throw std::invalid_argument("no control " + std::string(name));
  return *found;
}

inline ModalState cutting_in(Units units) {
  ModalState modal;
  modal.motion = MotionMode::kLine;
  modal.units = units;
  modal.feed = 1000;
  return modal;
}

// Counter-clockwise seen from the tip of `axis` for a positive sweep.
inline geometry::Arc arc_round(const geometry::Point3& start, const geometry::Point3& center,
                               const geometry::Vector3& axis, double sweep, double rise = 0) {
  const geometry::Vector3 out = start - center - (start - center).dot(axis) * axis;
  const geometry::Vector3 turned = std::cos(sweep) * out + std::sin(sweep) * axis.cross(out);
  return {start, start - out + turned + rise * axis, center, axis, sweep};
}

// As coordinates in arc chains are printed.
inline geometry::Point3 printed_place(const geometry::Point3& place, const Control& control,
                                      Units units) {
  geometry::Point3 printed;
  const double mm = millimetres_per(units);
  for (int i = 0; i < 3; ++i) {
    printed[i] = rounded(place[i] / mm, arc_end_format(control, units).decimals) * mm;
  }
  return printed;
}

// In a plane that the control takes, radii from its least to `max_radius` mm, sweeps from 2 degrees
// to its greatest, both directions, some helical, centres up to 300 mm out; the start is printed.
inline geometry::Arc random_arc_for(const Control& control, Units units, double max_radius,
                                    std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<PlaneAxes> planes;
  for (const PlaneAxes& each : kPlaneAxes) {
    if (takes_arcs_in(control, each.plane)) planes.push_back(each);
  }
  const PlaneAxes& plane = planes.at(
      static_cast<std::size_t>(unit(random) * 0.999 * static_cast<double>(planes.size())));
  const geometry::Vector3 axis =
      geometry::Vector3::Unit(plane.normal) * (unit(random) < 0.5 ? -1 : 1);
  const double least = 1.5 * control.min_radius;
  const double most = std::min(0.99 * control.max_radius, max_radius);
  const double radius = least * std::pow(most / least, unit(random));
  // Not up to a whole half turn: which way that goes depends on the last digit.
  const double greatest = std::min(max_arc_sweep(control), 0.95 * std::numbers::pi);
  const double sweep = (0.035 + (greatest - 0.04) * unit(random)) * (unit(random) < 0.5 ? -1 : 1);
  const bool rises = control.helices && unit(random) < 0.3;
  const geometry::Point3 center =
      300 * geometry::Point3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
  const geometry::Vector3 out(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
  const geometry::Vector3 across = (out - out.dot(axis) * axis).normalized();
  const geometry::Point3 start = printed_place(center + radius * across, control, units);
  return arc_round(start, center, axis, sweep, rises ? radius * (unit(random) - 0.5) : 0);
}

inline Writer arc_writer(const Control& control, const geometry::Point3& start, Units units) {
  Writer out(control, {cutting_in(units), {start, {true, true, true}}}, "\n");
  out.use_coordinates(arc_end_format(control, units));
  return out;
}

// The program that goes to `start` and then runs `text`; exact, whatever the control prints.
inline std::string program_from(const geometry::Point3& start, Units units,
                                const std::string& text) {
  const double mm = millimetres_per(units);
  const auto number = [mm](double value) { return to_text(value / mm, {.decimals = 9}); };
  return std::string(units == Units::kInch ? "G20" : "G21") + " G90 G17\nG0 X" + number(start.x()) +
         " Y" + number(start.y()) + " Z" + number(start.z()) + "\nG1 F1000\n" + text;
}

}  // namespace batten::gcode
