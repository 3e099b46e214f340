#include "geometry/chords/chord_proof.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/basic/operations.h"
#include "geometry/path/cubic_polynomial.h"

namespace batten::geometry {

StraightLine::StraightLine(const Point3& start, const Point3& end)
    : start_(start), length_((end - start).norm()) {
  if (length_ > 0) along_ = (end - start) / length_;
}

double StraightLine::foot(const Point3& p) const {
  return std::clamp(along_.dot(p - start_), 0.0, length_);
}

Vector3 StraightLine::off(const Point3& p) const {
  return p - start_ - along_.dot(p - start_) * along_;
}

double StraightLine::squared_distance(const Point3& p, double at) const {
  return (p - start_ - at * along_).squaredNorm();
}

namespace {

// A bend and a second one the other way have their tops; what is left after these cuts is due to
// the twist of a curve in space, and there halves do better.
constexpr int kCutsAtTheTop = 2;

}  // namespace

ChordProof::ChordProof(const Point3& start, const Point3& end, double deviation, int cuts)
    : line_(start, end), allowed_(deviation * deviation), cuts_(cuts) {}

bool ChordProof::holds(const CubicBezier& piece, int cuts) {
  double at = reached_;
  const bool near = std::ranges::all_of(piece.control, [&](const Point3& control) {
    at = std::max(at, line_.foot(control));
    return line_.squared_distance(control, at) <= allowed_;
  });
  if (near) {
    reached_ = at;
    return true;
  }
  // The ends are points of the curve itself: too far from the chord, and no cut will help.
  const auto is_off = [this](const Point3& p) { return line_.squared_distance(p) > allowed_; };
  if (cuts == 0 || is_off(piece.control[0]) || is_off(piece.control[3])) return false;
  const bool early = cuts + kCutsAtTheTop > cuts_;
  const auto [left, right] = early ? parts_at(piece, farthest(piece)) : halves(piece);
  return holds(left, cuts - 1) && holds(right, cuts - 1);
}

// Where the piece runs along the chord at its greatest height, seen in the direction of its bow.
// The middle where there is no such place well inside.
double ChordProof::farthest(const CubicBezier& piece) const {
  constexpr double kMiddle = 0.5;
  constexpr double kInside = 0.02;
  const Vector3 off[] = {line_.off(piece.control[0]), line_.off(piece.control[1]),
                         line_.off(piece.control[2]), line_.off(piece.control[3])};
  const Vector3 bow = off[1] + off[2] - off[0] - off[3];
  const double heights[] = {bow.dot(off[0]), bow.dot(off[1]), bow.dot(off[2]), bow.dot(off[3])};
  // The slope is a (1-t)^2 + 2 b t (1-t) + c t^2; of its two zeros the bow's top is where it falls.
  const double a = heights[1] - heights[0];
  const double b = heights[2] - heights[1];
  const double c = heights[3] - heights[2];
  const double square = b * b - a * c;
  if (!(square > 0)) return kMiddle;
  const double t = a / (a - b + std::sqrt(square));
  return t > kInside && t < 1 - kInside ? t : kMiddle;
}

bool chord_proved(const CurvePieces& pieces, double from, double to, ChordProof proof) {
  if (!(from < to)) return true;
  for (std::size_t i = pieces.index_of(from); i < pieces.size() && pieces.breaks()[i] < to; ++i) {
    if (!proof.holds(pieces.part(i, from, to))) return false;
  }
  return true;
}

namespace {

using Eigen::Array4d;

// A bound is sharp when it is too great by less than this part. Each halving of a Bezier piece
// quarters what its bound has too much, so twenty are enough.
constexpr double kSharp = 1e-12;
constexpr int kHalvings = 20;

// The doubles of a piece's parameter are used up after so many halvings.
constexpr int kAllHalvings = 50;

// Rounding of a distance, as a part of the coordinates.
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();

// The greatest of the control points' squared distances. The distance from a convex set is a convex
// function: on the piece it is at most that.
template <typename Squared>
double bound(const CubicBezier& piece, const Squared& squared) {
  double farthest = 0;
  for (const Point3& p : piece.control) farthest = std::max(farthest, squared(p));
  return farthest;
}

// `greatest`: raised to the greatest squared distance of the piece from the chord.
void raise_to(const CubicBezier& piece, const StraightLine& chord, int halvings, double& greatest) {
  const auto squared = [&chord](const Point3& p) { return chord.squared_distance(p); };
  greatest = std::max({greatest, squared(piece.control[0]), squared(piece.control[3])});
  const double noise = kRounding * piece.control[0].cwiseAbs().maxCoeff();
  const double open = 2 * greatest * kSharp + 2 * std::sqrt(greatest) * noise + noise * noise;
  if (halvings == 0 || bound(piece, squared) <= greatest + open) return;
  const auto [left, right] = halves(piece);
  raise_to(left, chord, halvings - 1, greatest);
  raise_to(right, chord, halvings - 1, greatest);
}

// The first t of the piece where the squared distance from the line is reached.
std::optional<double> first_at(const CubicBezier& piece, const StraightLine& line, double squared,
                               int halvings) {
  if (bound(piece, [&line](const Point3& p) { return line.off(p).squaredNorm(); }) < squared) {
    return std::nullopt;
  }
  if (halvings == 0) return 0.5;
  const auto [left, right] = halves(piece);
  if (const auto t = first_at(left, line, squared, halvings - 1)) return *t / 2;
  if (const auto t = first_at(right, line, squared, halvings - 1)) return (1 + *t) / 2;
  return std::nullopt;
}

}  // namespace

double chord_deviation(const CurvePieces& pieces, double from, double to) {
  const StraightLine chord(pieces.point_at(from), pieces.point_at(to));
  double greatest = 0;
  for (std::size_t i = pieces.index_of(from); i < pieces.size() && pieces.breaks()[i] < to; ++i) {
    raise_to(pieces.part(i, from, to), chord, kHalvings, greatest);
  }
  return std::sqrt(greatest);
}

BesideCurve line_beside(const CurvePieces& pieces, double from, double to, const Line& line) {
  const Vector3 left = left_of(line.end - line.start);
  BesideCurve beside;
  for (std::size_t i = pieces.index_of(from); i < pieces.size() && pieces.breaks()[i] < to; ++i) {
    const CubicPolynomial piece(pieces.part(i, from, to), line.start);
    std::vector<double> places = {0, 1};
    piece.append_extrema(left, 0, places);
    for (const double t : places) {
      const double curve_to_left = piece.value(t).dot(left);
      beside.left = std::max(beside.left, -curve_to_left);
      beside.right = std::max(beside.right, curve_to_left);
    }
  }
  return beside;
}

double leaves_tangent_at(const CurvePieces& pieces, double from, double to, double distance) {
  const Point3 foot = pieces.point_at(from);
  const StraightLine tangent(foot, foot + pieces.leaving(from));
  for (std::size_t i = pieces.index_of(from); i < pieces.size() && pieces.breaks()[i] < to; ++i) {
    const double start = std::max(from, pieces.breaks()[i]);
    const double end = std::min(to, pieces.breaks()[i + 1]);
    const auto t = first_at(pieces.part(i, from, to), tangent, distance * distance, kAllHalvings);
    if (t) return std::min(start + *t * (end - start), to);
  }
  return to;
}

namespace {

// The distance across the direction in which a piece bows may be this part of its height (squares):
// together they are then half of that part more than the height.
constexpr double kTwist = 1e-4;

// Halves of a piece twist a quarter as much.
constexpr int kTwistHalvings = 6;

[[gnu::always_inline]] inline ControlCoordinates seen_from(const Point3& origin,
                                                           const CubicBezier& piece) {
  const Point3* p = piece.control;
  return {Array4d(p[0].x(), p[1].x(), p[2].x(), p[3].x()) - origin.x(),
          Array4d(p[0].y(), p[1].y(), p[2].y(), p[3].y()) - origin.y(),
          Array4d(p[0].z(), p[1].z(), p[2].z(), p[3].z()) - origin.z()};
}

// The piece up to this part of its parameter. De Casteljau's algorithm.
[[gnu::always_inline]] inline ControlCoordinates restricted(const ControlCoordinates& piece,
                                                            double part) {
  const auto one = [part](const Array4d& p) {
    const double a = p[0] + part * (p[1] - p[0]);
    const double b = p[1] + part * (p[2] - p[1]);
    const double c = p[2] + part * (p[3] - p[2]);
    const double ab = a + part * (b - a);
    const double bc = b + part * (c - b);
    return Array4d(p[0], a, ab, ab + part * (bc - ab));
  };
  return {one(piece.x), one(piece.y), one(piece.z)};
}

double cubic_at(const Array4d& h, double t) {
  const double s = 1 - t;
  return s * s * (s * h[0] + 3 * t * h[1]) + t * t * (3 * s * h[2] + t * h[3]);
}

// The greatest size of a cubic over [0, 1], by its Bezier coefficients.
double greatest_of(const Array4d& h) {
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

[[gnu::always_inline]] inline Array4d squares_of(const ControlCoordinates& p) {
  return p.x * p.x + p.y * p.y + p.z * p.z;
}

Point3 point_of(const ControlCoordinates& p, Eigen::Index i) { return {p.x[i], p.y[i], p.z[i]}; }

[[gnu::always_inline]] inline Array4d part_along(const ControlCoordinates& p,
                                                 const Vector3& direction) {
  return p.x * direction.x() + p.y * direction.y() + p.z * direction.z();
}

[[gnu::always_inline]] inline ControlCoordinates without_part(const ControlCoordinates& p,
                                                              const Array4d& part,
                                                              const Vector3& direction) {
  return {p.x - part * direction.x(), p.y - part * direction.y(), p.z - part * direction.z()};
}

// Not less than the greatest square of the piece's size over [0, 1]; what is below `known` need not
// be told from it.
double greatest_square(const ControlCoordinates& piece, double known, int halvings) {
  const Array4d squares = squares_of(piece);
  const double ends = std::max(squares[0], squares[3]);
  const double hull = squares.maxCoeff();
  if (hull <= known || hull == ends) return hull;
  const auto middle_of = [](const Array4d& p) {
    return 0.125 * (p[0] + p[3]) + 0.375 * (p[1] + p[2]);
  };
  Point3 bow{middle_of(piece.x), middle_of(piece.y), middle_of(piece.z)};
  if (bow.squaredNorm() < ends) bow = point_of(piece, squares[0] >= squares[3] ? 0 : 3);
  const double size = bow.norm();
  if (size > 0) {
    const Vector3 up = bow / size;
    const Array4d heights = part_along(piece, up);
    const double twist = squares_of(without_part(piece, heights, up)).maxCoeff();
    const double height = greatest_of(heights);
    const double square = height * height + twist;
    if (square <= known || twist <= kTwist * height * height || halvings == 0) {
      return std::min(square, hull);
    }
  } else if (halvings == 0) {
    return hull;
  }
  const auto [left, right] = halves(CubicBezier{
      {point_of(piece, 0), point_of(piece, 1), point_of(piece, 2), point_of(piece, 3)}});
  const double first = greatest_square(seen_from(Point3::Zero(), left), known, halvings - 1);
  return std::max(first, greatest_square(seen_from(Point3::Zero(), right), std::max(first, known),
                                         halvings - 1));
}

}  // namespace

ChordsFrom::ChordsFrom(const CurvePieces& pieces, std::size_t piece, double from)
    : pieces_(pieces), from_(from), first_(piece) {
  const double at = pieces.local(first_, from);
  const CubicBezier& whole = pieces.piece(first_);
  const CubicBezier rest = at > 0 ? parts_at(whole, at).second : whole;
  start_ = rest.control[0];
  left_ = 1 - at;
  rest_ = seen_from(start_, rest);
}

// The piece that holds `u`, at or after the first.
std::size_t ChordsFrom::piece_at(double u) const {
  std::size_t piece = first_;
  while (piece + 1 < pieces_.size() && pieces_.breaks()[piece + 1] <= u) ++piece;
  return piece;
}

// Of piece i, what lies between the start and `end`, seen from the start.
ControlCoordinates ChordsFrom::part_before(std::size_t i, double end) const {
  ControlCoordinates whole = i == first_ ? rest_ : seen_from(start_, pieces_.piece(i));
  if (pieces_.breaks()[i + 1] <= end) return whole;
  double part = pieces_.local(i, end);
  if (i == first_) part = left_ > 0 ? std::max(1 - (1 - part) / left_, 0.0) : 0;
  return restricted(whole, part);
}

ChordHeight ChordsFrom::to(double end) const {
  count_operations(2);
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
    const Array4d on = part_along(seen, direction);
    result.in_order = result.in_order && on[0] <= on[1] && on[1] <= on[2] && on[2] <= on[3];
    square = std::max(square,
                      greatest_square(without_part(seen, on, direction), square, kTwistHalvings));
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
