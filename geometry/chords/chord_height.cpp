#include "geometry/chords/chord_height.h"

#include <algorithm>
#include <cmath>

#include "geometry/path/bezier_halves.h"

namespace batten::geometry {

namespace {

// The distance across the direction in which a piece bows may be this part of its height (squares):
// together they are then half of that part more than the height.
constexpr double kTwist = 1e-4;

// Halves of a piece twist a quarter as much.
constexpr int kHalvings = 6;

// A coordinate of the piece up to this part of its parameter. De Casteljau's algorithm.
Four restricted(const Four& p, double part) {
  const double a = p[0] + part * (p[1] - p[0]);
  const double b = p[1] + part * (p[2] - p[1]);
  const double c = p[2] + part * (p[3] - p[2]);
  const double ab = a + part * (b - a);
  const double bc = b + part * (c - b);
  return Four::of(p[0], a, ab, ab + part * (bc - ab));
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

Four squares_of(const ControlCoordinates& p) { return p.x * p.x + p.y * p.y + p.z * p.z; }

Point3 point_of(const ControlCoordinates& p, std::size_t i) { return {p.x[i], p.y[i], p.z[i]}; }

// The same for what lies across a chord, where nearly always one look is enough.
double greatest_square(const ControlCoordinates& across, double known) {
  const Four squares = squares_of(across);
  const double ends = std::max(squares[0], squares[3]);
  const double hull = greatest(squares);
  if (hull <= known || hull == ends) return hull;
  const auto middle_of = [](const Four& p) {
    return 0.125 * (p[0] + p[3]) + 0.375 * (p[1] + p[2]);
  };
  Point3 bow{middle_of(across.x), middle_of(across.y), middle_of(across.z)};
  if (bow.squaredNorm() < ends) bow = point_of(across, squares[0] >= squares[3] ? 0 : 3);
  const double size = bow.norm();
  if (size > 0) {
    const Vector3 up = bow / size;
    const Four heights = across.x * up.x() + across.y * up.y() + across.z * up.z();
    const double twist = greatest(squares_of(
        {across.x - heights * up.x(), across.y - heights * up.y(), across.z - heights * up.z()}));
    const double h[] = {heights[0], heights[1], heights[2], heights[3]};
    const double height = greatest_of(h);
    const double square = height * height + twist;
    if (square <= known || twist <= kTwist * height * height) return std::min(square, hull);
  }
  const CubicBezier piece{
      {point_of(across, 0), point_of(across, 1), point_of(across, 2), point_of(across, 3)}};
  return greatest_square(piece, known, kHalvings);
}

}  // namespace

ChordsFrom::ChordsFrom(const CurvePieces& pieces, std::size_t piece_of_start, double from)
    : pieces_(pieces), from_(from), first_(piece_of_start) {
  const double at = pieces.local(first_, from);
  const CubicBezier& piece = pieces.piece(first_);
  const CubicBezier rest = at > 0 ? parts_at(piece, at).second : piece;
  start_ = rest.control[0];
  left_ = 1 - at;
  rest_ = seen_from_start(rest);
}

ControlCoordinates ChordsFrom::seen_from_start(const CubicBezier& piece) const {
  const Point3* p = piece.control;
  return {Four::of(p[0].x(), p[1].x(), p[2].x(), p[3].x()) - start_.x(),
          Four::of(p[0].y(), p[1].y(), p[2].y(), p[3].y()) - start_.y(),
          Four::of(p[0].z(), p[1].z(), p[2].z(), p[3].z()) - start_.z()};
}

// The piece that holds `u`, at or after the first.
std::size_t ChordsFrom::piece_at(double u) const {
  std::size_t piece = first_;
  while (piece + 1 < pieces_.size() && pieces_.breaks()[piece + 1] <= u) ++piece;
  return piece;
}

// Of piece i, what lies between the start and `end`, seen from the start.
ControlCoordinates ChordsFrom::part_before(std::size_t i, double end) const {
  const ControlCoordinates whole = i == first_ ? rest_ : seen_from_start(pieces_.piece(i));
  if (pieces_.breaks()[i + 1] <= end) return whole;
  double part = pieces_.local(i, end);
  if (i == first_) part = left_ > 0 ? std::max(1 - (1 - part) / left_, 0.0) : 0;
  return {restricted(whole.x, part), restricted(whole.y, part), restricted(whole.z, part)};
}

ChordHeight ChordsFrom::to(double end) const {
  std::size_t last = piece_at(end);
  if (last > first_ && pieces_.breaks()[last] >= end) --last;
  const ControlCoordinates ending = part_before(last, end);
  const Vector3 chord = point_of(ending, 3);
  ChordHeight result;
  result.chord = chord.norm();
  result.in_order = result.chord > 0;
  const Vector3 direction = result.in_order ? Vector3(chord / result.chord) : Vector3::Zero();
  double square = 0;
  for (std::size_t i = first_; i <= last; ++i) {
    const ControlCoordinates seen = i == last ? ending : part_before(i, end);
    const Four along = seen.x * direction.x() + seen.y * direction.y() + seen.z * direction.z();
    result.in_order =
        result.in_order && along[0] <= along[1] && along[1] <= along[2] && along[2] <= along[3];
    const ControlCoordinates across{seen.x - along * direction.x(), seen.y - along * direction.y(),
                                    seen.z - along * direction.z()};
    square = std::max(square, greatest_square(across, square));
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
