#include "geometry/chord_height.h"

#include <algorithm>
#include <cmath>

#include "geometry/bezier_halves.h"

namespace batten::geometry {

namespace {

// The distance across the direction in which a piece bows may be this part of its height (squares):
// together they are then half of that part more than the height.
constexpr double kTwist = 1e-4;

// Halves of a piece twist a quarter as much.
constexpr int kHalvings = 6;

// A part of a piece: what lies across the chord, and how far along it.
struct AcrossChord {
  CubicBezier across;
  double along[4];
};

// The part of a piece between two of its own parameters, seen from the start of a chord.
AcrossChord seen_from(const Point3& start, const Vector3& direction, const CubicBezier& piece,
                      double t0, double t1) {
  const Point3* p = piece.control;
  const Vector3 q0 = p[0] - start;
  const Vector3 first = 3 * (p[1] - p[0]);
  const Vector3 second = 3 * (p[2] - p[1]) - first;
  const Vector3 third = (p[3] - p[0]) - first - second;
  const double width = t1 - t0;
  // The same cubic in powers of the part's own parameter.
  const Vector3 d0 = q0 + t0 * (first + t0 * (second + t0 * third));
  const Vector3 d1 = width * (first + t0 * (2 * second + 3 * t0 * third));
  const Vector3 d2 = width * width * (second + 3 * t0 * third);
  const Vector3 d3 = width * width * width * third;
  constexpr double kThird = 1.0 / 3;
  const Vector3 control[4] = {d0, d0 + kThird * d1, d0 + 2 * kThird * d1 + kThird * d2,
                              d0 + d1 + d2 + d3};
  AcrossChord seen;
  for (int i = 0; i < 4; ++i) {
    seen.along[i] = direction.dot(control[i]);
    seen.across.control[i] = control[i] - seen.along[i] * direction;
  }
  return seen;
}

double cubic_at(const double* h, double t) {
  const double s = 1 - t;
  return s * s * (s * h[0] + 3 * t * h[1]) + t * t * (3 * s * h[2] + t * h[3]);
}

// The greatest size of a cubic over [0, 1], by its Bezier coefficients.
double greatest_of(const double* h) {
  double greatest = std::max(std::abs(h[0]), std::abs(h[3]));
  if (std::max(std::abs(h[1]), std::abs(h[2])) <= greatest) return greatest;
  // The slope is a (1-t)^2 + 2 b t (1-t) + c t^2.
  const double a = h[1] - h[0];
  const double b = h[2] - h[1];
  const double c = h[3] - h[2];
  const double square = b * b - a * c;
  if (!(square > 0)) return greatest;
  const double root = std::sqrt(square);
  const double sum = (a - b) + (a >= b ? root : -root);
  const auto look_at = [&](double t) {
    if (t > 0 && t < 1) greatest = std::max(greatest, std::abs(cubic_at(h, t)));
  };
  if (sum != 0) look_at(a / sum);
  const double bend = a - 2 * b + c;
  if (bend != 0) look_at(sum / bend);
  return greatest;
}

// Not less than the greatest square of the piece's size over [0, 1]; what is below `known` need not
// be told from it.
double greatest_square(const CubicBezier& piece, double known, int halvings) {
  const Vector3* o = piece.control;
  const double start = o[0].squaredNorm();
  const double end = o[3].squaredNorm();
  const double hull =
      std::max(std::max(start, end), std::max(o[1].squaredNorm(), o[2].squaredNorm()));
  if (hull <= known || hull == std::max(start, end)) return hull;
  const Vector3 middle = 0.125 * (o[0] + o[3]) + 0.375 * (o[1] + o[2]);
  const double top = middle.squaredNorm();
  const Vector3& bow = top >= std::max(start, end) ? middle : (start >= end ? o[0] : o[3]);
  const double size = bow.norm();
  if (size > 0) {
    const Vector3 up = bow / size;
    const double h[] = {up.dot(o[0]), up.dot(o[1]), up.dot(o[2]), up.dot(o[3])};
    double twist = 0;
    for (int i = 0; i < 4; ++i) twist = std::max(twist, (o[i] - h[i] * up).squaredNorm());
    const double height = greatest_of(h);
    const double square = height * height + twist;
    if (square <= known || twist <= kTwist * height * height) return std::min(square, hull);
    if (halvings == 0) return std::min(square, hull);
  } else if (halvings == 0) {
    return hull;
  }
  const auto [left, right] = halves(piece);
  const double first = greatest_square(left, known, halvings - 1);
  return std::max(first, greatest_square(right, std::max(first, known), halvings - 1));
}

}  // namespace

ChordsFrom::ChordsFrom(const CurvePieces& pieces, double from)
    : pieces_(pieces),
      from_(from),
      first_(pieces.index_of(from)),
      start_(pieces.point_in(first_, from)) {}

// The piece that holds `u`, at or after the first.
std::size_t ChordsFrom::piece_at(double u) const {
  std::size_t piece = first_;
  while (piece + 1 < pieces_.size() && pieces_.breaks()[piece + 1] <= u) ++piece;
  return piece;
}

ChordHeight ChordsFrom::to(double end) const {
  const Vector3 chord = pieces_.point_in(piece_at(end), end) - start_;
  ChordHeight result;
  result.chord = chord.norm();
  result.in_order = result.chord > 0;
  const Vector3 direction = result.in_order ? Vector3(chord / result.chord) : Vector3::Zero();
  double square = 0;
  for (std::size_t i = first_; i < pieces_.size() && pieces_.breaks()[i] < end; ++i) {
    const double t0 = i == first_ ? pieces_.local(i, from_) : 0;
    const double t1 = pieces_.breaks()[i + 1] <= end ? 1 : pieces_.local(i, end);
    const AcrossChord seen = seen_from(start_, direction, pieces_.piece(i), t0, t1);
    const double* a = seen.along;
    result.in_order = result.in_order && a[0] <= a[1] && a[1] <= a[2] && a[2] <= a[3];
    square = std::max(square, greatest_square(seen.across, square, kHalvings));
  }
  result.height = std::sqrt(square);
  return result;
}

bool ChordsFrom::leaves(double end, double distance) const {
  const std::size_t last = piece_at(end);
  const Vector3 chord = pieces_.point_in(last, end) - start_;
  const double squared = chord.squaredNorm();
  const auto is_off = [&](const Point3& place) {
    const Vector3 off = place - start_;
    const double along = off.dot(chord);
    return off.squaredNorm() * squared - along * along > distance * distance * squared;
  };
  for (std::size_t i = first_; i < last; ++i) {
    if (is_off(pieces_.piece(i).control[3])) return true;
  }
  return is_off(pieces_.point_at((from_ + end) / 2));
}

}  // namespace batten::geometry
