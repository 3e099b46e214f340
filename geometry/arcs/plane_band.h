// The band around a polyline in the plane as single arcs meet it: which arcs from a place stay
// inside, how far they reach, and whether one of them does, in order.
// Method: docs/algorithms/arc_spline.md, steps 1 to 3.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/arcs/biarc.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {

struct PlaneBandTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  double between = 0.02;     // of the tolerance, at most: what a curve does between two samples
  double most_parts = 8;     // of an edge, for that
  double long_edge = 200;    // tolerances: a longer edge could hide an arc's bulge,
  double parts_of_long = 4;  // and has so many parts at least
  double tight_turn = 0.1;   // radians: about vertices that turn more samples are at distances that
  double nearest = 0.5;      // double from so many tolerances: arcs that round them are that small
  double room_for_tight = 10;  // tolerances: a shorter edge is no leg of a corner [>]
  // A fan is made for this part of the tolerance; the rest is for what arcs do between samples
  // and for the rounding of their ends.
  double fan_part = 0.97;
};
inline constexpr PlaneBandTuning kPlaneBandTuning;

// Signed curvatures, 1/mm, positive to the left.
struct CurvatureRange {
  double low;
  double high;

  [[nodiscard]] double middle() const { return 0.5 * (low + high); }
};

// An arc starts here: at a place within the tolerance of the polyline, with this tangent.
struct BandEntry {
  Point2 place;
  Vector2 along = Vector2::UnitX();  // unit vector
  std::size_t next = 1;              // first sample that lies ahead
};

// The arcs from one entry: element i holds the curvatures that pass every sample from the next
// one to the i-th after it within the tolerance. None is empty.
using ArcFan = std::vector<CurvatureRange>;

struct ArcReach {
  std::size_t end;    // the first sample that no arc from the entry passes
  double margin = 0;  // mm, how wide the band is at the sample before it for arcs that get there
};

class PlaneBand {
 public:
  // A place of the polyline that arcs are held against: its vertices, and between them so many
  // more that what an arc does between two of them is little against the tolerance.
  struct Sample {
    Point2 place;
    double station;    // length along the polyline, mm
    double turn;       // radians, signed, at a vertex; 0 between vertices
    Vector2 edge_way;  // unit vector: direction of the edge that ends here or passes here
  };

  struct Limits {
    double tolerance = 0;      // mm, > 0
    double outside = 0;        // mm, > 0: of it, for what is farther from the centre than an arc
    double max_curvature = 0;  // 1/mm, > 0
    double max_sweep = 0;      // radians, below pi
    std::size_t stride = 1;    // `reach` looks at each so many-th sample as long as it may
  };

  // Requires two points or more, neighbours apart.
  PlaneBand(std::span<const Point2> points, const Limits& limits);

  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }

  [[nodiscard]] ArcFan fan(const BandEntry& entry) const;
  // The end of that fan; with a stride narrow places between the samples may be overlooked.
  [[nodiscard]] ArcReach reach(const BandEntry& entry) const;

  // False when it is certain that `reach` ends before this: a few of its samples say so.
  [[nodiscard]] bool may_reach(const BandEntry& entry, std::size_t end) const;

  // Whether the arc (or line) from `entry` stays within `sides` (no more than the tolerance of the
  // band; a line: `inside`) of the polyline, and the polyline of it, both going forward (Frechet
  // distance). Returns the first sample that lies beyond the arc's end; samples().size() when it
  // ends at the last one.
  [[nodiscard]] std::optional<std::size_t> passed(const BandEntry& entry, const PlaneArc& arc,
                                                  const ArcSides& sides) const;

 private:
  void add_edge(const Point2& from, const Point2& to, const Vector2& edge_way, double turn_before,
                double turn_after);

  Limits limits_;
  double steepest_;  // a place seen at half the sweep from the tangent: the arc has turned by it
  std::vector<Sample> samples_;
};

}  // namespace batten::geometry
