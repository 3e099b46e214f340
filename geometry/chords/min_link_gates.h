// Gates across a curve: the sections of its tolerance tube through which a polyline near it
// passes one after the other. Used by min_link; see docs/algorithms/min_link.md.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {

struct GateTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  // A piece that is this many times longer than the steps beside it is cut into parts about as long
  // as they, so many at most: points to turn are wanted near its ends.
  double growth = 4;         // [<]
  double most_in_line = 16;  // [at 1 and 1e6]
  int most_halvings = 20;  // of one Bezier piece, a million gates [< MinLinkCount.IsThatOfTheTable]
  double no_bend = 1e-12;  // radians between tangents: less is rounding [at 0]
};
inline constexpr GateTuning kGateTuning;

struct Gate {
  double parameter = 0;
  Point3 center;   // on the curve
  Vector3 along;   // unit tangent
  Vector3 bend;    // to where the curve bends; no length where it is straight
  double gap = 0;  // mm: how far the curve beside the gate is from the chords to its neighbours
};

class GateChain {
 public:
  // Gates on the curve from one parameter to another, both included, so close that the curve
  // between two of them is at most `gap` (mm, > 0) from their chord. Gates are not much further
  // apart than their neighbours are, also on straight parts. Linear cost.
  //
  // Requires: from < to, and no corner between them. `pieces` is kept.
  GateChain(const CurvePieces& pieces, double from, double to, double gap);

  [[nodiscard]] std::size_t size() const { return gates_.size(); }
  [[nodiscard]] const Gate& operator[](std::size_t i) const { return gates_[i]; }
  [[nodiscard]] const Gate& back() const { return gates_.back(); }

  // The last gate that is not after this parameter, but for the last of all.
  [[nodiscard]] std::size_t index_of(double parameter) const;

  // A gate at a parameter of the chain.
  [[nodiscard]] Gate at(double parameter) const;

  // A gate between number i and the next one, at this part of the parameter between them.
  [[nodiscard]] Gate between(std::size_t i, double part) const;

 private:
  [[nodiscard]] Gate gate_at(double parameter) const;
  void find_bends();

  const CurvePieces* pieces_;
  std::vector<Gate> gates_;
};

}  // namespace batten::geometry
