#include "geometry/numeric/extrema.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "geometry/basic/require.h"

namespace batten::geometry {
namespace {

// A vector whose angles go round evenly without ever coming back: multiples of the golden
// section for the first plane, of other irrational numbers for the next.
std::vector<double> turning_direction(std::size_t variables, int index) {
  constexpr double kIrrational[] = {0.6180339887498949, 0.4142135623730951, 0.7320508075688772,
                                    0.2360679774997898};
  std::vector<double> direction(variables);
  double square = 0;
  for (std::size_t i = 0; i < variables; ++i) {
    const double turns = (index + 1) * kIrrational[(i / 2) % 4] + 0.25 * static_cast<double>(i % 2);
    direction[i] = std::cos(2 * std::numbers::pi * turns);
    square += direction[i] * direction[i];
  }
  const double length = std::sqrt(square);
  for (double& d : direction) d = length > 0 ? d / length : 1;
  return direction;
}

// The variables' own directions, as many turning ones, and the last move that was a success.
std::vector<std::vector<double>> directions_of_round(std::size_t variables, int round,
                                                     const std::vector<double>& last_move) {
  std::vector<std::vector<double>> directions;
  if (!last_move.empty()) directions.push_back(last_move);
  for (std::size_t i = 0; i < variables; ++i) {
    directions.emplace_back(variables, 0.0);
    directions.back()[i] = 1;
    directions.push_back(
        turning_direction(variables, round * static_cast<int>(variables) + static_cast<int>(i)));
  }
  return directions;
}

}  // namespace

PatternSearchResult pattern_search(const std::function<double(const std::vector<double>&)>& f,
                                   std::vector<double> start, const PatternSearchOptions& options) {
  // Slow enough in narrowing that a narrow valley is met by a turning direction before the
  // steps are too short to follow it.
  constexpr double kNarrower = 0.7;
  constexpr double kWider = 2;
  const std::size_t n = start.size();
  require(options.steps.size() == n && n > 0, "pattern_search: steps",
          static_cast<double>(options.steps.size()), "one for each variable, and one or more");
  PatternSearchResult best{std::move(start), 0, 1};
  best.value = f(best.at);
  std::vector<double> last_move;
  double scale = 1;
  for (int round = 0; scale >= options.finest; ++round) {
    const std::vector<double> center = best.at;
    const double before = best.value;
    std::vector<double> move;
    for (const auto& direction : directions_of_round(n, round, last_move)) {
      for (const double sign : {1.0, -1.0}) {
        if (best.evaluations >= options.max_evaluations) return best;
        std::vector<double> place = center;
        for (std::size_t i = 0; i < n; ++i) {
          place[i] += sign * scale * options.steps[i] * direction[i];
        }
        const double value = f(place);
        ++best.evaluations;
        if (value < best.value) {
          best.at = std::move(place);
          best.value = value;
          move = direction;
        }
      }
    }
    if (best.value < before) {
      last_move = std::move(move);
      scale = std::min(1.0, scale * kWider);
    } else {
      scale *= kNarrower;
    }
  }
  return best;
}

void append_cubic_roots(double c0, double c1, double c2, double c3, double offset,
                        std::vector<double>& places) {
  const auto value = [&](double t) { return c0 + t * (c1 + t * (c2 + t * c3)); };
  // Between these it only rises or only falls: 0, where the derivative c1 + 2 c2 t + 3 c3 t^2 is 0
  // inside, and 1.
  std::array<double, 4> ends{0, 1, 1, 1};
  const double square = c2 * c2 - 3 * c3 * c1;
  if (square >= 0) {
    // The root with the greater absolute value first, so that nothing cancels.
    const double q = -(c2 + std::copysign(std::sqrt(square), c2));
    const auto inside = [](double t) { return t > 0 && t < 1 ? t : 1; };
    if (c3 != 0) ends[1] = inside(q / (3 * c3));
    if (q != 0) ends[2] = inside(c1 / q);
    std::sort(ends.begin(), ends.end());
  }
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    double low = ends[i];
    double high = ends[i + 1];
    const double at_low = value(low);
    const double at_high = value(high);
    if (at_low == 0 && at_high == 0) continue;  // 0 all along, or no length
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
