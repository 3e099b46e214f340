// Four numbers that processors treat two at a time: the same coordinate of the four control points
// of a cubic piece. The results are those of one number after the other.
#pragma once

#include <algorithm>
#include <cstddef>

namespace batten::geometry {

struct Four {
  using Pair = double __attribute__((vector_size(16)));

  Pair low;
  Pair high;

  [[nodiscard]] static Four of(double a, double b, double c, double d) {
    return {Pair{a, b}, Pair{c, d}};
  }
  [[nodiscard]] static Four all(double a) { return {Pair{a, a}, Pair{a, a}}; }

  [[nodiscard]] double operator[](std::size_t i) const { return i < 2 ? low[i] : high[i - 2]; }
};

inline Four operator+(const Four& a, const Four& b) { return {a.low + b.low, a.high + b.high}; }
inline Four operator-(const Four& a, const Four& b) { return {a.low - b.low, a.high - b.high}; }
inline Four operator*(const Four& a, const Four& b) { return {a.low * b.low, a.high * b.high}; }
inline Four operator-(const Four& a, double b) { return a - Four::all(b); }
inline Four operator*(const Four& a, double b) { return a * Four::all(b); }

[[nodiscard]] inline double greatest(const Four& a) {
  return std::max(std::max(a.low[0], a.low[1]), std::max(a.high[0], a.high[1]));
}

}  // namespace batten::geometry
