// Heidenhain programs for tests: read and interpreted, and made of random curves.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "geometry/path/bspline_curve.h"

namespace batten::tests {

struct KlartextProgram {
  explicit KlartextProgram(std::string text, const gcode::CurveFormat* curves = nullptr)
      : program(gcode::parse(gcode::SourceText("part.h", std::move(text)),
                             gcode::Language::kKlartext, found)),
        read(gcode::interpret(program, {.curves = curves}, found)) {}

  // Lines count from 1.
  [[nodiscard]] const gcode::BlockMeaning& line(std::size_t number) const {
    return read.blocks.at(number - 1);
  }
  [[nodiscard]] const gcode::ModalState& state_after(std::size_t number) const {
    return read.states.at(line(number).state_after);
  }
  [[nodiscard]] const gcode::Motion* motion_of(std::size_t number) const {
    const auto motion = line(number).motion;
    return motion < 0 ? nullptr : &read.motions.at(static_cast<std::size_t>(motion));
  }

  gcode::Diagnostics found;
  gcode::Program program;
  gcode::Interpretation read;
};

// Numbers the lines from 0 on; those that begin with a blank belong to the block before.
inline std::string numbered_from_zero(const std::vector<std::string>& lines,
                                      const std::string& line_end = "\n") {
  std::string text;
  int number = 0;
  for (const std::string& line : lines) {
    if (!line.starts_with(' ')) text += std::to_string(number++) + " ";
    text += line + line_end;
  }
  return text;
}

// Chords of a curve that leave it by 0.002 mm, three decimals, as CAM writes them.
inline std::vector<std::string> klartext_chords(const geometry::BsplineCurve& curve) {
  std::vector<double> at = {curve.first()};
  while (at.back() < curve.last()) {
    const double bend = curve.curvature_at(at.back());
    const double step = std::clamp(std::sqrt(8 * 0.002 / std::max(bend, 1e-3)), 0.1, 3.0);
    at.push_back(std::min(at.back() + step, curve.last()));
  }
  std::vector<std::string> lines;
  for (std::size_t i = 1; i < at.size(); ++i) {
    const geometry::Point3 p = curve.point_at(at[i]);
    lines.push_back(fmt::format("L X{:+.3f} Y{:+.3f} Z{:+.3f}", p.x(), p.y(), p.z()));
  }
  return lines;
}

// A whole program: the tool goes to the curve's first place and then along its chords.
inline std::vector<std::string> klartext_program_of(const geometry::BsplineCurve& curve) {
  const geometry::Point3 start = curve.control_points().front();
  std::vector<std::string> lines = {
      "BEGIN PGM WAVE MM",
      "BLK FORM 0.1 Z X-200 Y-200 Z-40",
      "BLK FORM 0.2 X+200 Y+200 Z+0",
      "TOOL CALL 3 Z S12000",
      fmt::format("L X{:+.3f} Y{:+.3f} R0 FMAX M3", start.x(), start.y()),
      "L Z+50 FMAX",
      fmt::format("L Z{:+.3f} R0 F1000", start.z()),
  };
  for (const std::string& line : klartext_chords(curve)) lines.push_back(line);
  for (const char* line : {"L Z+50 R0 FMAX", "M30", "END PGM WAVE MM"}) {
    lines.push_back(line);
  }
  return lines;
}

}  // namespace batten::tests
