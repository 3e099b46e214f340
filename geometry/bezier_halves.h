// A cubic Bezier piece cut in the middle of its parameter, in the plane or in space.
#pragma once

#include <type_traits>
#include <utility>

namespace batten::geometry {

// The two halves, each for t in [0, 1] again. `Cubic` holds four points `control` and nothing
// else. De Casteljau's algorithm at 1/2.
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
