// The greatest value, and the integral, of a function of one variable with few extrema; the least
// value of one of a few variables; where a cubic polynomial is zero.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace batten::geometry {

// Even places per span of a cubic: its distance from a line has two extrema, its derivatives by
// length a few more, so that neighbouring smooth extrema have places between them.
inline constexpr int kPlacesPerSpan = 16;

struct Extremum {
  double at;
  double value;
};

// 1e-7 of the interval: at a smooth maximum the value is then right to 1e-14 of its change.
inline constexpr int kGoldenSteps = 34;

// Narrows [low, high] around the greatest value of f, which has one maximum there, by golden
// sections: each step keeps 0.618 of the interval.
template <typename Function>
[[nodiscard]] Extremum golden_maximum(const Function& f, double low, double high,
                                      int steps = kGoldenSteps) {
  constexpr double kGolden = 0.6180339887498949;
  double left = high - kGolden * (high - low);
  double right = low + kGolden * (high - low);
  double at_left = f(left);
  double at_right = f(right);
  for (int i = 0; i < steps; ++i) {
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

// `places` and steps + 1 even ones from low to high, in order.
[[nodiscard]] inline std::vector<double> with_even_places(std::vector<double> places, double low,
                                                          double high, int steps) {
  for (int i = 0; i < steps; ++i) places.push_back(low + (high - low) * i / steps);
  places.push_back(high);
  std::sort(places.begin(), places.end());
  return places;
}

// The greatest value of f from the first to the last of `places`, which increase: of f there, and
// refined around each place that is no lower than its neighbours and near enough to the highest
// that it may hide more. A kink or a narrow peak must be among the places to be found surely.
// Where the answer matters only if it is above `floor`, less is refined.
template <typename Function>
[[nodiscard]] Extremum greatest(const Function& f, const std::vector<double>& places,
                                double floor = -std::numeric_limits<double>::infinity()) {
  std::vector<double> values;
  values.reserve(places.size());
  for (const double place : places) values.push_back(f(place));
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  Extremum best{places[static_cast<std::size_t>(highest - values.begin())], *highest};
  // Between places a smooth maximum rises by little of what f rises over its whole way there.
  const double worth = std::max(best.value, floor) - 0.1 * (best.value - *lowest);
  const std::size_t last = places.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const bool peak =
        (i == 0 || values[i - 1] <= values[i]) && (i == last || values[i + 1] <= values[i]);
    if (!peak || values[i] < worth) continue;
    const Extremum refined =
        golden_maximum(f, places[i - (i > 0 ? 1 : 0)], places[i + (i < last ? 1 : 0)]);
    if (refined.value > best.value) best = refined;
  }
  return best;
}

// The integral of f from a to b by Gauss and Legendre's rule with five places: exact for
// polynomials of degree 9.
template <typename Function>
[[nodiscard]] double gauss5(const Function& f, double a, double b) {
  constexpr double kPlace[] = {0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr double kWeight[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const double middle = (a + b) / 2;
  const double half = (b - a) / 2;
  double sum = kWeight[0] * f(middle);
  for (int i = 1; i < 3; ++i) {
    sum += kWeight[i] * (f(middle - half * kPlace[i]) + f(middle + half * kPlace[i]));
  }
  return half * sum;
}

// For functions of a few variables that have kinks and forbidden places.
struct PatternSearchOptions {
  std::vector<double> steps;  // first step of each variable, > 0
  int max_evaluations = 1000;
  double finest = 1e-5;  // ends when the steps are this part of the first ones
};

struct PatternSearchResult {
  std::vector<double> at;
  double value;
  int evaluations;
};

// From `start`, looks around in the directions of the variables and in as many others that turn
// from round to round, so that a valley with a kinked floor is followed; goes to the best place
// if it is better, else shortens the steps. Never gives a worse value than at `start`. The same
// numbers come out every time. (V. Torczon 1997; turning directions: M. Abramson, C. Audet et
// al. 2009, here the simplest of their kind.)
//
// Requires as many steps as variables, one or more.
[[nodiscard]] PatternSearchResult pattern_search(
    const std::function<double(const std::vector<double>&)>& f, std::vector<double> start,
    const PatternSearchOptions& options);

// Appends offset + t for every t in [0, 1] where c0 + c1 t + c2 t^2 + c3 t^3 changes its sign or
// is 0 at an end of an interval on which it only rises or only falls, to about 1e-13 in t. Places
// where it touches 0 without crossing may be missed by rounding. No place at all where every
// coefficient is 0.
void append_cubic_roots(double c0, double c1, double c2, double c3, double offset,
                        std::vector<double>& places);

}  // namespace batten::geometry
