// Which arcs of a program are intended, and which are segments of a curve that a CAM system could
// not write otherwise; and where arcs and the control's own curves end in corners. Method:
// docs/algorithms/arcs_in_runs.md.
#pragma once

#include <span>
#include <vector>

#include "geometry/path/path.h"

namespace batten::postproc {

// One cutting motion of a chain, as it was printed.
struct PrintedMotion {
  geometry::PathPiece piece;  // of some length
  bool by_radius = false;     // an arc by R
};

// Greatest errors of printed numbers, mm: half a step of the last digit.
struct PrintedErrors {
  double place = 0;   // of X, Y, Z
  double center = 0;  // of I, J, K, R
};

enum class ArcJoint {
  kNone,     // between two lines: says nothing of bends
  kTangent,  // as tangent as the printed numbers can tell
  kKink,     // turns by more than that, and by as little as two segments of one curve may
  kCorner,   // an intended turn, or a change from a level cut to a rising one
};

// `tolerance` (mm): a curve in segments is assumed to be true to it, or twice of it at the most.
[[nodiscard]] ArcJoint joint_between(const PrintedMotion& before, const PrintedMotion& after,
                                     const PrintedErrors& errors, double tolerance);

struct ChainJudgement {
  // By motion: an intended arc, that is a full circle, or one that meets neither neighbour in a
  // kink, unless it is one of many arcs in a row that mostly meet in kinks.
  std::vector<bool> kept;
  // By motion: before it is a corner at an arc or a curve, where the chain is to be cut.
  std::vector<bool> starts_part;
};

// Neighbours in `chain` follow each other. Linear cost.
[[nodiscard]] ChainJudgement judge_arcs(std::span<const PrintedMotion> chain,
                                        const PrintedErrors& errors, double tolerance);

}  // namespace batten::postproc
