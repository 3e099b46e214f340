// A cubic Bezier piece cut in two, in the plane or in space.
#pragma once

#include <type_traits>
#include <utility>

namespace batten::geometry {

// The two parts before and behind t in ]0, 1[, each for t in [0, 1] again. `Cubic` holds four
// points `control` and nothing else. De Casteljau's algorithm.
template <typename Cubic>
[[nodiscard]] std::pair<Cubic, Cubic> parts_at(const Cubic& piece, double t) {
  const auto& p = piece.control;
  using Point = std::remove_cvref_t<decltype(p[0])>;
  const double s = 1 - t;
  const Point first = s * p[0] + t * p[1];
  const Point second = s * p[1] + t * p[2];
  const Point third = s * p[2] + t * p[3];
  const Point left = s * first + t * second;
  const Point right = s * second + t * third;
  const Point middle = s * left + t * right;
  return {Cubic{{p[0], first, left, middle}}, Cubic{{middle, right, third, p[3]}}};
}

// Cut in the middle of its parameter.
template <typename Cubic>
[[nodiscard]] std::pair<Cubic, Cubic> halves(const Cubic& piece) {
  const auto& p = piece.control;
  using Point = std::remove_cvref_t<decltype(p[0])>;
  const Point first = (p[0] + p[1]) / 2;
  const Point second = (p[1] + p[2]) / 2;
  const Point third = (p[2] + p[3]) / 2;
  const Point left = (first + second) / 2;
  const Point right = (second + third) / 2;
  const Point middle = (left + right) / 2;
  return {Cubic{{p[0], first, left, middle}}, Cubic{{middle, right, third, p[3]}}};
}

}  // namespace batten::geometry
