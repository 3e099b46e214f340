// A path cut into parts for the quick estimate of its planned time: each part bends so little that
// the derivatives in its middle stand for all of it.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_envelope.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

struct EstimatePart {
  std::size_t piece = 0;
  double t0 = 0;
  double t1 = 1;
  double length = 0;  // mm
  double cap = 0;     // of the potential (Potential): what the bend allows if it were held
  double slope = 0;   // of the potential by mm, the greatest
  double top = 0;     // of the potential, where feed or acceleration end the first phase from rest
  double bend = 0;    // how much the shares of the limits that steady motion takes change over it
  double end_bound = KinematicPathLimits::kNone;  // mm/s, what the joint at its end allows
  bool straight = true;
};

// Derivatives at both ends of a piece.
struct PieceEnds {
  LengthDerivatives start;
  LengthDerivatives end;
};

[[nodiscard]] PieceEnds ends_of(const geometry::PathPiece& piece);

// Appends the parts of `piece`, which is number `number` of its path and of some length.
void append_parts(const geometry::PathPiece& piece, std::size_t number, const PieceEnds& ends,
                  const Potential& potential, const KinematicPathLimits& limits,
                  std::vector<EstimatePart>& parts);

// Parts that are run without a stop between them, and the greatest potential at their ends.
struct PartChain {
  std::vector<EstimatePart> parts;
  std::vector<double> w;  // one more than parts

  // The envelope of the speeds, given those at both ends, mm/s.
  void find_potentials(double start_speed, double end_speed, const Potential& potential);

  // The joints, as numbers of the parts before which they are, that are this many times slower than
  // the envelope before and after them.
  [[nodiscard]] std::vector<std::size_t> slow_joints(double times,
                                                     const Potential& potential) const;
};

}  // namespace batten::postproc
