// Arcs and pairs of arcs in a plane, from points and tangents.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/path/path.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {

// A circular arc in the plane; a line when `sweep` is 0.
struct PlaneArc {
  Point2 start;
  Point2 end;
  Point2 center = Point2::Zero();
  double radius = 0;  // mm
  double sweep = 0;   // radians, positive counter-clockwise, |sweep| < 2 pi

  [[nodiscard]] bool is_line() const { return sweep == 0; }
  [[nodiscard]] double length() const;
  [[nodiscard]] double start_angle() const;  // of the tangent, radians
};

// How far what is followed may be from an arc: farther from the centre than it, and nearer. mm
struct ArcSides {
  double outside = 0;
  double inside = 0;

  [[nodiscard]] bool any() const { return outside > 0 && inside > 0; }
};

// What runs the arcs may leave them, as controls do that cut them into chords of their own: these
// lie inside.
struct ArcRunning {
  // What there is for it beside a part of the path that is followed, mm: how far this may be to the
  // left and to the right of what is run, and the error alone.
  struct Room {
    double left = std::numeric_limits<double>::infinity();
    double right = std::numeric_limits<double>::infinity();
    double error = std::numeric_limits<double>::infinity();
  };

  struct Error {
    double off = 0;       // mm
    bool certain = true;  // else it may be on either side, as far as is known
  };

  // By radius (mm), sweep (radians) and length (mm) of an arc; it grows with the square of the
  // length but where one chord more is made. None: arcs are run as they are.
  std::function<Error(double radius, double sweep, double length)> error;
  // Between two places of the path: parameters of a curve, stations of a polyline (mm).
  std::function<Room(double from, double to)> room;

  // Of an arc beside this part, where all may be off by `most`; below 0: it may not be there at
  // all. A helix is longer than in the plane.
  [[nodiscard]] ArcSides sides_of(const PlaneArc& arc, double length, double most, double from,
                                  double to) const;

  // How one arc is run.
  struct Run {
    Error error;
    double outside;  // mm: of the room, on either side of the arc
    double inside;
    double most_error;

    [[nodiscard]] ArcSides sides_within(double most) const;
    // The part of the arc that is off by so much outside and may stand there, where the whole may
    // not.
    [[nodiscard]] double good_part(double off) const;
  };
  // Requires an arc that is no line, and an error.
  [[nodiscard]] Run run_of(const PlaneArc& arc, double length, double from, double to) const;
};

// Which arcs may be made, and where they may end.
struct ArcRange {
  double min_radius = 0.1;  // mm; a tighter bend becomes short lines, or a kink
  double max_radius = 1e4;  // mm; flatter arcs become lines
  double max_sweep = 3.0;   // radians; in ]0, pi[, so that no arc is ambiguous when rounded
  // mm: inner ends are rounded to multiples of it before the arcs are computed, so that the printed
  // ends are the ends that the arcs were made for. The first and the last are not. 0: no rounding.
  double grid = 0;
  // mm: what is followed is mostly no farther outside of an arc than this, whatever the deviation
  // that is allowed: for what runs it.
  double outside = std::numeric_limits<double>::infinity();
  ArcRunning running;
};

// Radians, signed, positive to the left. Quick where it is small.
[[nodiscard]] double turn_between(const Vector2& from, const Vector2& to);

// The arc between two points that turns by `sweep`; a line when it is flatter than
// `max_radius`.
[[nodiscard]] PlaneArc arc_with_sweep(const Point2& start, const Point2& end, double sweep,
                                      double max_radius);

// The arc that leaves `start` along a unit vector and ends in `end`, and the one that arrives there
// along it.
[[nodiscard]] PlaneArc arc_leaving(const Point2& start, const Vector2& along, const Point2& end,
                                   double max_radius);
[[nodiscard]] PlaneArc arc_arriving(const Point2& start, const Point2& end, const Vector2& along,
                                    double max_radius);

// The direction in which an arc arrives that leaves along a unit vector and has this chord; and the
// other way round.
[[nodiscard]] inline Vector2 mirrored(const Vector2& along, const Vector2& chord) {
  return 2 * along.dot(chord) / chord.squaredNorm() * chord - along;
}

// Two arcs that leave `start` and arrive at `end` along given unit vectors can meet, with a common
// tangent, on a circle of points. `first` is the length from `start` along its tangent to
// the corner of the first arc's tangents; it and the length `second` before `end` obey
//   v.v - 2 first v.t0 - 2 second v.t1 - 2 first second (1 - t0.t1) = 0,  v = end - start,
// which says that the two corners are first + second apart. K. M. Bolton, Biarc curves,
// Computer-Aided Design 7(2), 1975.
struct BiarcJoint {
  Point2 place;
  Vector2 tangent;
};

// `balance`: `first` relative to the value for which both lengths are equal. Nothing when
// there is no such pair with both lengths positive.
[[nodiscard]] std::optional<BiarcJoint> biarc_joint(const Point2& start, const Vector2& t0,
                                                    const Point2& end, const Vector2& t1,
                                                    double balance);

// True when the part of the plane curve is proved to stay within `deviation` of the arc and
// to go forward along it. Bounds: Bernstein coefficients of the squared distance from the
// center, which is a polynomial of degree six; the piece is halved where they are not sharp.
[[nodiscard]] bool stays_near(const CubicBezier& piece, const PlaneArc& arc, double deviation);
// The same, with the part of the curve that is farther from the center than the arc, and nearer.
[[nodiscard]] bool stays_near(const CubicBezier& piece, const PlaneArc& arc, const ArcSides& sides);

struct ArcPartsOptions {
  double max_sweep = 0;  // radians, > 0
  // Directions from the centre that no part goes across: this one and its quarter turns. A unit
  // vector across the arc's axis, or zero: none.
  Vector3 quadrant_from = Vector3::Zero();
};

// An arc in several, for controls that do not take long ones: parts of the same circle or helix
// that follow each other from the arc's start to its end; the arc itself where it is short enough.
// Where only the sweep counts all parts are alike.
//
// A start or end beside a direction by less than a millionth of a radian counts as on it: a part of
// that length would be none for most controls.
[[nodiscard]] std::vector<Arc> arc_parts(const Arc& arc, const ArcPartsOptions& options);

}  // namespace batten::geometry
