// Finishing rows of a known surface, as points and as a program, and how far a path is from it.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/controls/built_in.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "tests/support/paths.h"

namespace batten::geometry {

inline constexpr int kSurfaceRows = 8;     // 0.2 mm apart
inline constexpr int kPlacesPerEdge = 40;  // at which distances are taken

// `noise`: mm, the most that a vertex is moved up or down, its ends excepted.
inline std::vector<std::vector<Point3>> surface_rows(double cam_tolerance, double noise = 0,
                                                     unsigned seed = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> scatter(-noise, noise);
  std::vector<std::vector<Point3>> rows;
  for (int row = 0; row < kSurfaceRows; ++row) {
    rows.push_back(FinishSurface::row(10 + 0.2 * row, cam_tolerance));
    for (std::size_t i = 1; noise > 0 && i + 1 < rows.back().size(); ++i) {
      Point3& p = rows.back()[i];
      p = printed(p + Vector3(0, 0, scatter(random)), 3);
    }
  }
  return rows;
}

// Each row from a rapid down, up again behind it.
inline std::string surface_program(const std::vector<std::vector<Point3>>& rows, double feed) {
  std::string text = "G21 G90 G17\nS12000 M3\nG0 Z20\n";
  for (const auto& row : rows) {
    text += fmt::format("G0 X{:.3f} Y{:.3f}\nG0 Z{:.3f}\n", row[0].x(), row[0].y(), row[0].z());
    for (std::size_t i = 1; i < row.size(); ++i) {
      text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}{}\n", row[i].x(), row[i].y(), row[i].z(),
                          i == 1 ? fmt::format(" F{}", feed) : "");
    }
    text += "G0 Z20\n";
  }
  return text + "M2\n";
}

// Distances from the surface, weighted by the length beside which they were taken.
class SurfaceDistances {
 public:
  void add(double distance, double step) {
    squares_ += distance * distance * step;
    length_ += step;
  }
  void add_polyline(const std::vector<Point3>& points) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const Vector3 chord = points[i + 1] - points[i];
      for (int k = 0; k < kPlacesPerEdge; ++k) {
        add(FinishSurface::distance(points[i] + (k + 0.5) / kPlacesPerEdge * chord),
            chord.norm() / kPlacesPerEdge);
      }
    }
  }
  [[nodiscard]] double rms() const { return std::sqrt(squares_ / length_); }

 private:
  double squares_ = 0;
  double length_ = 0;
};

inline double rms_of_rows(const std::vector<std::vector<Point3>>& rows) {
  SurfaceDistances distances;
  for (const auto& row : rows) distances.add_polyline(row);
  return distances.rms();
}

// Of all cutting moves of a program, with the curve blocks of a target.
inline double rms_of_cuts(const std::string& text, std::string_view target = "linuxcnc") {
  const gcode::SourceText source("rows.nc", text);
  gcode::Diagnostics ignored;
  const gcode::Program program = gcode::parse(source, ignored);
  SurfaceDistances distances;
  gcode::ReadOptions reading;
  reading.curves = gcode::find_control(target)->curves;
  for (const gcode::Motion& motion : gcode::interpret(program, reading, ignored).motions) {
    if (motion.kind == gcode::MotionKind::kRapid) continue;
    const double step = length_of(motion.piece) / kPlacesPerEdge;
    for (int k = 0; k < kPlacesPerEdge; ++k) {
      distances.add(FinishSurface::distance(point_at(motion.piece, (k + 0.5) / kPlacesPerEdge)),
                    step);
    }
  }
  return distances.rms();
}

}  // namespace batten::geometry
