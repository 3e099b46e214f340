// The predicted speed along the cutting moves of one program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {

// Every chain of cutting moves between two events is run from rest to rest, as the model of the
// machine's control does it. Linear cost.
class ProgramSpeeds {
 public:
  ProgramSpeeds(const ReadProgram& read, const ProgramEvents& events, const Machine& machine);

  // mm/min; `share` of the motion's length, 0 to 1. 0 for motions that are in no chain.
  [[nodiscard]] double at(std::uint32_t motion, double share) const;

 private:
  struct Sample {
    double way = 0;    // mm from the start of the chain, along the programmed path
    double speed = 0;  // mm/s
  };
  struct Place {
    std::size_t chain = 0;
    double way = 0;  // mm from the start of the chain, along the programmed path
    double length = 0;
  };

  void add_chain(const ReadProgram& read, const Cut* begin, const Cut* end, const Machine& machine);

  std::vector<std::vector<Sample>> chains_;
  std::vector<Place> places_;  // one per motion; no length: in no chain
};

// Curvature along a chain of moves, as the report's page shows it.

// 1/mm. On an arc its own. At a joint of two lines that of the circle through their three ends;
// between joints in proportion, since a line in itself does not bend. Where a line meets an arc,
// the arc's. 0 at the ends of the chain on lines.
class ChainCurvature {
 public:
  explicit ChainCurvature(std::span<const geometry::PathPiece> chain);

  // `place` lies on the piece.
  [[nodiscard]] double at(std::size_t piece, const geometry::Point3& place) const;

 private:
  std::span<const geometry::PathPiece> chain_;
  std::vector<double> at_joint_;  // one more than pieces
};

// How far along a piece a place on it is, from 0 to 1, by its distances from the ends.
[[nodiscard]] double share_of_piece(const geometry::PathPiece& piece,
                                    const geometry::Point3& place);

}  // namespace batten::postproc
