#include "geometry/arcs/biarc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"
#include "geometry/path/cubic_polynomial.h"

namespace batten::geometry {
namespace {

// Halvings of a piece whose bounds are not sharp; each one quarters what they have too much.
constexpr int kHalvings = 6;

double angle_of(const Vector2& v) { return std::atan2(v.y(), v.x()); }

struct PlaneCubic {
  std::array<Point2, 4> control;
};

// Whether `holds` is shown for all of the piece by bounds on it, or on its parts, as long as it
// holds for their ends.
template <typename Ends, typename Bounds>
bool holds_all_along(const PlaneCubic& piece, int halvings, const Ends& ends,
                     const Bounds& bounds) {
  if (!ends(piece.control)) return false;
  if (bounds(piece.control)) return true;
  if (halvings == 0) return false;
  const auto [left, right] = geometry::halves(piece);
  return holds_all_along(left, halvings - 1, ends, bounds) &&
         holds_all_along(right, halvings - 1, ends, bounds);
}

// `piece` relative to the center.
bool stays_near_circle(const PlaneCubic& piece, const PlaneArc& arc, const ArcSides& sides) {
  const double deviation = std::max(sides.inside, sides.outside);
  for (int i = 0; i < 3; ++i) {
    const Vector2 leg = piece.control[i + 1] - piece.control[i];
    const double forward = cross(piece.control[i], leg) * (arc.sweep > 0 ? 1 : -1);
    if (forward < -deviation * piece.control[i].norm()) return false;
  }
  const double inner = std::max(arc.radius - sides.inside, 0.0);
  const double outer = arc.radius + sides.outside;
  const auto allowed = [least = inner * inner, most = outer * outer](double squared) {
    return least <= squared && squared <= most;
  };
  return holds_all_along(
      piece, kHalvings,
      [&](const auto& q) { return allowed(q[0].squaredNorm()) && allowed(q[3].squaredNorm()); },
      [&](const auto& q) {
        return allowed(q[0].dot(q[1])) && allowed(q[2].dot(q[3])) &&
               allowed((2 * q[0].dot(q[2]) + 3 * q[1].squaredNorm()) / 5) &&
               allowed((2 * q[1].dot(q[3]) + 3 * q[2].squaredNorm()) / 5) &&
               allowed((q[0].dot(q[3]) + 9 * q[1].dot(q[2])) / 10);
      });
}

// `piece` in coordinates (along, across) of the line.
bool stays_near_line(const PlaneCubic& piece, double deviation) {
  for (int i = 0; i < 3; ++i) {
    if (piece.control[i + 1].x() < piece.control[i].x() - deviation) return false;
  }
  const auto near = [deviation](const Point2& p) { return std::abs(p.y()) <= deviation; };
  return holds_all_along(
      piece, kHalvings, [&](const auto& q) { return near(q[0]) && near(q[3]); },
      [&](const auto& q) { return near(q[1]) && near(q[2]); });
}

}  // namespace

double turn_between(const Vector2& from, const Vector2& to) {
  const double across = cross(from, to);
  const double ahead = from.dot(to);
  // Up to here the series leaves out what is below rounding.
  constexpr double kSmallTangent = 0.125;
  if (!(std::abs(across) <= kSmallTangent * ahead && ahead > 0)) return std::atan2(across, ahead);
  const double tangent = across / ahead;
  const double t = tangent * tangent;
  const double tail = 1.0 / 11 + t * (-1.0 / 13 + t * (1.0 / 15 - t / 17));
  const double sum = -1.0 / 3 + t * (1.0 / 5 + t * (-1.0 / 7 + t * (1.0 / 9 - t * tail)));
  return tangent * (1 + t * sum);
}

double PlaneArc::length() const {
  return is_line() ? (end - start).norm() : radius * std::abs(sweep);
}

double PlaneArc::start_angle() const { return angle_of(end - start) - sweep / 2; }

namespace {

// `sine` and `cosine`, times the length of the chord: of half the sweep.
PlaneArc arc_over(const Point2& start, const Point2& end, double sine, double cosine,
                  double max_radius) {
  PlaneArc arc{start, end};
  const Vector2 chord = end - start;
  const double square = chord.squaredNorm();
  if (square <= kSamePlace * kSamePlace || square >= 2 * max_radius * std::abs(sine)) return arc;
  arc.sweep = 2 * std::atan2(sine, cosine);
  arc.radius = square / (2 * std::abs(sine));
  // Seen from the middle of the chord the center lies across it, to the left for a
  // counter-clockwise arc of less than half a turn.
  arc.center = (start + end) / 2 + cosine / (2 * sine) * Vector2(-chord.y(), chord.x());
  return arc;
}

}  // namespace

PlaneArc arc_with_sweep(const Point2& start, const Point2& end, double sweep, double max_radius) {
  const double length = (end - start).norm();
  return arc_over(start, end, length * std::sin(sweep / 2), length * std::cos(sweep / 2),
                  max_radius);
}

PlaneArc arc_leaving(const Point2& start, const Vector2& along, const Point2& end,
                     double max_radius) {
  const Vector2 chord = end - start;
  return arc_over(start, end, cross(along, chord), along.dot(chord), max_radius);
}

PlaneArc arc_arriving(const Point2& start, const Point2& end, const Vector2& along,
                      double max_radius) {
  const Vector2 chord = end - start;
  return arc_over(start, end, cross(chord, along), chord.dot(along), max_radius);
}

std::optional<BiarcJoint> biarc_joint(const Point2& start, const Vector2& t0, const Point2& end,
                                      const Vector2& t1, double balance) {
  const Vector2 v = end - start;
  const double vv = v.squaredNorm();
  const double b = v.dot(t0 + t1);
  const double c = (t1 - t0).squaredNorm() / 2;  // 1 - t0.t1 without cancellation
  // Equal lengths: 2 c d^2 + 2 b d - v.v = 0, in the form that keeps its digits.
  const double root = std::sqrt(b * b + 2 * c * vv);
  const double equal = b >= 0 ? vv / (b + root) : (root - b) / (2 * c);
  const double first = balance * equal;
  const double below = 2 * (v.dot(t1) + first * c);
  const double second = (vv - 2 * first * v.dot(t0)) / below;
  if (!(first > 0) || !(second > 0) || !std::isfinite(first) || !std::isfinite(second)) {
    return std::nullopt;
  }
  const Point2 first_corner = start + first * t0;
  const Vector2 between = end - second * t1 - first_corner;
  const double length = first + second;
  return BiarcJoint{first_corner + first / length * between, between.normalized()};
}

bool stays_near(const CubicBezier& piece, const PlaneArc& arc, double deviation) {
  return stays_near(piece, arc, ArcSides{deviation, deviation});
}

bool stays_near(const CubicBezier& piece, const PlaneArc& arc, const ArcSides& sides) {
  PlaneCubic local;
  if (arc.is_line()) {
    const Vector2 along = (arc.end - arc.start).normalized();
    for (int i = 0; i < 4; ++i) {
      const Vector2 q = piece.control[i].head<2>() - arc.start;
      local.control[i] = {along.dot(q), cross(along, q)};
    }
    return stays_near_line(local, sides.inside);
  }
  for (int i = 0; i < 4; ++i) local.control[i] = piece.control[i].head<2>() - arc.center;
  return stays_near_circle(local, arc, sides);
}

namespace {

constexpr double kQuarter = std::numbers::pi / 2;

// Radians. See the header; also the noise of a half turn that is one but for its last digits.
constexpr double kSameAngle = 1e-6;

// Radians from the start of the arc to the directions that it goes across, in its own sense.
void append_crossings(const Arc& arc, const Vector3& quadrant_from, std::vector<double>& found) {
  const Vector3 out = arc.start - arc.center;
  const Vector3 side = arc.axis.cross(quadrant_from);
  const double angle = std::atan2(out.dot(side), out.dot(quadrant_from));
  const double along = arc.sweep > 0 ? angle : -angle;
  const double length = std::abs(arc.sweep);
  const double first = std::ceil((along + kSameAngle) / kQuarter) * kQuarter - along;
  for (double at = first; at < length - kSameAngle; at += kQuarter) found.push_back(at);
}

}  // namespace

// An arc to the left has what is farther from its centre on the right.
ArcRunning::Run ArcRunning::run_of(const PlaneArc& arc, double length, double from,
                                   double to) const {
  const Room there = room(from, to);
  Run run{error(arc.radius, std::abs(arc.sweep), length), there.right, there.left, there.error};
  if (arc.sweep < 0) std::swap(run.outside, run.inside);
  return run;
}

ArcSides ArcRunning::Run::sides_within(double most) const {
  if (error.off > most_error) return {-1, -1};
  return {std::min(most, outside - error.off),
          std::min(most, inside - (error.certain ? 0 : error.off))};
}

double ArcRunning::Run::good_part(double off) const {
  constexpr double kShorter = 1e-3;  // than what is good by a hair
  const double good = std::min(most_error, std::max(outside - off, outside / 2));
  if (error.off <= good) return 1;
  return good > 0 ? (1 - kShorter) * std::sqrt(good / error.off) : 0;
}

ArcSides ArcRunning::sides_of(const PlaneArc& arc, double length, double most, double from,
                              double to) const {
  if (!error || arc.is_line()) return {most, most};
  return run_of(arc, length, from, to).sides_within(most);
}

std::vector<Arc> arc_parts(const Arc& arc, const ArcPartsOptions& options) {
  const double length = std::abs(arc.sweep);
  std::vector<double> cuts = {0};
  if (!options.quadrant_from.isZero()) append_crossings(arc, options.quadrant_from, cuts);
  cuts.push_back(length);

  std::vector<Arc> parts;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double span = cuts[i + 1] - cuts[i];
    const double count = std::max(1.0, std::ceil((span - kSameAngle) / options.max_sweep));
    for (double k = 0; k < count; ++k) {
      const double from = (cuts[i] + span * k / count) / length;
      const bool last = i + 2 == cuts.size() && k + 1 == count;
      const double to = last ? 1 : (cuts[i] + span * (k + 1) / count) / length;
      if (from == 0 && to == 1) return {arc};
      parts.push_back(std::get<Arc>(sub_piece(arc, from, to)));
    }
  }
  return parts;
}

}  // namespace batten::geometry
