#include "gcode/curves/siemens_poly_words.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace batten::gcode {
namespace {

constexpr std::size_t kMostCoefficients = 5;  // the end and a2 .. a5
constexpr std::array<char, 3> kPolyAxes = {'X', 'Y', 'Z'};

// By the Bernstein coefficients of halves, which hold the polynomial between them.
bool is_positive(std::vector<double> b, int depth) {
  if (std::ranges::all_of(b, [](double value) { return value > 0; })) return true;
  if (!(b.front() > 0) || !(b.back() > 0) || depth == 0) return false;
  std::vector<double> left;
  std::vector<double> right(b.size());
  for (std::size_t n = b.size(); n > 0; --n) {
    left.push_back(b.front());
    right[n - 1] = b[n - 1];
    for (std::size_t i = 0; i + 1 < n; ++i) b[i] = (b[i] + b[i + 1]) / 2;
  }
  return is_positive(std::move(left), depth - 1) && is_positive(std::move(right), depth - 1);
}

double choose(std::size_t n, std::size_t k) {
  double value = 1;
  for (std::size_t i = 1; i <= k; ++i) {
    value *= static_cast<double>(n - k + i) / static_cast<double>(i);
  }
  return value;
}

bool take_axis_word(const SiemensWord& word, PolyWords& sorted) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (word.name == std::string(1, kPolyAxes[axis])) {
      sorted.straight[axis] = &word;
      return true;
    }
    if (word.name == std::string("PO[") + kPolyAxes[axis] + "]") {
      sorted.polynomial[axis] = &word;
      return !word.values.empty() && word.values.size() <= kMostCoefficients;
    }
  }
  return false;
}

}  // namespace

PolyWords poly_words_of(const std::optional<std::vector<SiemensWord>>& words) {
  PolyWords result;
  result.understood = words.has_value();
  if (!words) return result;
  for (const SiemensWord& word : *words) {
    if (word.is("N")) continue;
    if (word.is("POLY")) {
      result.poly = true;
    } else if (word.is("PO[]")) {
      result.denominator = &word;
      if (word.values.empty() || word.values.size() > kMostCoefficients) result.understood = false;
    } else if (word.is("PL") && word.values.size() == 1) {
      result.length = word.value();
    } else if (word.is("F") && word.values.size() == 1) {
      result.feed = word.value();
    } else if (!(word.is("G") && word.value() == 90) && !take_axis_word(word, result)) {
      result.understood = false;
    }
  }
  return result;
}

std::vector<double> polynomial_of(double first, double last, const std::vector<double>& given,
                                  double unit, double length) {
  std::vector<double> a = {first, 0};
  for (std::size_t k = 1; k < given.size(); ++k) a.push_back(given[k] * unit);
  double rest = last - first;
  for (std::size_t k = 2; k < a.size(); ++k) {
    rest -= a[k] * std::pow(length, static_cast<double>(k));
  }
  a[1] = rest / length;
  return a;
}

bool is_positive_until(const std::vector<double>& a, double length) {
  const std::size_t n = a.size() - 1;
  std::vector<double> bernstein(n + 1, 0.0);
  for (std::size_t i = 0; i <= n; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      bernstein[i] += choose(i, k) / choose(n, k) * a[k] * std::pow(length, static_cast<double>(k));
    }
  }
  // After 40 halvings an interval is below the rounding of its ends.
  return is_positive(std::move(bernstein), 40);
}

}  // namespace batten::gcode
