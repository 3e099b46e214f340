// Curvature along a chain of moves, as the report's page shows it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::postproc {

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
