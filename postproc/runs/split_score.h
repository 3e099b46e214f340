// How well the vertices of a path serve as places where it is cut into runs.
#pragma once

#include "geometry/basic/point.h"

namespace batten::postproc {

// The greater the better: reversals, else the sharpest corner, else within a straight line, else
// where the path turns least.
struct Fitness {
  int rank = 0;
  double within_rank = 0;

  friend bool operator<(const Fitness& a, const Fitness& b) {
    return a.rank != b.rank ? a.rank < b.rank : a.within_rank < b.within_rank;
  }
};

// Of the vertex `at` between its neighbours.
[[nodiscard]] Fitness split_score_at(const geometry::Point3& before, const geometry::Point3& at,
                                     const geometry::Point3& after);

}  // namespace batten::postproc
