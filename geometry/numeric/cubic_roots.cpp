#include "geometry/numeric/cubic_roots.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace batten::geometry {
namespace {

// 0, the places inside where the derivative c1 + 2 c2 t + 3 c3 t^2 is 0, and 1. The count tells
// how many are used.
struct Stretches {
  std::array<double, 4> ends{0, 1, 1, 1};
  std::size_t count = 1;

  void add(double t) {
    if (t > 0 && t < 1) ends[count++] = t;
  }
};

Stretches monotone_stretches(double c1, double c2, double c3) {
  Stretches found;
  const double square = c2 * c2 - 3 * c3 * c1;
  if (square >= 0) {
    // The root with the greater absolute value first, so that nothing cancels.
    const double q = -(c2 + std::copysign(std::sqrt(square), c2));
    if (c3 != 0) found.add(q / (3 * c3));
    if (q != 0) found.add(c1 / q);
  }
  constexpr std::size_t kWithBothTurns = 3;
  if (found.count == kWithBothTurns && found.ends[1] > found.ends[2]) {
    std::swap(found.ends[1], found.ends[2]);
  }
  found.ends[found.count++] = 1;
  return found;
}

}  // namespace

void append_cubic_roots(double c0, double c1, double c2, double c3, double offset,
                        std::vector<double>& places) {
  const auto value = [&](double t) { return c0 + t * (c1 + t * (c2 + t * c3)); };
  const Stretches stretches = monotone_stretches(c1, c2, c3);
  for (std::size_t i = 0; i + 1 < stretches.count; ++i) {
    double low = stretches.ends[i];
    double high = stretches.ends[i + 1];
    const double at_low = value(low);
    const double at_high = value(high);
    if (at_low == 0 && at_high == 0) continue;  // 0 all along
    if (at_low != 0 && at_high != 0 && (at_low > 0) == (at_high > 0)) continue;
    if (at_low == 0) high = low;
    if (at_high == 0) low = high;
    constexpr int kHalvings = 43;
    for (int k = 0; k < kHalvings && low < high; ++k) {
      const double middle = (low + high) / 2;
      ((value(middle) > 0) == (at_low > 0) ? low : high) = middle;
    }
    places.push_back(offset + (low + high) / 2);
  }
}

}  // namespace batten::geometry
