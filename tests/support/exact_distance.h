// Is the distance of two chains of lines, taken in order and both ways, within a limit? Decided
// without rounding: slow, of its own, and knowing nothing of geometry/distance/path_distance, which
// it is there to check.
//
// The question in words. Two walkers stand at the starts of the two chains and walk to the ends.
// Each goes as fast as he likes, may wait, and never turns back. Can they do it so that they are
// never more than the limit apart? The least limit for which they can is the Fréchet distance.
//
// The answer. Of cell (i, j), edge i of one chain against edge j of the other, the pairs of places
// that are within the limit are a convex set (the distance is a convex function of the pair), so of
// its sides only the free parts matter, and of these where the part that can be reached begins (Alt
// and Godau, Computing the Fréchet distance between two polygonal curves, 1995). The free part of a
// side is where a quadratic with rational coefficients is not above zero: its ends are r + s
// sqrt(d) with rational r and d. Such numbers are compared by squaring until no root is left.
// Everything is a rational of GMP.
#pragma once

#include <gmpxx.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace batten::geometry::exact {

using Rational = mpq_class;

inline Rational ratio(const mpz_class& numerator, const mpz_class& denominator) {
  Rational number(numerator, denominator);
  number.canonicalize();  // as GMP's functions want it
  return number;
}

// Coordinates in thousandths of a millimetre.
using Place = std::array<std::int64_t, 3>;
using Chain = std::vector<Place>;

// r + s sqrt(d); s is -1, 0 or 1, and d is not below zero.
struct RootNumber {
  Rational r;
  int s = 0;
  Rational d = 0;
};

// Of the sign of a + s sqrt(d): -1, 0, 1.
inline int sign_with_root(const Rational& a, int s, const Rational& d) {
  const int of_root = sgn(d) == 0 ? 0 : s;
  const int of_a = sgn(a);
  if (of_root == 0) return of_a;
  if (of_a == 0 || of_a == of_root) return of_root;
  // Opposite signs: the larger square wins.
  const Rational square = a * a;
  return square == d ? 0 : square > d ? of_a : of_root;
}

// -1, 0, 1 for x below, equal to, above y.
inline int compare(const RootNumber& x, const RootNumber& y) {
  const Rational a = x.r - y.r;
  if (x.s == 0 || sgn(x.d) == 0) return sign_with_root(a, -y.s, y.d);
  if (y.s == 0 || sgn(y.d) == 0) return sign_with_root(a, x.s, x.d);
  // The sign of a + u, where u = x.s sqrt(x.d) - y.s sqrt(y.d).
  const int of_u = x.d == y.d && x.s == y.s ? 0 : x.s != y.s ? x.s : x.d > y.d ? x.s : -y.s;
  const int of_a = sgn(a);
  if (of_u == 0) return of_a;
  if (of_a == 0 || of_a == of_u) return of_u;
  // Opposite signs: a^2 against u^2 = x.d + y.d - 2 x.s y.s sqrt(x.d y.d).
  const Rational rest = a * a - x.d - y.d;
  const int larger = sign_with_root(rest, 2 * x.s * y.s > 0 ? 1 : -1, 4 * x.d * y.d);
  return larger == 0 ? 0 : larger > 0 ? of_a : of_u;
}

struct Part {
  RootNumber from;
  RootNumber to;
};

using Side = std::optional<Part>;  // nothing: no place of it is free, or none can be reached

inline Rational dot(const Place& from_a, const Place& to_a, const Place& from_b,
                    const Place& to_b) {
  Rational sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    sum += Rational(to_a[k] - from_a[k]) * Rational(to_b[k] - from_b[k]);
  }
  return sum;
}

// The free part of the edge from `from` to `to` against `place`, in the edge's parameter 0 .. 1.
inline Side free_part(const Place& place, const Place& from, const Place& to,
                      const Rational& limit_squared) {
  // |from + t (to - from) - place|^2 - limit^2 = a t^2 - 2 b t + c.
  const Rational a = dot(from, to, from, to);
  const Rational b = dot(from, to, from, place);
  const Rational c = dot(from, place, from, place) - limit_squared;
  const RootNumber zero{0, 0, 0};
  const RootNumber one{1, 0, 0};
  if (sgn(a) == 0) return sgn(c) > 0 ? Side() : Part{zero, one};
  const Rational quarter = b * b - a * c;
  if (sgn(quarter) < 0) return {};
  const Rational root = quarter / (a * a);
  const RootNumber low{b / a, -1, root};
  const RootNumber high{b / a, 1, root};
  if (compare(high, zero) < 0 || compare(low, one) > 0) return {};
  return Part{compare(low, zero) < 0 ? zero : low, compare(high, one) > 0 ? one : high};
}

inline bool begins_at_zero(const Side& side) {
  return side && compare(side->from, RootNumber{0, 0, 0}) == 0;
}
inline bool ends_at_one(const Side& side) {
  return side && compare(side->to, RootNumber{1, 0, 0}) == 0;
}

// What of a free side can be reached across its cell from the opposite side.
inline Side reached_across(const Side& free, const Side& opposite) {
  if (!free || !opposite) return {};
  const RootNumber& from = compare(free->from, opposite->from) < 0 ? opposite->from : free->from;
  if (compare(from, free->to) > 0) return {};
  return Part{from, free->to};
}

// `limit`: thousandths of a millimetre, not below zero. Two places or more in each chain.
inline bool within(const Chain& one, const Chain& other, const Rational& limit) {
  const Rational squared = limit * limit;
  const auto far = [&](const Place& p, const Place& q) { return dot(p, q, p, q) > squared; };
  if (far(one.front(), other.front()) || far(one.back(), other.back())) return false;
  const std::size_t rows = one.size() - 1;
  const std::size_t columns = other.size() - 1;

  // bottom[j]: vertex i of `one` against edge j of `other`, as far as it can be reached.
  std::vector<Side> bottom(columns);
  for (std::size_t j = 0; j < columns; ++j) {
    const Side free = free_part(one.front(), other[j], other[j + 1], squared);
    if ((j == 0 || ends_at_one(bottom[j - 1])) && begins_at_zero(free)) bottom[j] = free;
  }
  Side border;  // edge i of `one` against the first vertex of `other`
  Side last;    // the same against its last vertex
  for (std::size_t i = 0; i < rows; ++i) {
    const Side up = free_part(other.front(), one[i], one[i + 1], squared);
    const bool goes_on = i == 0 || ends_at_one(border);
    border = goes_on && begins_at_zero(up) ? up : Side();
    Side left = border;
    for (std::size_t j = 0; j < columns; ++j) {
      const Side right = free_part(other[j + 1], one[i], one[i + 1], squared);
      const Side top = free_part(one[i + 1], other[j], other[j + 1], squared);
      const Side reached_right = bottom[j] ? right : reached_across(right, left);
      bottom[j] = left ? top : reached_across(top, bottom[j]);
      left = reached_right;
    }
    last = left;
  }
  return ends_at_one(last) || ends_at_one(bottom.back());
}

}  // namespace batten::geometry::exact
