// A matching of two chord polylines in order: the certificate of path_distance.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/distance/chord_polyline.h"

namespace batten::geometry {

// Places that are passed at the same moment.
struct MatchedPair {
  PlaceOnChord a;
  PlaceOnChord b;
};

// Pairs that go forward on both paths, from both starts to both ends, so that between
// neighbours both paths are one chord: the step into pair k runs on the edges named by pair
// k, and pair k - 1 lies on them too (at the end of the edge before, or on the same edge).
using Matching = std::vector<MatchedPair>;

// Goes along both and each time takes the nearer of two steps: to the next vertex of `a` and
// the place of `b` nearest to it, or the other way round. Always a matching, linear cost, and
// the best one where the paths run beside each other; where one of them folds, it may be far
// from the best.
[[nodiscard]] Matching match_nearest(const ChordPolyline& a, const ChordPolyline& b);

// Do the pairs go forward as said above? The part of the certificate that asks no distance.
[[nodiscard]] bool goes_forward(const Matching& matching, const ChordPolyline& a,
                                const ChordPolyline& b);

struct MeasuredMatching {
  double at_most = 0;     // mm, greatest pair distance plus chord errors, rounded up by `noise`
  std::size_t worst = 0;  // index of that pair
};

// `noise`: mm, rounding of a distance of two places.
[[nodiscard]] MeasuredMatching measure(const Matching& matching, const ChordPolyline& a,
                                       const ChordPolyline& b, double noise);

// Sum of the chord errors on the step into pair k.
[[nodiscard]] inline double step_error(const Matching& matching, std::size_t k,
                                       const ChordPolyline& a, const ChordPolyline& b) {
  return a.errors[matching[k].a.edge] + b.errors[matching[k].b.edge];
}

// The larger of the errors of the steps into and out of pair k: both have it as an end.
[[nodiscard]] double pair_error(const Matching& matching, std::size_t k, const ChordPolyline& a,
                                const ChordPolyline& b);

}  // namespace batten::geometry
