// One smooth stretch of a plane curve as a chain of arcs, greedily: each step takes the
// pair of arcs (or the single arc) that reaches farthest inside the allowed deviation.
// Method: docs/algorithms/arc_fit.md, steps 4 to 6.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/arcs/biarc.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {

struct ArcChainLimits {
  double deviation = 0;         // mm in the plane
  double height_deviation = 0;  // mm along the axis, at equal angles
  double min_radius = 0;        // mm
  double max_radius = 0;        // mm
  double max_sweep = 0;         // radians
  double grid = 0;              // mm; 0: none
  bool flat = true;             // heights play no part
  // A step's end is searched to this part of its length: a hundred pieces lose a third of one.
  double precision = 3e-3;
};

// A place that the chain passes with a known tangent.
struct ChainNode {
  double u;      // on the curve
  Point3 place;  // local coordinates of the curve, rounded to the grid
  double angle;  // of the tangent in the plane, on the count of PlaneCurve::angle_at
};

struct ChainPiece {
  PlaneArc arc;
  double end_height;
  double end_u;
};

struct ArcPair {
  PlaneArc first;
  PlaneArc second;
  Vector2 tangent;      // at the joint, before rounding
  double joint_u;       // where the curve passes the joint
  double joint_height;  // of the curve there, rounded
  double kink;          // radians at the joint, which rounding forces
  ChainNode end;
};

// Whether a chain that has used so many pieces on a part of its way (`done`, 0..1) is so far behind
// its pace that it will not do with `most` of them.
[[nodiscard]] bool falls_behind(double done, std::size_t used, std::size_t most);

class ArcChain {
 public:
  ArcChain(const PlaneCurve& curve, const ArcChainLimits& limits)
      : curve_(curve), limits_(limits) {}

  // Pieces from one node to the other, the fewest first, then the least deviation. Nothing
  // when neither arcs nor short lines hold, or when more than `at_most` would be needed.
  [[nodiscard]] std::optional<std::vector<ChainPiece>> between(const ChainNode& start,
                                                               const ChainNode& end,
                                                               std::size_t at_most) const;

  // Whether the chain from `start` already falls behind its pace before `end`, or sticks long
  // before it, where it would go on to `whole` (the parameter at which its stretch ends): between()
  // would give it up.
  [[nodiscard]] bool fails_before(const ChainNode& start, const ChainNode& end, double whole,
                                  std::size_t at_most) const;

  // A pair of arcs from `start` to the place at u, in the search's form.
  [[nodiscard]] std::optional<ArcPair> pair_to(const ChainNode& start, double u) const;

  [[nodiscard]] Point3 rounded(const Point3& place) const;

 private:
  // A pair of arcs whose joint is still to be chosen (best_pair).
  struct OpenPair {
    ChainNode start;
    ArcPair found;
  };

  struct Step {
    std::vector<ChainPiece> pieces;
    ChainNode end;
    std::optional<OpenPair> open;  // the two pieces are one
  };

  // The pieces of a chain, pairs by the place of their first piece, and why it ends.
  enum class Outcome { kArrived, kBehind, kStuck };
  struct Walk {
    std::vector<ChainPiece> pieces;
    std::vector<std::pair<std::size_t, OpenPair>> open;
    double reached = 0;  // parameter
    Outcome outcome = Outcome::kArrived;
  };

  // `whole`: the end of the way that the pace is told by.
  Walk walk(const ChainNode& start, const ChainNode& end, double whole, std::size_t at_most) const;
  std::optional<std::vector<ChainPiece>> greedy(const ChainNode& start, const ChainNode& end,
                                                std::size_t at_most) const;
  std::optional<std::vector<ChainPiece>> balanced(
      const ChainNode& start, const ChainNode& end,
      std::optional<std::vector<ChainPiece>> best) const;
  // Steps end at `limit` at the latest, which is end.u or before it.
  std::optional<Step> next_step(const ChainNode& start, const ChainNode& end, double limit,
                                double guess) const;
  std::optional<Step> line_step(const ChainNode& start, const ChainNode& end) const;

  // What the chain's tangent is taken from where it meets the curve.
  enum class Tangent { kCurve, kCrossing };

  double crossing_angle(double u, double reach, double arc_length) const;
  ChainNode node_at(const ChainNode& start, double u, Tangent tangent) const;
  double shortest_step(const ChainNode& start, const ChainNode& end) const;
  std::optional<ArcPair> farthest_pair(const ChainNode& start, const ChainNode& end, double limit,
                                       double guess, Tangent tangent) const;
  std::optional<Step> farthest_single(const ChainNode& start, const ChainNode& end, double limit,
                                      double least, double guess) const;
  std::optional<ArcPair> pair_between(const ChainNode& start, const ChainNode& end,
                                      double balance) const;
  ArcPair best_pair(const ChainNode& start, const ArcPair& found) const;
  static std::vector<ChainPiece> pieces_of(const ArcPair& pair);
  std::optional<ChainPiece> single_to(const ChainNode& start, const ChainNode& end) const;

  bool holds(ArcPair& pair, const ChainNode& start) const;  // finds where the joint is
  bool holds(const PlaneArc& arc, double from, double to, double from_height,
             double to_height) const;
  bool allowed(const PlaneArc& arc) const;
  bool is_passed(const Point2& joint, double u) const;
  bool heights_hold(const PlaneArc& arc, double from, double to, double from_height,
                    double to_height) const;
  double joint_parameter(const Point2& joint, const Vector2& tangent, double from, double to) const;

  const PlaneCurve& curve_;
  ArcChainLimits limits_;
};

}  // namespace batten::geometry
