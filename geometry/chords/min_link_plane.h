// Minimum-link polylines in the tolerance strip of a plane curve: the greedy sweep of windows,
// exact up to the gates that stand for the curve. Method: docs/algorithms/min_link.md.
//
// L. J. Guibas, J. E. Hershberger, J. S. B. Mitchell, J. S. Snoeyink, Approximating polygons and
// subdivisions with minimum-link paths, Int. J. Computational Geometry & Applications 3 (1993)
// 383-415: ordered stabbing, of which this is the case where the objects are gates that do
// not cross; S. Suri, A linear time algorithm for minimum link paths inside a simple polygon,
// Computer Vision, Graphics and Image Processing 35 (1986) 99-110: windows.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/chords/min_link_gates.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {

// A vertex near a curve, and the parameter of the curve's place that it stands for.
struct LinkVertex {
  Point3 place;
  double parameter = 0;
};

// The fewest links from `start`, on the first gate, to the centre of the last one, through all
// gates in order, at most `width` (mm) from their centres. Vertices stand on gates, or where a
// link cannot go further. Each link turns as late as possible.
//
// The curve lies in a plane across `normal` (unit length), or so near to it that what is across
// does not matter: places are the gates' centres moved in the plane. Nothing when the curve bends
// so closely that no link gets through two gates.
[[nodiscard]] std::optional<std::vector<LinkVertex>> min_link_in_plane(const GateChain& gates,
                                                                       const Vector3& normal,
                                                                       const Point3& start,
                                                                       double width);

// What is seen through gates in a plane: the straight ways through one gate after the other.
// Used by min_link_plane; see docs/algorithms/min_link.md.

// Offsets from a gate's centre along its normal, to the left positive; empty when low > high.
struct Offsets {
  double low = 1;
  double high = -1;

  [[nodiscard]] bool empty() const { return low > high; }
  [[nodiscard]] Offsets common_with(const Offsets& other) const;
  [[nodiscard]] Offsets hull_with(const Offsets& other) const;
};

struct PlaneGate {
  Point2 center;
  Vector2 normal;  // unit length, to the left of the way
  Offsets open;

  [[nodiscard]] Point2 at(double offset) const { return center + offset * normal; }
};

// A directed line.
struct SightLine {
  Point2 from;
  Point2 to;

  // Where the line crosses the gate's line, from right to left as seen from the front; nothing
  // when it turns from the gate's way by nearly a right angle or more.
  [[nodiscard]] std::optional<double> offset_on(const PlaneGate& gate) const;
};

// The two lines that bound what is seen: on every gate ahead, lines through all gates so far
// end between them.
struct SightLimits {
  SightLine left;   // turns most to the left: past a gate's right end first, a left end then
  SightLine right;  // the other way round

  // What is seen of a gate ahead of the others.
  [[nodiscard]] Offsets seen_on(const PlaneGate& gate) const;
};

// All straight ways from a part of one gate through the gates after it. Each gate costs
// a few operations, amortised: J. O'Rourke, An on-line algorithm for fitting straight lines
// between data ranges, Communications of the ACM 24 (1981) 574-578.
class Sight {
 public:
  Sight(const PlaneGate& source, const Offsets& part);

  // What is seen of the next gate; nothing is changed when that is empty.
  Offsets pass(const PlaneGate& gate);

  [[nodiscard]] const SightLimits& limits() const { return limits_; }

 private:
  // Ends of the gates on one side as a chain that is convex towards the way; what lies before
  // `first` is never a support again.
  struct Chain {
    std::vector<Point2> points;
    std::size_t first = 0;
    double side;  // +1: left ends, -1: right ends

    void add(const Point2& end);
    // The support of the line that ends in `to` and passes all points on its inner side.
    const Point2& support_of(const Point2& to);
  };

  Chain left_;
  Chain right_;
  SightLimits limits_;
  bool started_ = false;
};

// The straight ways that end in one point, followed backwards through the gates before it. Gates
// are taken wider by `noise` (mm), so that a way along their very ends is not lost to rounding.
class BackwardSight {
 public:
  BackwardSight(Point2 target, double noise) : target_(std::move(target)), noise_(noise) {}

  // From where on the gate the target is seen; the middle of a gap no wider than the noise.
  [[nodiscard]] Offsets seen_on(const PlaneGate& gate, const Offsets& part) const;

  // Only ways through this gate from now on. False when there are none.
  bool pass(const PlaneGate& gate);

 private:
  Point2 target_;
  double noise_;
  std::optional<std::pair<Point2, Point2>> bounds_;  // rightmost, leftmost point passed
};

}  // namespace batten::geometry
