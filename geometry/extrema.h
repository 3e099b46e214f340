// The greatest value of a function of one variable with few extrema.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace batten::geometry {

// Samples per span of a cubic: its distance from a line has two extrema, its derivatives by
// length a few more, so that neighbouring extrema have samples between them.
inline constexpr int kSamplesPerSpan = 32;

struct Extremum {
  double at;
  double value;
};

// Narrows [low, high] around the greatest value of f, which has one maximum there, by golden
// sections: each step keeps 0.618 of the interval.
template <typename Function>
[[nodiscard]] Extremum golden_maximum(const Function& f, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  // 1e-7 of the interval: at a smooth maximum the value is then right to 1e-14 of its change.
  constexpr int kSteps = 34;
  double left = high - kGolden * (high - low);
  double right = low + kGolden * (high - low);
  double at_left = f(left);
  double at_right = f(right);
  for (int i = 0; i < kSteps; ++i) {
    if (at_left >= at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = f(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = f(right);
    }
  }
  return at_left >= at_right ? Extremum{left, at_left} : Extremum{right, at_right};
}

// The greatest value of f on [low, high], ends included: sampled in so many steps, then refined
// around each sample that is no lower than its neighbours and near enough to the highest that
// it may hide more. Where the answer matters only if it is above `floor`, less is refined.
template <typename Function>
[[nodiscard]] Extremum greatest(const Function& f, double low, double high, int steps,
                                double floor = -std::numeric_limits<double>::infinity()) {
  const auto place = [&](int i) { return i == steps ? high : low + (high - low) * i / steps; };
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(steps) + 1);
  for (int i = 0; i <= steps; ++i) values.push_back(f(place(i)));
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  Extremum best{place(static_cast<int>(highest - values.begin())), *highest};
  // Between samples a smooth maximum rises by little of what f rises over its whole way there.
  const double worth = std::max(best.value, floor) - 0.1 * (best.value - *lowest);
  for (int i = 0; i <= steps; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool peak =
        (i == 0 || values[k - 1] <= values[k]) && (i == steps || values[k + 1] <= values[k]);
    if (!peak || values[k] < worth) continue;
    const Extremum refined =
        golden_maximum(f, place(i == 0 ? 0 : i - 1), place(i == steps ? steps : i + 1));
    if (refined.value > best.value) best = refined;
  }
  return best;
}

}  // namespace batten::geometry
