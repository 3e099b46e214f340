// A program of engraved letters, whose runs begin behind moves that stay as they are.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "geometry/basic/point.h"

namespace batten::postproc {

// Engraved letters: chains of small arcs, each behind a plunge, under a G64 that lets the control
// round the corner between them as far as the moves about it let it.
inline std::string letters() {
  std::string text = "G21 G90 G17 G64\nG0 Z3\n";
  for (int letter = 0; letter < 12; ++letter) {
    geometry::Vector2 at(7 * letter, 0);
    double angle = 0.7 * letter;
    text += fmt::format("G0 X{:.4f} Y0\nG1 F150 Z-1\n", at.x());
    for (int i = 0; i < 6; ++i) {
      const double side = (3 * letter + i * i) % 5 < 2 ? -1 : 1;
      const double radius = 0.4 + 0.37 * ((2 * i + 5 * letter) % 6);
      const double sweep = 0.5 + 0.15 * ((i + letter) % 7);
      const geometry::Vector2 centre =
          radius * side * geometry::Vector2(-std::sin(angle), std::cos(angle));
      angle += side * sweep;
      const geometry::Vector2 end =
          at + centre - radius * side * geometry::Vector2(-std::sin(angle), std::cos(angle));
      text += fmt::format("{} X{:.4f} Y{:.4f} I{:.4f} J{:.4f} F500\n", side > 0 ? "G3" : "G2",
                          end.x(), end.y(), centre.x(), centre.y());
      at = end;
      angle += 0.05 * std::sin(3.7 * (6 * letter + i));  // they do not quite meet tangentially
    }
    text += "G0 Z3\n";
  }
  return text + "M2\n";
}

}  // namespace batten::postproc
