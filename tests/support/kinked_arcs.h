// Programs of arcs as CAM systems write them for curves: each arc goes through the ends and the
// middle of its stretch, so that neighbours meet in kinks.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/plane_curve.h"

namespace batten::tests {

using PlaneCurve = std::function<geometry::Vector2(double)>;  // t from 0 to 1

// The circle through three places, as an arc from the first over the second to the third.
struct ThreePointArc {
  geometry::Vector2 start, end, center;
  bool clockwise = false;
};

inline ThreePointArc arc_through(const geometry::Vector2& a, const geometry::Vector2& b,
                                 const geometry::Vector2& c) {
  const geometry::Vector2 u = b - a;
  const geometry::Vector2 v = c - a;
  const double cross = u.x() * v.y() - u.y() * v.x();
  const double uu = u.squaredNorm();
  const double vv = v.squaredNorm();
  const geometry::Vector2 from_a =
      geometry::Vector2(v.y() * uu - u.y() * vv, u.x() * vv - v.x() * uu) / (2 * cross);
  return {a, c, a + from_a, cross < 0};
}

// Stretches are halved until their arcs are within `deflection` (mm) of the curve.
inline void split_into_arcs(const PlaneCurve& curve, double from, double to, double deflection,
                            std::vector<ThreePointArc>& arcs) {
  const double middle = 0.5 * (from + to);
  const ThreePointArc arc = arc_through(curve(from), curve(middle), curve(to));
  const double radius = (arc.start - arc.center).norm();
  double off = 0;
  constexpr int kParts = 16;
  for (int i = 1; i < kParts; ++i) {
    const double t = from + (to - from) * i / kParts;
    off = std::max(off, std::abs((curve(t) - arc.center).norm() - radius));
  }
  const bool long_way = (arc.end - arc.start).norm() > 1.6 * radius;
  if (off > deflection || long_way) {
    split_into_arcs(curve, from, middle, deflection, arcs);
    split_into_arcs(curve, middle, to, deflection, arcs);
  } else {
    arcs.push_back(arc);
  }
}

struct KinkedArcs {
  int parts = 3;  // of the curve, before they are halved: not a power of two, or all comes out even
  double deflection = 0.01;  // mm
  int decimals = 3;
  double feed = 600;
};

// G2 and G3 blocks along the curve. The tool stands at its start.
inline std::vector<std::string> arc_blocks(const PlaneCurve& curve, const KinkedArcs& options) {
  std::vector<ThreePointArc> arcs;
  for (int i = 0; i < options.parts; ++i) {
    split_into_arcs(curve, static_cast<double>(i) / options.parts,
                    static_cast<double>(i + 1) / options.parts, options.deflection, arcs);
  }
  std::vector<std::string> blocks;
  for (const ThreePointArc& arc : arcs) {
    const geometry::Vector2 offset = arc.center - arc.start;
    blocks.push_back(fmt::format("{} X{:.{}f} Y{:.{}f} I{:.{}f} J{:.{}f} F{}",
                                 arc.clockwise ? "G2" : "G3", arc.end.x(), options.decimals,
                                 arc.end.y(), options.decimals, offset.x(), options.decimals,
                                 offset.y(), options.decimals, options.feed));
  }
  return blocks;
}

inline std::string kinked_arc_program(const PlaneCurve& curve, const KinkedArcs& options = {}) {
  const geometry::Vector2 start = curve(0);
  std::string text = fmt::format("G21 G90 G17\nG0 X{:.{}f} Y{:.{}f} Z5\nG1 Z-1 F300\n", start.x(),
                                 options.decimals, start.y(), options.decimals);
  for (const std::string& block : arc_blocks(curve, options)) text += block + "\n";
  return text + "G0 Z5\nM2\n";
}

// A closed outline whose curvature goes up and down between about 1/60 and 1/6 per mm.
inline geometry::Vector2 three_leaves(double t) {
  const double a = 6.283185307179586 * t;
  const double r = 30 + 6 * std::cos(3 * a) + 1.5 * std::sin(5 * a);
  return {r * std::cos(a), r * std::sin(a)};
}

}  // namespace batten::tests
